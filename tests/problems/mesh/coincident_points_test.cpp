#include "problems/mesh/coincident_points.hpp"

#include <random>

#include <gtest/gtest.h>

#include "tests/growth_of_time.hpp"
#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

/// The same tetrahedra, each with four points of its own, moved by up to `noise` along each axis.
TetMesh in_pieces(const TetMesh& mesh, double noise = 0) {
  TetMesh pieces;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> away(-noise, noise);
  pieces.points.resize(3, 4 * mesh.tetrahedron_count());
  pieces.tetrahedra.resize(4, mesh.tetrahedron_count());
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t)
    for (int i = 0; i < 4; ++i) {
      pieces.tetrahedra(i, t) = static_cast<TetMesh::Index>(4 * t + i);
      pieces.points.col(4 * t + i) = mesh.points.col(mesh.tetrahedra(i, t));
      if (noise > 0)
        pieces.points.col(4 * t + i) += Eigen::Vector3d(away(random), away(random), away(random));
    }
  return pieces;
}

TEST(CoincidentPoints, AGoodMeshHasNone) {
  for (const TetMesh& mesh : {ball_mesh(1, 3), cube_mesh(1e-6, 4), beam_mesh(0.2, 0.05, 0.05, 2)})
    EXPECT_TRUE(coincidences(mesh, 0.4).empty());
}

TEST(CoincidentPoints, EachIsFoundWithTheFirstAtItsPlace) {
  const TetMesh mesh = cube_mesh(0.1, 3), pieces = in_pieces(mesh);
  const std::vector<TetMesh::Index> first = coincident_points(pieces, 0);
  // The oracle compares all pairs.
  for (Eigen::Index i = 0; i < pieces.point_count(); ++i) {
    Eigen::Index least = 0;
    while (pieces.points.col(least) != pieces.points.col(i)) ++least;
    EXPECT_EQ(first[static_cast<std::size_t>(i)], least) << i;
  }
  EXPECT_EQ(static_cast<Eigen::Index>(coincidences(pieces, 0).size()),
            pieces.point_count() - mesh.point_count());
}

TEST(CoincidentPoints, NearOnesAreTakenWithinAShareOfTheShortestEdge) {
  const TetMesh mesh = cube_mesh(0.1, 2);  // edges of 0.05 and more
  const TetMesh pieces = in_pieces(mesh, 0.05 * 1e-4);
  EXPECT_TRUE(coincidences(pieces, 0).empty());
  EXPECT_EQ(static_cast<Eigen::Index>(coincidences(pieces, 1e-3).size()),
            pieces.point_count() - mesh.point_count());
  // The share is that of the local edge: a gap of a hundredth of a small edge stays where one of a large edge
  // does not.
  TetMesh two = in_pieces(mesh);
  two.points.rightCols(4).array() += 0.05 * 1e-2;
  EXPECT_EQ(coincidences(two, 1e-3).size() + 4, coincidences(in_pieces(mesh), 0).size());
}

TEST(CoincidentPoints, AnIdlePointCoincidesWithAUsedOneOnly) {
  TetMesh mesh = unit_tetrahedron();
  mesh.points.conservativeResize(3, 7);
  mesh.points.rightCols(3) << 1, 5, 5, 0, 5, 5, 0, 5, 5;
  EXPECT_EQ(coincident_points(mesh, 0), (std::vector<TetMesh::Index>{0, 1, 2, 3, 1, 5, 6}));
  EXPECT_TRUE(coincidences(mesh, 0).empty());
}

/// Each once was compared with each.
TEST(CoincidentPoints, ManyIdleOnesAtOnePlaceTakeNoLongerThanOthers) {
  for (const bool at_a_corner : {true, false}) {
    const auto compare = [&](int many) {
      TetMesh mesh = unit_tetrahedron();
      mesh.points.conservativeResize(3, 4 + many);
      mesh.points.rightCols(many).setConstant(at_a_corner ? 0 : -1);
      const std::vector<TetMesh::Index> first = coincident_points(mesh, 1e-3);
      for (std::size_t i = 4; i < first.size(); ++i)
        ASSERT_EQ(first[i], at_a_corner ? 0 : static_cast<TetMesh::Index>(i));
    };
    EXPECT_LT(growth_of_time(compare, 20'000), 10) << at_a_corner;
  }
}

}  // namespace
}  // namespace hmax
