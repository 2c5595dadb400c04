#include "problems/mesh/mesh_generators.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

TEST(MeshGenerators, ABoxHasItsVolumeAndEndsExactlyAtItsSize) {
  const TetMesh mesh = box_mesh({0.3, 0.2, 0.1}, {5, 3, 2});
  EXPECT_EQ(mesh.point_count(), 6 * 4 * 3);
  EXPECT_EQ(mesh.tetrahedron_count(), 6 * 5 * 3 * 2);
  EXPECT_TRUE(all_positive(mesh));
  EXPECT_NEAR(quality_of(mesh).volume, 0.006, 1e-16);
  EXPECT_NEAR(enclosed_volume(mesh), 0.006, 1e-16);
  EXPECT_EQ(quality_of(mesh).upper, Eigen::Vector3d(0.3, 0.2, 0.1));
  EXPECT_EQ(topology_of(mesh).surface_triangles, 2 * 2 * (15 + 10 + 6));
}

TEST(MeshGenerators, ABeamIsFourTimesAsManyCellsLongAsThick) {
  const TetMesh mesh = beam_mesh(0.2, 0.05, 0.05, 2);
  EXPECT_EQ(mesh.tetrahedron_count(), 24 * 8);
  EXPECT_EQ(mesh.point_count(), 9 * 3 * 3);
  EXPECT_EQ(cube_mesh(0.1, 4).point_count(), 125);
}

TEST(MeshGenerators, ABallHasTheCountsOfItsShells) {
  for (const int n : {1, 2, 5}) {
    const TetMesh mesh = ball_mesh(0.05, n);
    const MeshTopology t = topology_of(mesh);
    Eigen::Index points = 1;
    for (int k = 1; k <= n; ++k) points += 10 * k * k + 2;
    EXPECT_EQ(t.points, points);
    EXPECT_EQ(t.tetrahedra, 20 * n * n * n);
    EXPECT_EQ(t.surface_points, 10 * n * n + 2);
    EXPECT_EQ(t.surface_triangles, 20 * n * n);
    EXPECT_EQ(t.euler(), 1);
    EXPECT_EQ(t.crowded_faces, 0);
    EXPECT_EQ(t.unused_points, 0);
    EXPECT_TRUE(all_positive(mesh));
  }
}

TEST(MeshGenerators, TheVolumeOfABallConvergesWithOrderTwo) {
  const double exact = 4. / 3 * std::numbers::pi * 1e-3;
  const double coarse = exact - quality_of(ball_mesh(0.1, 4)).volume;
  const double fine = exact - quality_of(ball_mesh(0.1, 8)).volume;
  EXPECT_GT(fine, 0);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
}

TEST(MeshGenerators, ABallHasNoSlivers) {
  for (const int n : {1, 4, 8}) {
    const MeshQuality quality = quality_of(ball_mesh(1, n));
    EXPECT_GT(quality.smallest_angle, 25 * std::numbers::pi / 180) << n;
    EXPECT_GT(quality.min_mean_ratio, 0.6) << n;
  }
}

TEST(MeshGenerators, WhatIsNoMeshIsRefused) {
  EXPECT_THROW(cube_mesh(1, 0), std::invalid_argument);
  EXPECT_THROW(cube_mesh(0, 1), std::invalid_argument);
  EXPECT_THROW(cube_mesh(std::numeric_limits<double>::quiet_NaN(), 1), std::invalid_argument);
  EXPECT_THROW(ball_mesh(-1, 1), std::invalid_argument);
  EXPECT_THROW(ball_mesh(1, std::numeric_limits<int>::max()), std::invalid_argument);
  EXPECT_THROW(beam_mesh(1, 1, 1, std::numeric_limits<int>::max()), std::invalid_argument);
  EXPECT_THROW(beam_mesh(1, std::numeric_limits<double>::infinity(), 1, 1), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
