#include "problems/mesh/renumber.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "problems/mesh/refine.hpp"
#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

/// The largest difference between the numbers of neighbours.
int bandwidth(const TetMesh& mesh) {
  const MeshEdges edges = edges_of(mesh);
  return (edges.row(1) - edges.row(0)).maxCoeff();
}

/// A mesh in disorder, with a region for every tetrahedron.
TetMesh shuffled(TetMesh mesh) {
  mesh.regions.resize(static_cast<std::size_t>(mesh.tetrahedron_count()));
  std::iota(mesh.regions.begin(), mesh.regions.end(), 100);
  Renumbering order;
  order.points.resize(static_cast<std::size_t>(mesh.point_count()));
  order.tetrahedra.resize(static_cast<std::size_t>(mesh.tetrahedron_count()));
  std::mt19937 random(7);
  for (auto* list : {&order.points, &order.tetrahedra}) {
    std::iota(list->begin(), list->end(), 0);
    std::ranges::shuffle(*list, random);
  }
  return renumbered(mesh, order);
}

/// Point and tetrahedron by point and tetrahedron.
void expect_renumbered(const TetMesh& now, const TetMesh& mesh, const Renumbering& order) {
  ASSERT_EQ(now.point_count(), mesh.point_count());
  ASSERT_EQ(now.tetrahedron_count(), mesh.tetrahedron_count());
  for (Eigen::Index i = 0; i < now.point_count(); ++i)
    EXPECT_EQ(now.points.col(i), mesh.points.col(order.points[static_cast<std::size_t>(i)])) << i;
  for (Eigen::Index t = 0; t < now.tetrahedron_count(); ++t) {
    const TetMesh::Index before = order.tetrahedra[static_cast<std::size_t>(t)];
    EXPECT_EQ(corners_of(now, t), corners_of(mesh, before)) << t;
    EXPECT_EQ(now.region(t), mesh.region(before)) << t;
  }
  for (Eigen::Index e = 0; e < now.ten_node.cols(); ++e)
    for (int i = 0; i < 10; ++i)
      EXPECT_EQ(now.points.col(now.ten_node(i, e)),
                mesh.points.col(mesh.ten_node(i, order.tetrahedra[static_cast<std::size_t>(8 * e)] / 8)))
          << e;
}

TEST(Renumbering, BringsNeighboursTogether) {
  // A beam of 20 x 2 x 2 cells has layers of 9 points; neighbours lie at most a layer and a half apart.
  const TetMesh mesh = shuffled(box_mesh({10, 1, 1}, {20, 2, 2}));
  EXPECT_GT(bandwidth(mesh), 100);
  const TetMesh better = renumbered(mesh, local_order(mesh));
  EXPECT_LE(bandwidth(better), 18);
  const Eigen::RowVectorXi lowest = better.tetrahedra.colwise().minCoeff();
  EXPECT_TRUE(std::is_sorted(lowest.begin(), lowest.end()));
}

TEST(Renumbering, KeepsPointsTetrahedraAndRegions) {
  const TetMesh mesh = shuffled(ball_mesh(1, 3));
  const Renumbering order = local_order(mesh);
  const TetMesh now = renumbered(mesh, order);
  EXPECT_NE(now.points, mesh.points);
  expect_renumbered(now, mesh, order);
}

TEST(Renumbering, KeepsThePartsOfElementsOfTenNodesTogether) {
  TetMesh mesh = ten_node_mesh(ball_mesh(1, 2));
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t)
    mesh.regions.push_back(static_cast<TetMesh::Index>(t / 8));
  const Renumbering order = local_order(mesh);
  const TetMesh now = renumbered(mesh, order);
  EXPECT_NE(now.ten_node, mesh.ten_node);
  expect_renumbered(now, mesh, order);
  TetMesh::Index lowest = 0;
  for (Eigen::Index e = 0; e < now.element_count(); ++e) {
    EXPECT_GE(now.ten_node.col(e).minCoeff(), lowest);
    lowest = now.ten_node.col(e).minCoeff();
    for (const auto point : now.tetrahedra.middleCols<8>(8 * e).reshaped())
      EXPECT_EQ((now.ten_node.col(e).array() == point).count(), 1);
  }
}

TEST(Renumbering, KeepsTheBodyAndItsRegions) {
  const TetMesh mesh = shuffled(ball_mesh(1, 2));
  const TetMesh now = renumbered(mesh, local_order(mesh));
  EXPECT_TRUE(all_positive(now));
  EXPECT_NEAR(enclosed_volume(now), enclosed_volume(mesh), 1e-14);
  for (Eigen::Index t = 0; t < now.tetrahedron_count(); ++t) {
    const auto found = std::ranges::find(mesh.regions, now.region(t)) - mesh.regions.begin();
    EXPECT_EQ(corners_of(now, t), corners_of(mesh, found));
  }
}

TEST(Renumbering, PutsIdlePointsLastAndKnowsSeparateParts) {
  TetMesh mesh = unit_tetrahedron();
  mesh.points.conservativeResize(3, 10);
  mesh.points.rightCols(6).setRandom();
  mesh.tetrahedra.conservativeResize(4, 2);
  mesh.tetrahedra.col(1) << 4, 6, 7, 8;
  const Renumbering order = local_order(mesh);
  EXPECT_EQ(order.points[8], 5);
  EXPECT_EQ(order.points[9], 9);
  const TetMesh now = renumbered(mesh, order);
  EXPECT_EQ(topology_of(now).components, 2);
  EXPECT_LE(bandwidth(now), 3);
  EXPECT_TRUE(local_order(TetMesh{}).points.empty());
}

TEST(Renumbering, DependsOnNothingButTheMesh) {
  const TetMesh mesh = shuffled(cube_mesh(1, 4));
  EXPECT_EQ(local_order(mesh).points, local_order(mesh).points);
  EXPECT_EQ(local_order(mesh).tetrahedra, local_order(mesh).tetrahedra);
}

}  // namespace
}  // namespace hmax
