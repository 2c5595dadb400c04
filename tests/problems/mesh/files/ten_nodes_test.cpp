/// Tetrahedra of ten nodes from files of every format.
#include "problems/mesh/files/ten_nodes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/mesh/files/mesh_defects.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/mesh/ten_node.hpp"
#include "tests/problems/mesh/meshes.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Eigen::Vector3d;
using EdgeOrder = std::array<std::array<int, 2>, 6>;

/// Corners of the unit tetrahedron.
Vector3d corner(int i) { return unit_tetrahedron().points.col(i); }

/// Ten points, "x y z" of each: the corners, then the middles of these edges, pushed outwards by `bend`.
std::vector<std::string> ten_lines(const EdgeOrder& edges, double bend = 0) {
  std::vector<Vector3d> places;
  for (int i = 0; i < 4; ++i) places.push_back(corner(i));
  for (const auto& [i, j] : edges) {
    const Vector3d middle = (corner(i) + corner(j)) / 2;
    places.push_back(middle + bend * (middle - Vector3d::Constant(0.25)));
  }
  std::vector<std::string> lines;
  for (const Vector3d& x : places)
    lines.push_back(std::to_string(x[0]) + " " + std::to_string(x[1]) + " " + std::to_string(x[2]));
  return lines;
}

std::string numbered(const std::vector<std::string>& lines) {
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) text += std::to_string(i + 1) + " " + lines[i] + "\n";
  return text;
}

const std::string from_one = "1 2 3 4 5 6 7 8 9 10";
const std::string gmsh_head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n";

// The order of each format as Gmsh 4.8 (msh, vtk, mesh) and TetGen 1.5 with -o2 (ele) write it.
constexpr EdgeOrder of_gmsh{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}}};
constexpr EdgeOrder of_vtk{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};
constexpr EdgeOrder of_tetgen{{{2, 3}, {0, 3}, {0, 1}, {1, 2}, {1, 3}, {0, 2}}};

MeshFile gmsh_file(double bend = 0) {
  return read_mesh("a.msh", gmsh_head + "10\n" + numbered(ten_lines(of_gmsh, bend)) +
                                "$EndNodes\n$Elements\n2\n1 9 2 5 1 1 2 3 5 6 7\n7 11 2 8 1 " + from_one +
                                "\n$EndElements\n");
}
MeshFile vtk_file(double bend) {
  std::string points;
  for (const std::string& line : ten_lines(of_vtk, bend)) points += line + "\n";
  return read_mesh("a.vtk",
                   "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n" +
                       points + "CELLS 1 11\n10 0 1 2 3 4 5 6 7 8 9\nCELL_TYPES 1\n24\n");
}
MeshFile vtu_file(double bend) {
  std::string points;
  for (const std::string& line : ten_lines(of_vtk, bend)) points += line + "\n";
  return read_mesh(
      "a.vtu",
      "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\"><UnstructuredGrid><Piece NumberOfPoints=\"10\" "
      "NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" +
          points +
          "</DataArray></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 "
          "3 4 5 6 7 8 9</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">10"
          "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">24</DataArray></Cells>"
          "</Piece></UnstructuredGrid></VTKFile>\n");
}
MeshFile medit_file(double bend) {
  std::string vertices;
  for (const std::string& line : ten_lines(of_vtk, bend)) vertices += line + " 0\n";
  return read_mesh("a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n10\n" + vertices +
                                 "TetrahedraP2\n1\n" + from_one + " 8\nEnd\n");
}
MeshFile tetgen_file(double bend) {
  return read_tetgen("a.node", "10 3 0 0\n" + numbered(ten_lines(of_tetgen, bend)), "a.ele",
                     "1 10 1\n1 " + from_one + " 8\n");
}

MeshFile inp_file(double bend) {
  std::string nodes = numbered(ten_lines(of_vtk, bend)), element = "1 " + from_one;
  for (std::string* const text : {&nodes, &element}) std::ranges::replace(*text, ' ', ',');
  return read_mesh("a.inp", "*NODE\n" + nodes + "*ELEMENT, TYPE=C3D10\n" + element + "\n*STEP\n*END STEP\n");
}
MeshFile febio_file(double bend) {
  std::string nodes, element = from_one;
  for (std::string line : ten_lines(of_vtk, bend)) {
    std::ranges::replace(line, ' ', ',');
    nodes += "<node id=\"" + std::to_string(1 + std::ranges::count(nodes, '/')) + "\">" + line + "</node>";
  }
  std::ranges::replace(element, ' ', ',');
  return read_mesh("a.feb", "<febio_spec version=\"4.0\"><Mesh><Nodes>" + nodes +
                                "</Nodes><Elements type=\"tet10\" name=\"a\"><elem id=\"1\">" + element +
                                "</elem></Elements></Mesh></febio_spec>\n");
}

// Of Abaqus, CalculiX and FEBio by their manuals.
TEST(TenNodes, HaveTheirMiddlesWhereEachFormatListsThem) {
  const double bend = 0.1;
  for (const MeshFile& file : {gmsh_file(bend), vtk_file(bend), vtu_file(bend), medit_file(bend),
                               tetgen_file(bend), inp_file(bend), febio_file(bend)}) {
    SCOPED_TRACE(file.format);
    EXPECT_EQ(file.second_order, 1);
    const MeshFile ten = with_ten_nodes(file);
    ASSERT_EQ(ten.mesh.element_count(), 1);
    EXPECT_EQ(ten.mesh.point_count(), 10);
    EXPECT_TRUE(ten.inserted.empty());
    for (std::size_t e = 0; e < 6; ++e) {
      const auto& [i, j] = tetrahedron_edges[e];
      const Vector3d middle = (corner(i) + corner(j)) / 2;
      const Vector3d there = middle + bend * (middle - Vector3d::Constant(0.25));
      const Vector3d read = ten.mesh.points.col(ten.mesh.ten_node(4 + static_cast<Eigen::Index>(e), 0));
      EXPECT_LT((read - there).norm(), 1e-5) << i << j;
    }
    EXPECT_TRUE(all_positive(ten.mesh));
  }
}

TEST(TenNodes, AreCutIntoPartsThatKeepWhatTheFileCallsThem) {
  const MeshFile ten = with_ten_nodes(gmsh_file());
  EXPECT_EQ(ten.mesh.tetrahedron_count(), 8);
  EXPECT_EQ(ten.numbers, std::vector<std::int64_t>(8, 7));
  EXPECT_EQ(ten.where(5), "a.msh, line 20: tetrahedron 7");
  EXPECT_EQ(ten.mesh.regions, std::vector<TetMesh::Index>(8, 8));
  // The triangle of six nodes: four of three.
  ASSERT_EQ(ten.groups.size(), 1U);
  EXPECT_EQ(ten.groups[0].corners, (std::vector<TetMesh::Index>{0, 4, 6, 4, 1, 5, 6, 5, 2, 4, 5, 6}));
  // Written out the parts are numbered.
  EXPECT_TRUE(says(msh_text(ten), "\n2 4 2 8"));
}

TEST(TenNodes, GetMiddlesWhereTheFileHasNone) {
  // A tetrahedron of ten nodes and one of four on its face 1 2 3: three of its middles are known.
  std::vector<std::string> lines = ten_lines(of_gmsh, 0.1);
  lines.push_back("1 1 1");
  const MeshFile file =
      read_mesh("a.msh", gmsh_head + "11\n" + numbered(lines) + "$EndNodes\n$Elements\n2\n1 11 2 8 1 " +
                             from_one + "\n2 4 2 8 1 11 2 4 3\n$EndElements\n");
  require_valid(file);
  const MeshFile ten = with_ten_nodes(file);
  EXPECT_EQ(ten.mesh.element_count(), 2);
  EXPECT_EQ(ten.mesh.point_count(), 14);
  EXPECT_EQ(ten.inserted.size(), 3U);
  EXPECT_EQ(ten.point_numbers.back(), 14);
  for (const auto& [point, one, other] : ten.inserted)
    EXPECT_EQ(ten.mesh.points.col(point), (ten.mesh.points.col(one) + ten.mesh.points.col(other)) / 2);
  EXPECT_EQ(surface_of(ten.mesh).triangles.cols(), 4 * 6) << "the parts fit together";
  EXPECT_NEAR(
      enclosed_volume(ten.mesh),
      [&] {
        double sum = 0;
        for (Eigen::Index t = 0; t < ten.mesh.tetrahedron_count(); ++t)
          sum += signed_volume(corners_of(ten.mesh, t));
        return sum;
      }(),
      1e-12);
}

TEST(TenNodes, AreRefusedByNumberAndFileWhereTheyAreBentTooFar) {
  EXPECT_EQ(
      error_of<std::invalid_argument>([&] { with_ten_nodes(gmsh_file(-1.5)); }),
      "a.msh, line 20: tetrahedron 7 has a part without volume: its sides are bent too far, or its middles "
      "are in the order of another format; export the mesh again, or use a model of tetrahedra of four nodes");
}

TEST(TenNodes, AreCutAlongADiagonalThatKeepsPartsPositive) {
  // Of a coarse sphere by Gmsh, rounded: the shortest diagonal turns a part over.
  TetMesh mesh;
  mesh.points.resize(3, 10);
  mesh.points << -0.6, 0.29, 0.71, 0, -0.23, 0.54, 0.05, -0.34, 0.38, 0.16,  // x
      0.55, -0.64, 0, 0, -0.07, -0.35, 0.28, 0.31, 0, -0.35,                 // y
      0.58, 0.71, 0.71, 1, 0.97, 0.77, 0.64, 0.89, 0.92, 0.92;               // z
  mesh.tetrahedra.resize(4, 1);
  mesh.tetrahedra << 0, 1, 2, 3;
  MeshFile file = counted_from_one(mesh);
  file.middles.resize(6, 1);
  file.middles << 4, 6, 7, 5, 9, 8;
  const MeshFile ten = with_ten_nodes(file);
  EXPECT_TRUE(all_positive(ten.mesh));
  Eigen::Index shortest = 0;
  Vector3d lengths;
  for (int k = 0; k < 3; ++k) {  // of opposite edges
    const auto own = ten.mesh.ten_node.col(0);
    lengths[k] = (mesh.points.col(own(4 + k)) - mesh.points.col(own(9 - k))).norm();
  }
  lengths.minCoeff(&shortest);
  const auto inner = ten.mesh.tetrahedra.col(7);
  EXPECT_FALSE((inner.array() == ten.mesh.ten_node(4 + shortest, 0)).any() &&
               (inner.array() == ten.mesh.ten_node(9 - shortest, 0)).any());
}

TEST(TenNodes, TakeOneMiddleOfAnEdge) {
  // Two on a face with nodes of their own in its middles: at one place they are one, apart they are refused.
  std::vector<std::string> lines = ten_lines(of_gmsh);
  for (const char* extra : {"1 1 1", "1 .5 .5", ".5 .5 1", ".5 1 .5", ".5 0 .5", "0 .5 .5", ".5 .5 0"})
    lines.push_back(extra);
  const auto file = [&] {
    return read_mesh("a.msh", gmsh_head + "17\n" + numbered(lines) + "$EndNodes\n$Elements\n2\n1 11 2 8 1 " +
                                  from_one + "\n2 11 2 8 1 11 2 4 3 12 15 13 14 16 17\n$EndElements\n");
  };
  EXPECT_EQ(with_ten_nodes(file()).mesh.ten_node(4 + 3, 0), 5) << "the first";
  EXPECT_EQ(surface_of(with_ten_nodes(file()).mesh).triangles.cols(), 24);
  lines[15] = "0.05 .5 .55";
  EXPECT_TRUE(says(error_of<std::invalid_argument>([&] { with_ten_nodes(file()); }),
                   "a.msh, line 27: tetrahedron 2 has node 16 in the middle of an "
                   "edge where its neighbour has node 9"));
}

TEST(TenNodes, AreJoinedWhereCornersAreMerged) {
  // Each has nodes of its own. Corners are merged, and of the middles at one place the first is taken.
  std::vector<std::string> lines = ten_lines(of_gmsh);
  for (const char* own :
       {"1 1 1", "1 0 0", "0 0 1", "0 1 0", "1 .5 .5", ".5 0 .5", ".5 .5 1", ".5 1 .5", "0 .5 .5", ".5 .5 0"})
    lines.push_back(own);
  MeshFile file =
      read_mesh("a.msh", gmsh_head + "20\n" + numbered(lines) + "$EndNodes\n$Elements\n2\n1 11 2 8 1 " +
                             from_one + "\n2 11 2 8 1 11 12 13 14 15 16 17 18 19 20\n$EndElements\n");
  EXPECT_EQ(topology_of(with_ten_nodes(file).mesh).components, 2);
  EXPECT_EQ(merge_points(file, 0), 3);
  const TetMesh one = with_ten_nodes(file).mesh;
  EXPECT_EQ(topology_of(one).components, 1);
  EXPECT_EQ(surface_of(one).triangles.cols(), 24);
}

TEST(TenNodes, AreRefinedAlongTheirCurvedSides) {
  const MeshFile file = gmsh_file(0.1);
  const double volume = element_volume(with_ten_nodes(file).mesh, 0);
  const MeshFile fine = refined(file, 1);
  EXPECT_EQ(fine.mesh.tetrahedron_count(), 8);
  EXPECT_EQ(fine.middles.cols(), 8);
  const TetMesh ten = with_ten_nodes(fine).mesh;
  double sum = 0;
  for (Eigen::Index e = 0; e < ten.element_count(); ++e) sum += element_volume(ten, e);
  EXPECT_NEAR(sum, volume, 1e-14);
  // Not so of the corners, whose volume tends to it.
  double corners = 0;
  for (Eigen::Index t = 0; t < 8; ++t) corners += signed_volume(corners_of(fine.mesh, t));
  EXPECT_GT(std::abs(corners - volume), 1e-3);
  ASSERT_EQ(fine.groups.size(), 1U);
  EXPECT_EQ(fine.groups[0].corners.size(), 12U);
}

TEST(TenNodes, KeepTheirOrderWhereMeshesAreRenumbered) {
  const TetMesh cube = cube_mesh(0.1, 2);
  MeshFile file = counted_from_one(cube);
  const MeshImport import = import_mesh(with_ten_nodes(file), 1);
  const TetMesh& mesh = import.mesh;
  ASSERT_EQ(mesh.element_count(), cube.tetrahedron_count());
  for (Eigen::Index e = 0; e < mesh.element_count(); ++e) {
    // The parts have the points of their element, and its number.
    for (Eigen::Index part = 0; part < 8; ++part) {
      for (const TetMesh::Index point : mesh.tetrahedra.col(8 * e + part))
        EXPECT_EQ((mesh.ten_node.col(e).array() == point).count(), 1);
      EXPECT_EQ(import.origin.tetrahedron_number(8 * e + part), import.origin.tetrahedron_number(8 * e));
    }
    // The corners are those of the tetrahedron with this number.
    const auto number = import.origin.tetrahedron_number(8 * e);
    for (int i = 0; i < 4; ++i)
      EXPECT_EQ(mesh.points.col(mesh.ten_node(i, e)), cube.points.col(cube.tetrahedra(i, number - 1)));
    for (std::size_t k = 0; k < 6; ++k) {
      const auto& [i, j] = tetrahedron_edges[k];
      EXPECT_LT((mesh.points.col(mesh.ten_node(4 + static_cast<Eigen::Index>(k), e)) -
                 (mesh.points.col(mesh.ten_node(i, e)) + mesh.points.col(mesh.ten_node(j, e))) / 2)
                    .norm(),
                1e-16);
    }
  }
}

TEST(TenNodes, GoAlongWithCornersThatAreMended) {
  MeshFile file = counted_from_one(cube_mesh(1, 2));
  file.mesh.points.col(13) += Vector3d(0.3, 0.1, 0.05);  // the inner point
  const MeshFile ten = with_ten_nodes(file);
  file.middles = ten.mesh.ten_node.bottomRows<6>();
  file.mesh.points = ten.mesh.points;
  file.point_numbers = ten.point_numbers;
  const Eigen::Matrix3Xd before = file.mesh.points;
  EXPECT_FALSE(mend(file, 8).moved.empty());
  EXPECT_NE(file.mesh.points.col(13), before.col(13));
  const TetMesh mended = with_ten_nodes(file).mesh;
  for (Eigen::Index e = 0; e < mended.element_count(); ++e)
    for (std::size_t k = 0; k < 6; ++k) {
      const auto& [i, j] = tetrahedron_edges[k];
      EXPECT_LT((mended.points.col(mended.ten_node(4 + static_cast<Eigen::Index>(k), e)) -
                 (mended.points.col(mended.ten_node(i, e)) + mended.points.col(mended.ten_node(j, e))) / 2)
                    .norm(),
                1e-15);
    }
}

}  // namespace
}  // namespace hmax
