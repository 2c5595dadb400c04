#include "problems/mesh/refine.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

TEST(Refinement, MakesEightOfOneWithTheSameVolumeEach) {
  const TetMesh coarse = ball_mesh(0.1, 2), fine = refined(coarse);
  ASSERT_EQ(fine.tetrahedron_count(), 8 * coarse.tetrahedron_count());
  for (Eigen::Index t = 0; t < fine.tetrahedron_count(); ++t) {
    const double whole = signed_volume(corners_of(coarse, t / 8));
    EXPECT_NEAR(signed_volume(corners_of(fine, t)), whole / 8, 1e-14 * whole);
  }
}

TEST(Refinement, KeepsPointsAndAddsOneForEachEdge) {
  const TetMesh coarse = ball_mesh(0.1, 2), fine = refined(coarse);
  EXPECT_EQ(fine.point_count(), coarse.point_count() + edges_of(coarse).cols());
  EXPECT_EQ(fine.points.leftCols(coarse.point_count()), coarse.points);
  const MeshTopology before = topology_of(coarse), after = topology_of(fine);
  EXPECT_EQ(after.surface_triangles, 4 * before.surface_triangles);
  EXPECT_EQ(after.edges, 2 * before.edges + 3 * before.faces + before.tetrahedra);
  EXPECT_EQ(after.euler(), 1);
  EXPECT_EQ(after.crowded_faces, 0);
}

TEST(Refinement, KeepsTheShapesOfABoxAndTheRegionsOfAll) {
  TetMesh coarse = cube_mesh(1, 1);
  coarse.regions = {1, 2, 3, 4, 5, 6};
  const TetMesh fine = refined(coarse, 2);
  EXPECT_EQ(topology_of(fine).edges, topology_of(cube_mesh(1, 4)).edges);
  for (Eigen::Index t = 0; t < fine.tetrahedron_count(); ++t) {
    EXPECT_NEAR(mean_ratio(corners_of(fine, t)), mean_ratio(corners_of(coarse, 0)), 1e-12);
    EXPECT_EQ(fine.region(t), t / 64 + 1);
  }
}

TEST(Refinement, DoesNotSpoilShapesAgainAndAgain) {
  TetMesh mesh = ball_mesh(1, 1);
  const double once = quality_of(refined(mesh)).min_mean_ratio;
  EXPECT_GT(quality_of(refined(mesh, 4)).min_mean_ratio, 0.9 * once);
}

TEST(Refinement, ZeroTimesChangesNothingAndTooOftenIsRefused) {
  const TetMesh mesh = cube_mesh(1, 1);
  EXPECT_EQ(refined(mesh, 0).points, mesh.points);
  EXPECT_THROW(refined(mesh, -1), std::invalid_argument);
  EXPECT_THROW(refined(mesh, 9), std::invalid_argument);
  EXPECT_THROW(refined(mesh, 1'000'000'000), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
