#include "problems/mesh/files/mesh_file.hpp"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/text/base64.hpp"
#include "tests/growth_of_time.hpp"
#include "tests/problems/mesh/files/mesh_goldens.hpp"
#include "tests/problems/mesh/meshes.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

void expect_refused(const std::string& name, const std::string& text, const std::string& named) {
  const std::string sentence = error_of<std::invalid_argument>([&] { read_mesh(name, text); });
  EXPECT_EQ(sentence.rfind(name, 0), 0U) << sentence;
  EXPECT_TRUE(says(sentence, named));
  EXPECT_TRUE(says(sentence, "; ")) << "the remedy";
}

const std::string& golden_text(const std::string& name) {
  static const std::vector<GoldenMesh> all = golden_meshes();
  return std::ranges::find(all, name, &GoldenMesh::name)->text;
}

TEST(MeshFiles, BlocksOfXzMayHaveTheDictionaryOfEightMebibytesOfEveryXz) {
  if (!block_compressor("vtkLZMADataCompressor")->decompress) GTEST_SKIP() << "without liblzma";
  std::string text = golden_text("lzma.vtu");
  const std::string smallest = "AgAhAQAAAAA3J5fW", usual = "AgAhARYAAAB0L+Wj";  // size and its check sum
  for (std::size_t at = 0; (at = text.find(smallest)) != std::string::npos;)
    text.replace(at, smallest.size(), usual);
  EXPECT_TRUE(says(text, usual));
  EXPECT_EQ(read_mesh("a.vtu", text).mesh.points, golden_mesh().points);
}

TEST(MeshFiles, EveryFormatTellsTheSameMesh) {
  const TetMesh expected = golden_mesh();
  for (const GoldenMesh& golden : golden_meshes()) {
    SCOPED_TRACE(golden.name);
    const MeshFile file = golden.read();
    EXPECT_EQ(file.mesh.points, expected.points);
    EXPECT_EQ(file.mesh.tetrahedra, expected.tetrahedra);
    if (golden.name == "one.veg") continue;  // its regions have names and count from 1
    EXPECT_EQ(file.mesh.regions, golden.has_regions ? expected.regions : std::vector<TetMesh::Index>{});
  }
}

TEST(MeshFiles, NumbersDoNotDependOnTheLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"}) std::setlocale(LC_ALL, name);
  for (const GoldenMesh& golden : golden_meshes())
    EXPECT_EQ(golden.read().mesh.points(0, 1), 0.5) << golden.name;
  std::setlocale(LC_ALL, before.c_str());
}

TEST(MeshFiles, ElementsAreNamedAsTheFileNamesThem) {
  EXPECT_EQ(read_mesh("v1.msh", golden_text("v1.msh")).where(1), "v1.msh, line 14: tetrahedron 4");
  EXPECT_EQ(read_mesh("v2.msh", golden_text("v2.msh")).where(0), "v2.msh, line 19: tetrahedron 2");
  EXPECT_EQ(read_mesh("old.vtk", golden_text("old.vtk")).where(1), "old.vtk, line 11: tetrahedron 2");
  const std::string binary = golden_text("v2_little.msh");
  const MeshFile file = read_mesh("v2_little.msh", binary);
  const auto place = static_cast<std::size_t>(file.places[1]);
  EXPECT_EQ(binary.substr(place, 8), Bytes().ints({3, 9}).str());
  EXPECT_EQ(file.where(1), "v2_little.msh, byte " + std::to_string(place) + ": tetrahedron 3");
}

TEST(MeshFiles, SurfacesAreLeftAsideAndCounted) {
  EXPECT_EQ(read_mesh("v1.msh", golden_text("v1.msh")).triangles, 1);
  EXPECT_EQ(read_mesh("ghs3d.mesh", golden_text("ghs3d.mesh")).triangles, 1);
}

TEST(MeshFiles, PointsHaveTheNumbersOfTheirFile) {
  const auto numbers = [](const std::string& name) {
    for (const GoldenMesh& golden : golden_meshes())
      if (golden.name == name) return golden.read().point_numbers;
    return std::vector<std::int64_t>{};
  };
  using Numbers = std::vector<std::int64_t>;
  EXPECT_EQ(numbers("v1.msh"), (Numbers{2, 4, 6, 8, 10}));
  EXPECT_EQ(numbers("v41.msh"), (Numbers{1, 3, 5, 7, 9}));
  EXPECT_EQ(numbers("old.vtk"), (Numbers{0, 1, 2, 3, 4}));
  EXPECT_EQ(numbers("ascii.vtu"), (Numbers{0, 1, 2, 3, 4}));
  EXPECT_EQ(numbers("zero.node"), (Numbers{0, 1, 2, 3, 4}));
  EXPECT_EQ(numbers("one.node"), (Numbers{1, 2, 3, 4, 5}));
  EXPECT_EQ(numbers("ghs3d.mesh"), (Numbers{1, 2, 3, 4, 5}));
}

/// The groups of a file as "surface:3 'skin' 0 2 1".
std::vector<std::string> groups_of(const MeshFile& file) {
  std::vector<std::string> texts;
  for (const MeshGroup& group : file.groups) {
    std::string text(group_kinds[static_cast<std::size_t>(group.dimension)]);
    text += ":" + std::to_string(group.number) + " '" + group.name + "'";
    for (const TetMesh::Index corner : group.corners) text += " " + std::to_string(corner);
    texts.push_back(text);
  }
  return texts;
}

TEST(MeshFiles, PhysicalNamesOfGmshNameRegionsAndGroups) {
  using Texts = std::vector<std::string>;
  const std::string names =
      "$PhysicalNames\n4\n2 3 \"the skin\"\n3 7 \"lobe\"\n3 9 \"\"\n3 11 \"nowhere\"\n$EndPhysicalNames\n";
  const MeshFile two = read_mesh(
      "v2.msh",
      replaced(golden_text("v2.msh"), "$PhysicalNames\n1\n3 7 \"lobe\"\n$EndPhysicalNames\n", names));
  EXPECT_EQ(two.names, (std::map<TetMesh::Index, std::string>{{7, "lobe"}, {9, ""}}));
  EXPECT_EQ(groups_of(two), Texts{"surface:3 'the skin' 0 2 1"});
  // The same in 4.1, where elements belong to entities and these to groups.
  std::string four = golden_text("v41.msh");
  four.insert(four.find("$Entities"), names);
  four = replaced(four, "0 0 0 2\n", "0 0 1 2\n1 0 0 0 1 1 1 2 -3 4 0\n");
  const MeshFile read = read_mesh("v41.msh", four);
  EXPECT_EQ(read.names, (std::map<TetMesh::Index, std::string>{{7, "lobe"}, {9, ""}}));
  EXPECT_EQ(groups_of(read), (Texts{"surface:3 'the skin' 0 2 1", "surface:4 '' 0 2 1"}));
  EXPECT_EQ(read.region_in_words(7), "7 'lobe'");
  EXPECT_EQ(read.region_in_words(8), "8");
  // In binary files names are words too.
  std::string binary = golden_text("v2_little.msh");
  binary.insert(binary.find("$Nodes"), names);
  EXPECT_EQ(read_mesh("b.msh", binary).names.at(7), "lobe");
  EXPECT_EQ(groups_of(read_mesh("b.msh", binary)), Texts{"surface:3 'the skin' 0 2 1"});
}

TEST(MeshFiles, DamagedPhysicalNamesAreNamedWithTheirLine) {
  const std::string& text = golden_text("v2.msh");
  expect_refused("v2.msh", replaced(text, "3 7 \"lobe\"", "3 7 lobe"),
                 "v2.msh, line 6: the name of a physical group should be in double quotes");
  expect_refused("v2.msh", replaced(text, "3 7 \"lobe\"", "3 7 \"lobe"), "no closing quote");
  expect_refused("v2.msh", replaced(text, "3 7 \"lobe\"", "3 7 \"lo\x1b[31mbe\""), "control character");
  expect_refused("v2.msh", replaced(text, "$PhysicalNames\n1", "$PhysicalNames\n1000000"),
                 "announces 1000000 physical names");
  expect_refused("v2.msh", replaced(text, "$PhysicalNames\n1", "$PhysicalNames\n2"), "whole number");
}

TEST(MeshFiles, ReferencesMarkersAndLabelsAreGroups) {
  using Texts = std::vector<std::string>;
  EXPECT_EQ(groups_of(read_mesh("ghs3d.mesh", golden_text("ghs3d.mesh"))),
            (Texts{"vertices:1 '' 0 1 2 3 4", "surface:4 '' 0 2 1"}));
  EXPECT_EQ(groups_of(read_tetgen("a.node", "4 3 0 1\n0 0 0 0 0\n1 1 0 0 5\n2 0 1 0 -1\n3 0 0 1 5\n", "a.ele",
                                  "1 4 0\n0 0 1 2 3\n")),
            (Texts{"vertices:-1 '' 2", "vertices:5 '' 1 3"}));
  EXPECT_EQ(groups_of(read_mesh("old.vtk", golden_text("old.vtk"))), Texts{"surface:1 '' 0 2 1"});
}

/// A tetrahedron of ten nodes and one triangle of six, whose middles come last.
TEST(MeshFiles, SecondOrderIsReadByTheCorners) {
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const std::string middles = ".5 0 0\n.5 .5 0\n0 .5 0\n0 0 .5\n.5 0 .5\n0 .5 .5\n";
  std::string nodes, rest = points + middles, vertices;
  for (int i = 1; i <= 10; ++i) {
    const std::string line = rest.substr(0, rest.find('\n') + 1);
    nodes += std::to_string(i) + " " + line;
    vertices += line.substr(0, line.size() - 1) + " 0\n";
    rest.erase(0, line.size());
  }
  const std::string cell = "0 1 2 3 4 5 6 7 8 9\n", from_one = "1 2 3 4 5 6 7 8 9 10";
  const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n";
  const MeshFile gmsh =
      read_mesh("a.msh", head + nodes + "$EndNodes\n$Elements\n2\n1 9 2 5 1 1 2 3 5 6 7\n2 11 2 8 1 " +
                             from_one + "\n$EndElements\n");
  EXPECT_EQ(groups_of(gmsh), std::vector<std::string>{"surface:5 '' 0 1 2"});
  const MeshFile vtk = read_mesh(
      "a.vtk", "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n" +
                   points + middles + "CELLS 1 11\n10 " + cell + "CELL_TYPES 1\n24\n");
  const MeshFile medit = read_mesh("a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n10\n" +
                                                 vertices + "TetrahedraP2\n1\n" + from_one + " 8\nEnd\n");
  const MeshFile tetgen =
      read_tetgen("a.node", "10 3 0 0\n" + nodes, "a.ele", "1 10 1\n1 " + from_one + " 8\n");
  for (const MeshFile* file : {&gmsh, &vtk, &medit, &tetgen}) {
    SCOPED_TRACE(file->format);
    EXPECT_EQ(file->second_order, 1);
    EXPECT_EQ(file->mesh.tetrahedra, unit_tetrahedron().tetrahedra);
    EXPECT_EQ(file->mesh.points.leftCols(4), unit_tetrahedron().points);
    EXPECT_EQ(file->mesh.point_count(), 10);
  }
  expect_refused("a.vtk",
                 "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n" +
                     points + middles + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n24\n",
                 "a tetrahedron with 4 points");
}

TEST(MeshFiles, VegaHasRegionsByItsSets) {
  const std::string& text = golden_text("one.veg");
  const MeshFile file = read_mesh("one.veg", text);
  EXPECT_EQ(file.mesh.regions, (std::vector<TetMesh::Index>{1, 2}));  // the last region that has an element
  EXPECT_EQ(file.names, (std::map<TetMesh::Index, std::string>{{1, "lobe"}, {2, "tip"}}));
  EXPECT_EQ(file.point_numbers, (std::vector<std::int64_t>{1, 2, 3, 4, 5}));
  EXPECT_EQ(file.where(1), "one.veg, line 14: tetrahedron 2");
  const MeshFile whole = read_mesh("a.veg", replaced(text, "tip, soft", "allElements, soft"));
  EXPECT_EQ(whole.mesh.regions, (std::vector<TetMesh::Index>{2, 2}));
  const std::string from_zero =
      "*VERTICES\n4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n*ELEMENTS\nTETS\n1 4 0\n0 0 1 2 3\n";
  EXPECT_EQ(read_mesh("a.veg", from_zero).numbers, std::vector<std::int64_t>{0});
  EXPECT_TRUE(read_mesh("a.veg", from_zero).mesh.regions.empty());
  expect_refused("a.veg", replaced(text, "1,2\n", "1,3\n"), "a.veg, line 19: the set 'lobe' has '3'");
  expect_refused("a.veg", replaced(text, "tip, soft", "top, soft"), "uses the set 'top'");
  expect_refused("a.veg", replaced(text, "TET\n2 4", "CUBIC\n2 8"), "of type 'CUBIC'; mesh the body");
  expect_refused("a.veg", replaced(text, "2 2 3 4 5", "2 2 3 4 6"), "line 14: tetrahedron 2 needs node 6");
  expect_refused("a.veg", replaced(text, "2 2 3 4 5", "1 2 3 4 5"), "element 1 is given twice");
  expect_refused("a.veg", replaced(text, "*SET tip", "*INCLUDE b.veg\n*SET tip"),
                 "line 20: the file includes 'b.veg', but there is no such file beside it; put it there");
  expect_refused("a.veg", replaced(text, "5 3 0 0", "4 3 0 0"), "a section such as *ELEMENTS should be here");
  expect_refused("a.veg", replaced(text, "2 0.5 0 0", "2 0,5 0 0"), "should be a number and is '0,5'");
}

TEST(MeshFiles, DamagedCompressedBlocksAreRefused) {
  if (!block_compressor("vtkZLibDataCompressor")->decompress) GTEST_SKIP() << "built without zlib";
  const std::string text = goldens::vtu_zlib();
  // Sizes that the blocks do not have: in the head, first array; a block that is no zlib stream.
  const auto with_head = [&](std::initializer_list<std::int32_t> head) {
    const std::string& first = goldens::zlib_arrays.front();
    return replaced(text, first.substr(0, 28), encode_base64(Bytes().ints(head).str()));
  };
  expect_refused("z.vtu", with_head({2000000000, 64, 56, 30, 30}), "shorter than it says");
  expect_refused("z.vtu", with_head({2, 2000000000, 56, 18, 15}), "compressed block of an array is damaged");
  expect_refused("z.vtu", with_head({2, 64, 56, 2000000000, 30}), "shorter than it says");
  std::string damaged = text;
  const std::size_t block = damaged.find(goldens::zlib_arrays[1]) + 24;
  std::swap(damaged[block + 4], damaged[block + 9]);
  expect_refused("z.vtu", damaged, "; export the mesh again");
}

TEST(MeshFiles, ASurfaceAloneIsRefusedWithAWayToFillIt) {
  expect_refused("s.msh", "$NOD\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$ENDNOD\n$ELM\n1\n1 2 0 0 3 1 2 3\n$ENDELM\n",
                 "1 triangles and no tetrahedra, a surface only; fill it");
  expect_refused("s.mesh", "MeshVersionFormatted 1\nDimension 3\nVertices 1\n0 0 0 0\nEnd\n",
                 "no tetrahedra");
}

TEST(MeshFiles, ANodeThatIsMissingIsNamedWithLineAndElement) {
  expect_refused("v1.msh", replaced(golden_text("v1.msh"), "4 4 9 1 4 4 6 8 10", "4 4 9 1 4 4 6 8 11"),
                 "v1.msh, line 14: tetrahedron 4 needs node 11, which the file does not have");
  expect_refused("old.vtk", replaced(golden_text("old.vtk"), "4 1 2 3 4", "4 1 2 3 5"),
                 "old.vtk, line 11: tetrahedron 2 needs point 5, but the points are 0 to 4");
  expect_refused("m.mesh", replaced(golden_text("ghs3d.mesh"), "1 2 3 4 7", "0 2 3 4 7"),
                 "m.mesh, line 23: tetrahedron 1 needs point 0, but the points are 1 to 5");
  EXPECT_THROW(read_tetgen("a.node", "1 3 0 0\n1 0 0 0\n", "a.ele", "1 4 0\n1 1 2 3 4\n"),
               std::invalid_argument);
}

TEST(MeshFiles, TheSameNumberTwiceIsRefused) {
  expect_refused("v1.msh", replaced(golden_text("v1.msh"), "10 0.5", "8 0.5"), "node 8 is given twice");
}

TEST(MeshFiles, WhatIsNoNumberOrNotFiniteIsNamedWithItsLine) {
  const std::string& text = golden_text("v2.msh");
  expect_refused("v2.msh", replaced(text, "4 0.5 0 0", "4 0,5 0 0"),
                 "v2.msh, line 11: the x coordinate should be a number and is '0,5'");
  expect_refused("v2.msh", replaced(text, "4 0.5 0 0", "4 nan 0 0"),
                 "line 11: the x coordinate is 'nan', which is not finite");
  expect_refused("v2.msh", replaced(text, "4 0.5 0 0", "4 inf 0 0"), "not finite");
  expect_refused("v2.msh", replaced(text, "4 0.5 0 0", "4 1e999 0 0"), "beyond the range");
  expect_refused("v2.msh", replaced(text, "4 0.5 0 0", "4 0x1p3 0 0"), "should be a number");
  expect_refused(
      "b.msh",
      [] {
        Bytes file;
        file.text("$MeshFormat\n2.2 1 8\n").ints({1}).text("\n$EndMeshFormat\n$Nodes\n1\n");
        return file.ints({1}).reals({0, std::nan(""), 0}).text("\n$EndNodes\n").str();
      }(),
      "byte 61: the y coordinate is not finite");
}

TEST(MeshFiles, CountsThatCannotBeTrueReserveNothing) {
  expect_refused("v2.msh", replaced(golden_text("v2.msh"), "$Nodes\n5", "$Nodes\n2000000000"),
                 "the file announces 2000000000 nodes, but only");
  expect_refused("v2.msh", replaced(golden_text("v2.msh"), "$Elements\n3", "$Elements\n99999999999999"),
                 "2147483647");
  expect_refused("v2.msh", replaced(golden_text("v2.msh"), "$Nodes\n5", "$Nodes\n-5"), "announces -5 nodes");
  expect_refused("v2.msh", replaced(golden_text("v2.msh"), "$Nodes\n5", "$Nodes\n4"),
                 "$EndNodes should be here");
  expect_refused("v2.msh", replaced(golden_text("v2.msh"), "$Elements\n3", "$Elements\n4"),
                 "should be a whole number");
  expect_refused("a.vtu",
                 replaced(golden_text("ascii.vtu"), "NumberOfCells='2'", "NumberOfCells='2000000000'"),
                 "NumberOfCells");
  expect_refused("a.vtk", replaced(golden_text("old.vtk"), "CELLS 3 14", "CELLS 3 1400000"),
                 "announces 1400000 numbers of cells");
  expect_refused("m.mesh", replaced(golden_text("ghs3d.mesh"), "Tetrahedra\n2", "Tetrahedra\n2000000"),
                 "announces 2000000 tetrahedra");
}

TEST(MeshFiles, LinesThatLostOrGainedAWordAreNamed) {
  const std::string& text = golden_text("v2.msh");
  expect_refused("v2.msh", replaced(text, "4 0.5 0 0", "4 0.5 0"),
                 "line 11: the line ends where the z coordinate should be");
  expect_refused("v2.msh", replaced(text, "4 0.5 0 0", "4 0.5 0 0 0"),
                 "line 11: the line of a node goes on with '0'");
  expect_refused("v2.msh", replaced(text, "$Nodes\n5", "$Nodes\n5\n5"), "the line ends where");
  expect_refused("ascii.vtu", replaced(golden_text("ascii.vtu"), "0.5 0.5 0.5", "0.5 0.5 0.5 0.5"),
                 "an array goes on with '0.5'");
  EXPECT_THROW(read_tetgen("a.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 1\n", "a.ele",
                           "1 4 0\n0 0 1 2 3\n"),
               std::invalid_argument);
}

TEST(MeshFiles, CellsHaveThePointsOfTheirType) {
  expect_refused("a.vtk", replaced(golden_text("old.vtk"), "5 10 10", "5 0 10"),
                 "cell 1 is of type 0 with 4 points instead of 0");
}

TEST(MeshFiles, ACutOffFileSaysWhatIsMissing) {
  const std::string& text = golden_text("v2.msh");
  expect_refused("v2.msh", text.substr(0, text.find("$EndElements") - 4), "the file ends where");
  expect_refused("v2.msh", text.substr(0, text.find("$Elements")), "no tetrahedra");
  const std::string& vtu = golden_text("ascii.vtu");
  expect_refused("a.vtu", vtu.substr(0, vtu.find("</VTKFile>")), "</VTKFile> is missing");
  const std::string& vtk = golden_text("old.vtk");
  expect_refused("a.vtk", vtk.substr(0, vtk.size() - 1), "the last line has no end");
  const std::string& raw = golden_text("appended_raw.vtu");
  expect_refused("a.vtu", raw.substr(0, raw.find("  _") + 100), "cut off");
}

TEST(MeshFiles, OtherElementsAreRefusedWithTheRemedy) {
  expect_refused(
      "h.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 5 2 0 0 1 1 1 1 1 1 1 1\n$EndElements\n",
      "element 1 is of type 5, a volume that is no tetrahedron; mesh the body with tetrahedra only");
  expect_refused(
      "q.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 29 0 1 1 1 1 1 1 1 1 1 1\n$EndElements\n",
      "order 1 or 2");
  expect_refused("h.vtk", replaced(golden_text("old.vtk"), "5 10 10", "5 10 12"), "of type 12");
  expect_refused("h.mesh", replaced(golden_text("ghs3d.mesh"), "RequiredVertices", "Hexahedra"), "Hexahedra");
}

TEST(MeshFiles, ATetrahedronOfTwoPhysicalGroupsHasARemark) {
  const MeshFile file =
      read_mesh("v41.msh", replaced(golden_text("v41.msh"), "$Entities",
                                    "$PhysicalNames\n1\n3 7 \"lobe\"\n$EndPhysicalNames\n$Entities"));
  ASSERT_EQ(file.remarks.size(), 1U);
  EXPECT_TRUE(says(file.remarks[0], "tetrahedra of region 9 are in 7 'lobe' too, which is left out"));
  EXPECT_TRUE(read_mesh("v2.msh", golden_text("v2.msh")).remarks.empty());
}

TEST(MeshFiles, SectionsMayStandBeforeThoseThatTheyNeed) {
  const std::string comments = "$Comments\nby hand\n$EndComments\n";
  EXPECT_EQ(read_mesh("v2.msh", comments + golden_text("v2.msh")).mesh.points, golden_mesh().points);
  std::string medit = golden_text("ghs3d.mesh");
  const std::size_t begin = medit.find("Tetrahedra"), end = medit.find("End");
  const std::string section = medit.substr(begin, end - begin);
  const MeshFile file =
      read_mesh("m.mesh", replaced(replaced(medit, section, ""), "Vertices", section + "Vertices"));
  EXPECT_EQ(file.mesh.tetrahedra, golden_mesh().tetrahedra);
  EXPECT_EQ(file.mesh.regions, golden_mesh().regions);
  EXPECT_EQ(file.where(0), "m.mesh, line 8: tetrahedron 1");
}

TEST(MeshFiles, RegionsAreWholeNumbersInEachFormat) {
  const GoldenMesh tetgen{.name = "a.node",
                          .text = "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n",
                          .ele_name = "a.ele",
                          .ele_text = "1 4 1\n1 1 2 3 4 1.4\n"};
  EXPECT_TRUE(says(error_of<std::invalid_argument>([&] { (void)tetgen.read(); }),
                   "a.ele, line 2: the region of a tetrahedron should be a whole number and is '1.4'"));
  const auto vtu = [](const std::string& regions) {
    return replaced(replaced(golden_text("base64.vtu"), goldens::regions_64,
                             encode_base64(Bytes().ints({16}).str() + regions)),
                    "Int16", "Float64");
  };
  EXPECT_EQ(read_mesh("a.vtu", vtu(Bytes().reals({7, 9}).str())).mesh.regions, golden_mesh().regions);
  expect_refused("a.vtu", vtu(Bytes().reals({7, 9.5}).str()), "an array of whole numbers holds 9.5;");
  const auto vtk = [](float last) {
    return replaced(golden_text("new_binary.vtk"), "int\n" + Bytes(true).ints({7, 9}).str(),
                    "float\n" + Bytes(true).add<float>({7, last}).str());
  };
  EXPECT_EQ(read_mesh("a.vtk", vtk(9)).mesh.regions, golden_mesh().regions);
  expect_refused("a.vtk", vtk(9.5F), "a region should be a whole number and is 9.5;");
}

Eigen::Index tetrahedra(const char* name, const std::string& text) {
  return read_mesh(name, text).mesh.tetrahedron_count();
}

/// A mesh of so many pieces, each of one tetrahedron.
std::string many_pieces(int pieces) {
  std::string text = "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>\n";
  for (int i = 0; i < pieces; ++i)
    text +=
        "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<Points><DataArray type=\"Float64\" "
        "NumberOfComponents=\"3\" format=\"ascii\">\n0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>\n"
        "<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>\n"
        "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray>\n"
        "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells></Piece>\n";
  return text + "</UnstructuredGrid></VTKFile>\n";
}

/// A mesh with so many blocks, each of one tetrahedron.
std::string many_blocks(int blocks) {
  std::string text = fmt::format(
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
      "$EndNodes\n$Elements\n{0} {0} 1 {0}\n",
      blocks);
  for (int i = 1; i <= blocks; ++i) text += fmt::format("3 1 4 1\n{} 1 2 3 4\n", i);
  return text + "$EndElements\n";
}

/// So many sets of elements, each of one tetrahedron.
std::string many_element_sets(int sets) {
  std::string text = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n";
  for (int i = 1; i <= sets; ++i) text += fmt::format("*ELEMENT,TYPE=C3D4,ELSET=E{0}\n{0},1,2,3,4\n", i);
  return text;
}

/// So many sets of nodes, and one tetrahedron.
std::string many_node_sets(int sets) {
  std::string text =
      "<febio_spec version=\"4.0\"><Mesh><Nodes><node id=\"1\">0,0,0</node><node id=\"2\">1,0,0</node>"
      "<node id=\"3\">0,1,0</node><node id=\"4\">0,0,1</node></Nodes>"
      "<Elements type=\"tet4\" name=\"p\"><elem id=\"1\">1,2,3,4</elem></Elements>";
  for (int i = 0; i < sets; ++i) text += fmt::format("<NodeSet name=\"s{}\">1,2</NodeSet>\n", i);
  return text + "</Mesh></febio_spec>";
}

/// Lines before each piece once were counted anew, and room for each piece made by moving those before it.
TEST(MeshFiles, ManyPiecesAreReadInTimeProportionalToThem) {
  EXPECT_LT(growth_of_time([](int n) { EXPECT_EQ(tetrahedra("a.vtu", many_pieces(n)), n); }, 8000), 10);
  EXPECT_LT(growth_of_time([](int n) { EXPECT_EQ(tetrahedra("a.msh", many_blocks(n)), n); }, 30'000), 10);
  EXPECT_LT(growth_of_time([](int n) { EXPECT_EQ(tetrahedra("a.inp", many_element_sets(n)), n); }, 16'000),
            10);
  EXPECT_LT(growth_of_time([](int n) { EXPECT_EQ(tetrahedra("a.feb", many_node_sets(n)), 1); }, 8000), 10);
  expect_refused("a.vtu", replaced(many_pieces(1000), "0 1 2 3<", "0 1 2 4<"), "a.vtu, line 5: ");
}

TEST(MeshFiles, VersionsAndVariantsThatAreNotReadSayHowToSave) {
  expect_refused("v3.msh", "$MeshFormat\n3 0 8\n$EndMeshFormat\n", "save the mesh as 4.1 or 2.2");
  expect_refused("z.vtu", replaced(goldens::vtu_zlib(), "vtkZLibDataCompressor", "vtkZStdDataCompressor"),
                 "Compressor Type None");
  expect_refused("p.vtk", replaced(golden_text("old.vtk"), "UNSTRUCTURED_GRID", "POLYDATA"),
                 "save an unstructured grid");
  expect_refused("x.msh", "solid stl\n", "begins with $MeshFormat or $NOD");
  expect_refused("x.vtu", "solid stl\n", "<VTKFile>");
  expect_refused("x.mesh", "\x01\x02", "MeshVersionFormatted");
  EXPECT_THROW(read_mesh("x.stl", ""), std::invalid_argument);
}

TEST(MeshFiles, PairsOfTetgenAreFoundFromEitherFile) {
  const Scratch folder;
  const std::vector<GoldenMesh> goldens = golden_meshes();
  for (const GoldenMesh& golden : goldens) {
    write_text(folder / golden.name, golden.text);
    if (!golden.ele_name.empty()) write_text(folder / golden.ele_name, golden.ele_text);
  }
  for (const char* name : {"zero.node", "zero.ele", "v2.msh", "base64.vtu"})
    EXPECT_EQ(read_mesh_file(folder / name).mesh.points, golden_mesh().points) << name;
  EXPECT_THROW(read_mesh_file(folder / "none.msh"), std::invalid_argument);
  EXPECT_THROW(read_mesh_file(folder.folder()), std::invalid_argument);
  std::filesystem::remove(folder / "zero.ele");
  EXPECT_THROW(read_mesh_file(folder / "zero.node"), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
