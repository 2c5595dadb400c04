#include "problems/mesh/mend.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

double least_of(const TetMesh& mesh) {
  double least = least_height(corners_of(mesh, 0));
  for (Eigen::Index t = 1; t < mesh.tetrahedron_count(); ++t)
    least = std::min(least, least_height(corners_of(mesh, t)));
  return least;
}

/// The middle of a cube of 2 x 2 x 2 cells.
constexpr TetMesh::Index middle = 13;

/// Such a cube, its middle point near to a face of a tetrahedron around it.
TetMesh spoiled_cube() {
  TetMesh mesh = cube_mesh(1, 2);
  mesh.points.col(middle) += Eigen::Vector3d(0.21, 0.02, -0.03);
  return mesh;
}

/// A ball without planes, its inner points pushed about.
TetMesh pushed_ball() {
  TetMesh mesh = ball_mesh(1, 4);
  const auto outer = surface_of(mesh).points;
  for (TetMesh::Index i = 0; i < mesh.point_count(); ++i)
    if (!std::ranges::binary_search(outer, i))
      mesh.points.col(i) += 0.05 * Eigen::Vector3d(i % 3 - 1, i % 5 - 2, i % 7 - 3).normalized();
  return mesh;
}

TEST(Mending, MovesADisplacedInnerPointBack) {
  const TetMesh whole = cube_mesh(1, 2), spoiled = spoiled_cube();
  ASSERT_TRUE(all_positive(spoiled));
  ASSERT_LT(least_of(spoiled), 0.7 * least_of(whole));
  const MendedMesh done = mended(spoiled, 1, surface_of(spoiled).points);
  EXPECT_EQ(done.mending.moved, std::vector<TetMesh::Index>{middle});
  EXPECT_DOUBLE_EQ(done.mending.least_height_before, least_of(spoiled));
  EXPECT_DOUBLE_EQ(done.mending.least_height_after, least_of(done.mesh));
  EXPECT_GT(least_of(done.mesh), 0.99 * least_of(whole));
  EXPECT_DOUBLE_EQ(done.mending.farthest, (done.mesh.points - spoiled.points).colwise().norm().maxCoeff());
  EXPECT_EQ(done.mesh.tetrahedra, spoiled.tetrahedra);
}

TEST(Mending, MakesTheLeastMeanHeightLargerAndInvertsNothing) {
  const TetMesh mesh = pushed_ball();
  ASSERT_TRUE(all_positive(mesh));
  double least = least_of(mesh), mean = mended(mesh, 0).mending.least_mean_height_after;
  const double mean_before = mean;
  for (const TetMesh::Index count : {1, 10, 40}) {
    const MendedMesh done = mended(mesh, count);
    EXPECT_TRUE(all_positive(done.mesh));
    EXPECT_DOUBLE_EQ(done.mending.least_mean_height_before, mean_before);
    EXPECT_GT(done.mending.least_height_after, (1 - 1e-6) * least);
    EXPECT_GT(done.mending.least_mean_height_after, (1 - 1e-6) * mean);
    least = done.mending.least_height_after;
    mean = done.mending.least_mean_height_after;
  }
  EXPECT_GT(mean, 1.1 * mean_before);
  EXPECT_EQ(mended(mesh, 10).mesh.points, mended(mesh, 10).mesh.points);
}

/// The points of a single tetrahedron have its heights.
TEST(Mending, TellsMeanHeightsOfPoints) {
  EXPECT_NEAR(mended(unit_tetrahedron(), 0).mending.least_mean_height_before, 1 / std::sqrt(3.), 1e-15);
  const TetMesh mesh = cube_mesh(1, 1);
  double least = 1e300;
  for (Eigen::Index point = 0; point < 8; ++point) {
    double stiffness = 0, volume = 0;
    for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t)
      for (std::size_t i = 0; i < 4; ++i) {
        if (mesh.tetrahedra(static_cast<Eigen::Index>(i), t) != point) continue;
        const Corners x = corners_of(mesh, t);
        const auto& [a, b, c] = tetrahedron_faces[i];
        const Eigen::Vector3d normal = (x.col(b) - x.col(a)).cross(x.col(c) - x.col(a)).normalized();
        const double height = normal.dot(x.col(static_cast<Eigen::Index>(i)) - x.col(a));
        stiffness += signed_volume(x) / (height * height);
        volume += signed_volume(x);
      }
    least = std::min(least, std::sqrt(volume / stiffness));
  }
  EXPECT_NEAR(mended(mesh, 0).mending.least_mean_height_before, least, 1e-12);
}

TEST(Mending, LeavesSoundMeshesAndTheCountOfZero) {
  for (const TetMesh& mesh : {regular_tetrahedron(), cube_mesh(0.1, 2)}) {
    const MendedMesh done = mended(mesh, 100);
    EXPECT_EQ(done.mesh.points, mesh.points);
    EXPECT_TRUE(done.mending.moved.empty());
    EXPECT_EQ(done.mending.farthest, 0);
    EXPECT_EQ(done.mending.least_height_after, done.mending.least_height_before);
  }
  EXPECT_EQ(mended(spoiled_cube(), 0).mesh.points, spoiled_cube().points);
  EXPECT_THROW(mended(spoiled_cube(), -1), std::invalid_argument);
}

/// A point of a face slides in it; edges and corners of the cube stay.
TEST(Mending, KeepsPlanesAndTheirRims) {
  TetMesh mesh = cube_mesh(1, 4);
  const double volume = enclosed_volume(mesh);
  TetMesh::Index face = 0;
  while (!mesh.points.col(face).isApprox(Eigen::Vector3d(0.5, 0.5, 0))) ++face;
  mesh.points.col(face) += Eigen::Vector3d(0.1, 0.06, 0);
  ASSERT_TRUE(all_positive(mesh));
  const MendedMesh done = mended(mesh, 20);
  EXPECT_TRUE(std::ranges::binary_search(done.mending.moved, face));
  EXPECT_GT(least_of(done.mesh), 1.1 * least_of(mesh));
  EXPECT_NEAR(enclosed_volume(done.mesh), volume, 1e-12);
  const auto on_sides = [](const Eigen::Vector3d& x) {
    return ((x.array() == 0) || (x.array() == 1)).cast<int>().eval();
  };
  for (TetMesh::Index i = 0; i < mesh.point_count(); ++i) {
    const Eigen::Array3i before = on_sides(mesh.points.col(i));
    if (before.sum() >= 2) {
      EXPECT_EQ(done.mesh.points.col(i), mesh.points.col(i)) << i;
    }
    for (int k = 0; k < 3; ++k)
      if (before(k) != 0) {
        EXPECT_NEAR(done.mesh.points(k, i), mesh.points(k, i), 1e-12) << i;
      }
  }
}

/// Points of a curved surface move too, a little.
TEST(Mending, KeepsCurvedSurfacesAndTheVolumeNearly) {
  TetMesh mesh = ball_mesh(1, 3);
  const auto outer = surface_of(mesh).points;
  mesh.points.col(outer.front()) *= 0.75;
  const MendedMesh done = mended(mesh, 30);
  const EdgeTable table = edge_table(mesh);
  double longest = 0;
  for (const auto& edge : table.edges.colwise())
    longest = std::max(longest, (mesh.points.col(edge(0)) - mesh.points.col(edge(1))).norm());
  bool some = false;
  for (const TetMesh::Index i : outer) {
    const double move = (done.mesh.points.col(i) - mesh.points.col(i)).norm();
    some = some || move > 0;
    EXPECT_LT(move, 0.05 * longest);
  }
  EXPECT_TRUE(some);
  EXPECT_NEAR(enclosed_volume(done.mesh), enclosed_volume(mesh), 1e-3 * enclosed_volume(mesh));
}

TEST(Mending, KeepsInterfacesAndFixedPoints) {
  TetMesh mesh = spoiled_cube();
  ASSERT_TRUE(std::ranges::binary_search(mended(mesh, 5).mending.moved, middle));
  EXPECT_FALSE(std::ranges::binary_search(mended(mesh, 5, {middle}).mending.moved, middle));
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t)
    mesh.regions.push_back(corners_of(mesh, t).row(0).mean() < 0.5 ? 1 : 2);
  const MendedMesh done = mended(mesh, 5);
  EXPECT_FALSE(std::ranges::binary_search(done.mending.moved, middle));
  EXPECT_EQ(done.mesh.regions, mesh.regions);
}

}  // namespace
}  // namespace hmax
