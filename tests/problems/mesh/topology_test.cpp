#include "problems/mesh/topology.hpp"

#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

TEST(MeshTopology, OneTetrahedronIsItsOwnSurface) {
  const TetMesh mesh = unit_tetrahedron();
  const MeshTopology topology = topology_of(mesh);
  EXPECT_EQ(topology.edges, 6);
  EXPECT_EQ(topology.faces, 4);
  EXPECT_EQ(topology.surface_triangles, 4);
  EXPECT_EQ(topology.surface_edges, 6);
  EXPECT_EQ(topology.surface_points, 4);
  EXPECT_EQ(topology.components, 1);
  EXPECT_EQ(topology.unused_points, 0);
  EXPECT_DOUBLE_EQ(enclosed_volume(mesh), 1.0 / 6);
}

TEST(MeshTopology, CountsOfSolidsKeepEulersIdentities) {
  for (const TetMesh& mesh : {cube_mesh(1, 3), beam_mesh(2, 1, 1, 2), ball_mesh(1, 3)}) {
    const MeshTopology t = topology_of(mesh);
    EXPECT_EQ(t.euler(), 1);
    EXPECT_EQ(t.surface_euler(), 2);
    EXPECT_EQ(2 * t.surface_edges, 3 * t.surface_triangles);
    EXPECT_EQ(2 * t.faces, 4 * t.tetrahedra + t.surface_triangles);
    EXPECT_EQ(t.crowded_faces, 0);
    EXPECT_EQ(t.components, 1);
  }
}

TEST(MeshTopology, AHoleInTheMiddleIsAHandle) {
  TetMesh mesh = cube_mesh(1, 3);
  TetMesh frame = mesh;
  Eigen::Index kept = 0;
  for (const auto& tetrahedron : mesh.tetrahedra.colwise()) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const TetMesh::Index point : tetrahedron) centre += mesh.points.col(point) / 4;
    if (centre(0) > 1. / 3 && centre(0) < 2. / 3 && centre(1) > 1. / 3 && centre(1) < 2. / 3) continue;
    frame.tetrahedra.col(kept++) = tetrahedron;
  }
  frame.tetrahedra.conservativeResize(4, kept);
  EXPECT_EQ(topology_of(frame).euler(), 0);
  EXPECT_EQ(topology_of(frame).surface_euler(), 0);
  EXPECT_NEAR(enclosed_volume(frame), 8. / 9, 1e-14);
}

TEST(MeshTopology, TheEdgesAreThoseOfASetOfPairs) {
  const TetMesh mesh = ball_mesh(1, 2);
  std::set<std::pair<int, int>> pairs;
  for (const auto& t : mesh.tetrahedra.colwise())
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        if (t(i) < t(j)) pairs.emplace(t(i), t(j));
  const EdgeTable table = edge_table(mesh);
  ASSERT_EQ(table.edges.cols(), static_cast<Eigen::Index>(pairs.size()));
  Eigen::Index e = 0;
  for (const auto& [a, b] : pairs) {
    EXPECT_EQ(table.edges(0, e), a);
    EXPECT_EQ(table.edges(1, e), b);
    EXPECT_EQ(table.find(a, b), e);
    EXPECT_EQ(table.find(b, a), e);
    ++e;
  }
  for (int a = 0; a < mesh.point_count(); ++a)
    for (int b = a; b < mesh.point_count(); ++b) EXPECT_EQ(table.find(a, b) >= 0, pairs.contains({a, b}));
}

TEST(MeshTopology, TheSurfaceFacesOutward) {
  const TetMesh mesh = ball_mesh(2, 3);
  const MeshSurface surface = surface_of(mesh);
  EXPECT_EQ(surface.triangles.cols(), 20 * 9);
  for (const auto& triangle : surface.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.points.col(triangle(0)), b = mesh.points.col(triangle(1)),
                          c = mesh.points.col(triangle(2));
    EXPECT_GT((b - a).cross(c - a).dot(a), 0);
  }
  for (Eigen::Index k = 0; k < surface.triangles.cols(); ++k) {
    const auto owner = mesh.tetrahedra.col(surface.inside[static_cast<std::size_t>(k)]);
    for (const TetMesh::Index point : surface.triangles.col(k)) EXPECT_TRUE((owner.array() == point).any());
  }
  for (const TetMesh::Index point : surface.points) EXPECT_DOUBLE_EQ(mesh.points.col(point).norm(), 2);
}

TEST(MeshTopology, SeparatePartsAndIdlePointsAreCounted) {
  TetMesh mesh = unit_tetrahedron();
  mesh.points.conservativeResize(3, 10);
  mesh.points.rightCols(6).setRandom();
  mesh.tetrahedra.conservativeResize(4, 2);
  mesh.tetrahedra.col(1) << 4, 6, 7, 8;
  EXPECT_EQ(topology_of(mesh).components, 2);
  EXPECT_EQ(topology_of(mesh).unused_points, 2);
  EXPECT_EQ(unused_points(mesh), (std::vector<TetMesh::Index>{5, 9}));
  EXPECT_EQ(topology_of(mesh).euler(), 2);
}

TEST(MeshTopology, AFaceOfThreeTetrahedraIsCrowded) {
  TetMesh mesh = unit_tetrahedron();
  mesh.tetrahedra.conservativeResize(4, 3);
  mesh.points.conservativeResize(3, 6);
  mesh.points.rightCols(2) << 1, 2, 1, 2, 1, 2;
  mesh.tetrahedra.col(1) << 1, 2, 3, 4;
  mesh.tetrahedra.col(2) << 1, 2, 3, 5;
  EXPECT_EQ(topology_of(mesh).crowded_faces, 1);
}

TEST(MeshTopology, AMeshOfNothingHasNoEdges) {
  const MeshTopology topology = topology_of(TetMesh{});
  EXPECT_EQ(topology.edges, 0);
  EXPECT_EQ(topology.components, 0);
  EXPECT_EQ(topology.euler(), 0);
}

}  // namespace
}  // namespace hmax
