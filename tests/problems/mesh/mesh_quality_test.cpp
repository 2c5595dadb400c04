#include "problems/mesh/mesh_quality.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

TEST(MeshQuality, TheRegularTetrahedronIsPerfect) {
  const Corners x = corners_of(regular_tetrahedron(), 0);
  EXPECT_DOUBLE_EQ(signed_volume(x), 1. / 3);
  EXPECT_DOUBLE_EQ(mean_ratio(x), 1);
  for (const double angle : dihedral_angles(x)) EXPECT_NEAR(angle, std::acos(1. / 3), 1e-15);
}

TEST(MeshQuality, OfNumbersTooLargeToSquareHasAWorstTetrahedron) {
  TetMesh mesh = unit_tetrahedron();
  mesh.points *= 1e200;
  EXPECT_EQ(quality_of(mesh).worst, 0);
  EXPECT_TRUE(std::isnan(quality_of(mesh).min_mean_ratio));
}

/// Three right angles at the edges of the corner, arccos(1 / sqrt(3)) at those of the slanted face.
TEST(MeshQuality, TheCornerOfACubeHasItsClosedFormAngles) {
  const Corners x = corners_of(unit_tetrahedron(), 0);
  const auto angles = dihedral_angles(x);
  for (std::size_t e = 0; e < 6; ++e)
    EXPECT_NEAR(angles[e], e < 3 ? std::numbers::pi / 2 : std::acos(1 / std::sqrt(3.)), 1e-15);
  EXPECT_NEAR(mean_ratio(x), 12 * std::pow(0.5, 2. / 3) / 9, 1e-15);
}

/// The height over the slanted face of area sqrt(3) / 2, and edge sqrt(2) times sqrt(2 / 3).
TEST(MeshQuality, TheLeastHeightIsOverTheLargestFace) {
  EXPECT_NEAR(least_height(corners_of(unit_tetrahedron(), 0)), 1 / std::sqrt(3.), 1e-15);
  EXPECT_NEAR(least_height(corners_of(regular_tetrahedron(), 0)), 2 / std::sqrt(3.), 1e-15);
  Corners x = corners_of(unit_tetrahedron(), 0);
  x.col(1).swap(x.col(2));
  EXPECT_LT(least_height(x), 0);
}

TEST(MeshQuality, ShapeDoesNotDependOnSizeAndPlace) {
  Corners x = corners_of(unit_tetrahedron(), 0);
  x.col(1) << 1.3, 0.2, -0.1;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  const Corners y = ((1e-3 * turn) * x).colwise() + Eigen::Vector3d(0.1, -0.2, 0.3);
  EXPECT_NEAR(mean_ratio(x), mean_ratio(y), 1e-12);
  for (std::size_t e = 0; e < 6; ++e) EXPECT_NEAR(dihedral_angles(x)[e], dihedral_angles(y)[e], 1e-12);
}

TEST(MeshQuality, AnInvertedTetrahedronHasNegativeVolumeAndNoQuality) {
  Corners x = corners_of(unit_tetrahedron(), 0);
  x.col(1).swap(x.col(2));
  EXPECT_DOUBLE_EQ(signed_volume(x), -1. / 6);
  EXPECT_EQ(mean_ratio(x), 0);
  EXPECT_FALSE(is_degenerate(x));
}

TEST(MeshQuality, FlatMeansFlatBesideTheLongestEdge) {
  Corners x = corners_of(unit_tetrahedron(), 0);
  EXPECT_FALSE(is_degenerate(1e-9 * x));
  x.col(3) = 0.3 * x.col(1) + 0.2 * x.col(2);
  EXPECT_TRUE(is_degenerate(x));
  EXPECT_TRUE(is_degenerate(1e9 * x));
  x.col(3)(2) = 1e-6;
  EXPECT_FALSE(is_degenerate(x));
}

TEST(MeshQuality, SliversAreNamedTheFlattestFirst) {
  TetMesh mesh = ball_mesh(1, 2);
  EXPECT_TRUE(slivers_of(mesh, 0.1).empty());
  // Four points of a square, two of them lifted a little: no short edge, hardly a volume.
  mesh.points.conservativeResize(3, mesh.points.cols() + 5);
  mesh.points.rightCols(5) << 0, 1, 1, 0, 0, 0, 0, 1, 1, 1, 0, 0.02, 0, 0.02, 0.01;
  const auto n = static_cast<TetMesh::Index>(mesh.points.cols() - 5);
  const Eigen::Index t = mesh.tetrahedra.cols();
  mesh.tetrahedra.conservativeResize(4, t + 2);
  mesh.tetrahedra.col(t) << n, n + 1, n + 2, n + 3;
  mesh.tetrahedra.col(t + 1) << n, n + 1, n + 2, n + 4;
  const auto slivers = slivers_of(mesh, 5 * std::numbers::pi / 180);
  ASSERT_EQ(slivers.size(), 2U);
  EXPECT_EQ(slivers[0].tetrahedron, t + 1);
  EXPECT_EQ(slivers[1].tetrahedron, t);
  EXPECT_LE(slivers[0].smallest_angle, slivers[1].smallest_angle);
}

TEST(MeshQuality, ASummaryHoldsTheWorst) {
  const MeshQuality quality = quality_of(cube_mesh(0.1, 2));
  EXPECT_NEAR(quality.volume, 1e-3, 1e-17);
  EXPECT_NEAR(quality.shortest_edge, 0.05, 1e-15);
  EXPECT_NEAR(quality.longest_edge, 0.05 * std::sqrt(3.), 1e-15);
  EXPECT_NEAR(quality.smallest_angle, std::numbers::pi / 4, 1e-12);
  EXPECT_NEAR(quality.largest_angle, std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(quality.min_mean_ratio, quality.average_mean_ratio, 1e-12);
  EXPECT_EQ(quality.upper, Eigen::Vector3d(0.1, 0.1, 0.1));
}

}  // namespace
}  // namespace hmax
