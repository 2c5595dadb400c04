/// What cannot change a mesh is no reason to refuse its file; what can is one. Each case is the cut of a kind
/// of file that other programs write.
#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>

#include "problems/mesh/files/mesh_defects.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "tests/problems/mesh/files/mesh_goldens.hpp"
#include "tests/problems/mesh/meshes.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

GoldenMesh golden(const std::string& name) {
  const std::vector<GoldenMesh> all = golden_meshes();
  return *std::ranges::find(all, name, &GoldenMesh::name);
}

void expect_golden(const MeshFile& file) {
  EXPECT_EQ(file.mesh.points, golden_mesh().points);
  EXPECT_EQ(file.mesh.tetrahedra, golden_mesh().tetrahedra);
  EXPECT_EQ(file.mesh.regions, golden_mesh().regions);
}

std::string refusal(const GoldenMesh& mesh) {
  return error_of<std::invalid_argument>([&] { (void)mesh.read(); });
}

void expect_refused(const GoldenMesh& mesh, const std::string& named) {
  const std::string said = refusal(mesh);
  EXPECT_TRUE(says(said, named));
}

TEST(MeshTolerance, EveryBlankOfAsciiSeparatesWords) {
  for (const char blank : {'\t', '\r', '\f', '\v'}) {
    GoldenMesh mesh = golden("ghs3d.mesh");
    std::ranges::replace(mesh.text, ' ', blank);
    expect_golden(mesh.read());
  }
}

TEST(MeshTolerance, MeditWithoutItsEndIsReadDownToTheLastWord) {
  GoldenMesh mesh = golden("ghs3d.mesh");
  mesh.text = replaced(mesh.text, "\nEnd\n", "");
  expect_golden(mesh.read());
  mesh.text.pop_back();  // the line break: "5 9" may have been "5 91"
  expect_refused(mesh, "the last line has no end");
  mesh.text.erase(mesh.text.size() - 2);
  expect_refused(mesh, "the file ends where the reference of an element should be");
}

TEST(MeshTolerance, KeywordsMayBeInLettersOfAnyCase) {
  GoldenMesh medit = golden("ghs3d.mesh");
  for (const auto& [word, other] :
       {std::pair("Vertices", "VERTICES"), {"Tetrahedra", "tetrahedra"}, {"End", "END"}})
    medit.text = replaced(medit.text, std::string("\n") + word, std::string("\n") + other);
  expect_golden(medit.read());
  GoldenMesh vega = golden("one.veg");
  for (const auto& [word, other] :
       {std::pair("*VERTICES", "*vertices"), {"TET", "tet"}, {"*REGION", "*Region"}})
    vega.text = replaced(vega.text, word, other);
  EXPECT_EQ(vega.read().mesh.regions, golden("one.veg").read().mesh.regions);
  expect_golden(golden("field.vtk").read());  // which has all of VTK's
}

TEST(MeshTolerance, CommentsAndBlanksBehindTheRootOfXmlSayNothing) {
  for (const char* tail : {"<!-- written by an example -->\n", "\n\n<!-- a > b -->\n<?done?>\n"}) {
    GoldenMesh mesh = golden("ascii.vtu");
    mesh.text += tail;
    expect_golden(mesh.read());
  }
  for (const char* tail : {"<VTKFile>", "more", "<!-- no end", "</VTKFile>"}) {
    GoldenMesh mesh = golden("ascii.vtu");
    mesh.text += tail;
    EXPECT_NE(refusal(mesh), "");
  }
  GoldenMesh mesh = golden("ascii.vtu");  // an attribute may hold what ends a tag
  mesh.text = replaced(mesh.text, "<CellData>", "<CellData Scalars=\"a > b\">");
  expect_golden(mesh.read());
}

TEST(MeshTolerance, TheMarkOfWindowsStandsBeforeAnyFormat) {
  for (GoldenMesh mesh : {golden("v2.msh"), golden("old.vtk"), golden("ascii.vtu"), golden("ghs3d.mesh")}) {
    mesh.text.insert(0, "\xEF\xBB\xBF");
    EXPECT_EQ(mesh.read().mesh.points, golden_mesh().points);
  }
  const std::string mark = "\xEF\xBB\xBF";
  const Scratch folder;
  const GoldenMesh pair = golden("zero.node");
  write_text(folder / pair.name, mark + pair.text);
  write_text(folder / pair.ele_name, mark + pair.ele_text);
  EXPECT_EQ(read_mesh_file(folder / pair.name).mesh.points, golden_mesh().points);
  write_text(folder / "a.veg", mark + "*VERTICES\n*INCLUDE zero.node\n*ELEMENTS\nTET\n*INCLUDE zero.ele\n");
  EXPECT_EQ(read_mesh_file(folder / "a.veg").mesh.points, golden_mesh().points);
}

TEST(MeshTolerance, ANumberTooSmallForADoubleIsZero) {
  GoldenMesh mesh = golden("v2.msh");
  mesh.text = replaced(mesh.text, "4 0.5 0 0", "4 0.5 -1e-400 0.0e-999");
  EXPECT_EQ(mesh.read().mesh.points, golden_mesh().points);
  for (const char* large : {"1e400", "-1e400", "1e-400x"}) {
    mesh = golden("v2.msh");
    mesh.text = replaced(mesh.text, "4 0.5 0 0", std::string("4 0.5 0 ") + large);
    EXPECT_NE(refusal(mesh), "");
  }
}

TEST(MeshTolerance, ColumnsAndWordsThatTetgenDoesNotDeclareAreLeftAside) {
  GoldenMesh mesh = golden("one.node");
  mesh.text = replaced(mesh.text, "5 3 1 0\n", "5 3 1 0 points of a cube\n");
  mesh.ele_text = replaced(mesh.ele_text, "2 4 0\n", "2 4 0 0\n");
  EXPECT_EQ(mesh.read().mesh.tetrahedra, golden_mesh().tetrahedra);
  mesh.text = replaced(mesh.text, "5 3 1 0 points of a cube\n", "5 3\n");
  EXPECT_EQ(mesh.read().mesh.points, golden_mesh().points);
  EXPECT_EQ(golden("extra.node").read().mesh.regions, golden_mesh().regions);
  // A row of another length has lost a number.
  mesh = golden("extra.node");
  mesh.text = replaced(mesh.text, "3 0 0.5 0 x", "3 0 0.5 x");
  expect_refused(mesh, "the z coordinate should be a number and is 'x'");
  mesh = golden("extra.node");
  mesh.text = replaced(mesh.text, "3 0 0.5 0 x 0 8 8", "3 0 0.5 0 x 0 8");
  expect_refused(mesh, "extra.node, line 4: the line of a point has 1 numbers too many and the first one 2");
  mesh = golden("extra.node");
  mesh.ele_text = replaced(mesh.ele_text, "2 2 3 4 5 9", "2 2 3 4 9 5");
  expect_refused(mesh, "needs node 9");
}

TEST(MeshTolerance, ArraysInWordsNeedNoCompressor) {
  GoldenMesh mesh = golden("ascii.vtu");
  mesh.text = replaced(mesh.text, "byte_order", "compressor=\"vtkZStdDataCompressor\" byte_order");
  expect_golden(mesh.read());
}

TEST(MeshTolerance, ValuesThatNobodyNeedsMustStillBeThere) {
  GoldenMesh mesh = golden("field.vtk");
  mesh.text = replaced(mesh.text, "0 1.#IND -nan(ind) none 4", "0 1.#IND -nan(ind) none");
  expect_refused(mesh, "an array ends with 'Cell_Data' after 4 of 5 values");
  mesh = golden("field.vtk");
  mesh.text = replaced(mesh.text, "7.0 9.0", "7.0 9.5");
  expect_refused(mesh, "a region should be a whole number and is '9.5'");
}

/// A string of VTK's binary files: its length in one, two, four or eight bytes.
std::string vtk_string(std::size_t size) {
  Bytes head(true);
  if (size < 64)
    head.add<std::uint8_t>({static_cast<std::uint8_t>(0xC0 | size)});
  else
    head.add<std::uint16_t>({static_cast<std::uint16_t>(0x8000 | size)});
  return head.str() + std::string(size, 'x');
}

TEST(MeshTolerance, StringsAndBitsOfBinaryFieldsAreGoneBeyond) {
  GoldenMesh mesh = golden("old_binary.vtk");
  mesh.text = replaced(mesh.text, "POINTS 5",
                       "FIELD FieldData 2\ntext 1 3 string\n" + vtk_string(5) + vtk_string(0) +
                           vtk_string(300) + "\nbits 1 9 bit\n\x55\x01\nPOINTS 5");
  expect_golden(mesh.read());
  mesh.text = replaced(mesh.text, "1 9 bit", "1 999999999 bit");
  EXPECT_NE(refusal(mesh), "");
}

TEST(MeshTolerance, PiecesOfAGridFollowEachOther) {
  const std::string ascii = "format=\"ascii\">";
  const auto piece = [&](const std::string& points, const std::string& region, const std::string& ghosts) {
    return "<Piece NumberOfPoints=\"" + std::to_string(std::count(points.begin(), points.end(), ' ') / 3) +
           "\" NumberOfCells=\"" + std::to_string(1 + std::count(region.begin(), region.end(), ' ')) +
           "\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" " + ascii + points +
           "</DataArray></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" " + ascii +
           "0 1 2 3" + (region.find(' ') == std::string::npos ? "" : " 1 2 3 4") +
           "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" " + ascii +
           "4 8</DataArray><DataArray type=\"UInt8\" Name=\"types\" " + ascii +
           "10 10</DataArray></Cells><CellData>" + "<DataArray type=\"Int32\" Name=\"region\" " + ascii +
           region + "</DataArray>" + ghosts + "</CellData></Piece>";
  };
  const auto file = [&](const std::string& pieces) {
    std::string text =
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>" + pieces + "</UnstructuredGrid></VTKFile>\n";
    return text;
  };
  const auto one = [](std::string text) {
    for (const auto& [two, single] : {std::pair("4 8<", "4<"), {"10 10<", "10<"}})
      if (const auto at = text.find(two); at != std::string::npos)
        text.replace(at, std::string(two).size(), single);
    return text;
  };
  const std::string first = one(piece("0 0 0 0.5 0 0 0 0.5 0 0 0 0.5 ", "7", ""));
  const std::string second = one(piece("0.5 0 0 0 0.5 0 0 0 0.5 0.5 0.5 0.5 ", "9", ""));
  const std::string empty = "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"></Piece>";
  MeshFile read = read_mesh("a.vtu", file(first + empty + second));
  EXPECT_EQ(read.mesh.point_count(), 8);
  EXPECT_EQ(read.numbers, (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(merge_points(read, 0), 3);
  expect_golden(read);
  // Tetrahedra of one piece would be of another region than they were.
  for (const std::string& pieces : {first + replaced(second, "Name=\"region\"", "Name=\"other\""),
                                    replaced(first, "Name=\"region\"", "Name=\"other\"") + second}) {
    GoldenMesh mesh{.name = "a.vtu", .text = file(pieces), .ele_name = "", .ele_text = ""};
    expect_refused(mesh, "the array 'region' has the regions of this piece, and piece ");
  }
  // A cell that another piece has, too, is one of these only.
  const std::string ghosts =
      "<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">1 0</DataArray>";
  read = read_mesh("a.vtu", file(first + piece("0 0 0 0.5 0 0 0 0.5 0 0 0 0.5 0.5 0.5 0.5 ", "7 9", ghosts)));
  EXPECT_EQ(read.mesh.tetrahedron_count(), 2);
  merge_points(read, 0);
  expect_golden(read);
  // No cell reaches into another piece.
  for (const char* corner : {"0 1 2 4", "-1 1 2 3"}) {
    GoldenMesh mesh{.name = "a.vtu",
                    .text = file(first + replaced(second, "0 1 2 3", corner)),
                    .ele_name = "",
                    .ele_text = ""};
    expect_refused(mesh, "tetrahedron 1 needs point");
  }
}

TEST(MeshTolerance, AnIncludedFileStandsInThePlaceOfItsLineAnywhere) {
  const Scratch folder;
  const auto read = [&](const std::string& text) {
    write_text(folder / "a.veg", text);
    return read_mesh_file(folder / "a.veg");
  };
  write_text(folder / "part.set", "1,\n2\n");
  write_text(folder / "one.node",
             "# TetGen\n5 3 0 1\n1 0 0 0 4\n2 0.5 0 0 4\n3 0 0.5 0 4\n4 0 0 0.5 4\n5 0.5 0.5 0.5 4\n# end\n");
  write_text(folder / "one.ele", "2 4 1\n1 1 2 3 4 7\n2 2 3 4 5 9\n");
  write_text(folder / "more.veg", "*INCLUDE sets.veg\n*REGION\ntip, soft\n");
  write_text(folder / "sets.veg", "*SET tip\n2\n");
  const std::string head = "*VERTICES\n*INCLUDE one.node\n*ELEMENTS\nTET\n*INCLUDE one.ele\n";
  const MeshFile whole = read(
      head + "*MATERIAL soft\nENU, 1000, 5000, 0.45\n*SET part\n*INCLUDE part.set\n*REGION\npart, soft\n");
  EXPECT_EQ(whole.mesh.points, golden_mesh().points);
  EXPECT_EQ(whole.mesh.tetrahedra, golden_mesh().tetrahedra);
  EXPECT_EQ(whole.mesh.regions, (std::vector<TetMesh::Index>{1, 1}));
  EXPECT_EQ(whole.names.at(1), "part");
  EXPECT_EQ(whole.places, (std::vector<std::int64_t>{5, 5}));
  EXPECT_EQ(read(head + "*include more.veg\n").names.at(1), "tip");
  const auto refused = [&](const std::string& text, const std::string& named) {
    write_text(folder / "a.veg", text);
    EXPECT_TRUE(says(error_of<std::invalid_argument>([&] { read_mesh_file(folder / "a.veg"); }), named));
  };
  refused(head + "*SET part\n*INCLUDE none.set\n",
          "a.veg, line 7: the file includes 'none.set', but there is no such file");
  refused(head + "*INCLUDE a.veg\n", "which includes it again");
  write_text(folder / "loop.veg", "*INCLUDE loop.veg\n");
  refused(head + "*INCLUDE loop.veg\n",
          "loop.veg, line 1: the file includes 'loop.veg', which includes it again");
  for (int i = 1; i <= 17; ++i)
    write_text(folder / ("deep" + std::to_string(i) + ".veg"),
               "*INCLUDE deep" + std::to_string(i + 1) + ".veg\n");
  refused(head + "*INCLUDE deep1.veg\n",
          "deep16.veg, line 1: the file includes 'deep17.veg', the 17th file in one another, and 16 may be");
  std::string often = head;
  write_text(folder / "nothing.veg", "# nothing\n");
  for (int i = 0; i < 999; ++i) often += "*INCLUDE nothing.veg\n";
  // Points and tetrahedra were the first two.
  refused(often, "a.veg, line 1004: the file includes 'nothing.veg', but 1000 files are included before it");
  write_text(folder / "part.set", "1,\n3\n");
  refused(head + "*SET part\n*INCLUDE part.set\n", "part.set, line 2: the set 'part' has '3'");
  write_text(folder / "part.set", "1,\n2");
  refused(head + "*SET part\n*INCLUDE part.set\n", "the last line has no end");
}

}  // namespace
}  // namespace hmax
