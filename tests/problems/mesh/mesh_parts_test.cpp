#include "problems/mesh/mesh_parts.hpp"

#include <gtest/gtest.h>

#include "tests/problems/mesh/meshes.hpp"

namespace hmax {
namespace {

using Indices = std::vector<TetMesh::Index>;

/// A cube of six tetrahedra and one more with the corners given; points from 8 on are new ones far away.
TetMesh cube_and(const std::array<TetMesh::Index, 4>& corners) {
  TetMesh mesh = cube_mesh(1, 1);
  mesh.points.conservativeResize(3, 12);
  mesh.points.rightCols(4) = 5 * unit_tetrahedron().points.array() + 3;
  mesh.tetrahedra.conservativeResize(4, 7);
  mesh.tetrahedra.col(6) << corners[0], corners[1], corners[2], corners[3];
  return mesh;
}

/// A triangle of the surface of the cube.
Indices outer_triangle() {
  const MeshSurface surface = surface_of(cube_mesh(1, 1));
  return {surface.triangles(0, 0), surface.triangles(1, 0), surface.triangles(2, 0)};
}

TEST(MeshParts, HangTogetherByFaces) {
  EXPECT_EQ(parts_of(ball_mesh(1, 2)).size(), 1U);
  EXPECT_TRUE(parts_of(ball_mesh(1, 2))[0].hinges.empty());
  const Indices t = outer_triangle();
  EXPECT_EQ(parts_of(cube_and({t[0], t[1], t[2], 8})).size(), 1U);
}

TEST(MeshParts, HangOnAPointOnAnEdgeOrOnNothing) {
  const Indices t = outer_triangle();
  const auto hinges = [](const TetMesh& mesh) {
    const std::vector<MeshPart> parts = parts_of(mesh);
    EXPECT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0].tetrahedra.size(), 6U);
    EXPECT_EQ(parts[1].tetrahedra, Indices{6});
    EXPECT_EQ(parts[0].hinges, parts[1].hinges);
    return parts[1].hinges;
  };
  EXPECT_EQ(hinges(cube_and({8, 9, 10, 11})), Indices{});
  EXPECT_EQ(hinges(cube_and({t[0], 9, 10, 11})), Indices{t[0]});
  EXPECT_EQ(hinges(cube_and({t[0], t[1], 10, 11})), (Indices{std::min(t[0], t[1]), std::max(t[0], t[1])}));
}

TEST(MeshParts, AreLooseWhereNoneOfTheirPointsIsHeld) {
  const TetMesh apart = cube_and({8, 9, 10, 11});
  EXPECT_EQ(loose_parts(apart, {0}), std::vector<Indices>{{6}});
  EXPECT_EQ(loose_parts(apart, {9}), (std::vector<Indices>{{0, 1, 2, 3, 4, 5}}));
  EXPECT_EQ(loose_parts(apart, {}).size(), 2U);
  EXPECT_TRUE(loose_parts(apart, {3, 10}).empty());
  // A part that hangs on a point is not loose.
  EXPECT_TRUE(loose_parts(cube_and({outer_triangle()[0], 9, 10, 11}), {0}).empty());
}

TEST(MeshParts, SupportsLeaveRigidMotions) {
  const TetMesh cube = cube_mesh(2.0, 1);  // point i has the coordinates of the bits of i, x first
  const auto left = [&](Indices held) {
    const std::vector<FreePart> free = free_parts(cube, held);
    return free.empty() ? Eigen::Index{0} : free.front().motions.cols();
  };
  EXPECT_EQ(left({}), 6);
  EXPECT_EQ(left({3}), 3);
  EXPECT_EQ(left({0, 1}), 1);
  EXPECT_EQ(left({0, 1, 2}), 0);
  const FreePart hinged = free_parts(cube, {0, 1}).front();
  const Eigen::MatrixXd& motion = hinged.motions;
  EXPECT_NEAR(motion.norm(), 1, 1e-12);
  EXPECT_LT(motion.topRows(6).norm(), 1e-12) << "the points that are held stay";
  for (std::size_t i = 0; i < hinged.points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto at = [&](std::size_t k) { return static_cast<Eigen::Index>(3 * k); };
      const Eigen::Vector3d edge = cube.points.col(hinged.points[i]) - cube.points.col(hinged.points[j]);
      const Eigen::Vector3d change = motion.block<3, 1>(at(i), 0) - motion.block<3, 1>(at(j), 0);
      EXPECT_NEAR(edge.dot(change), 0, 1e-12) << "no length changes";
    }
}

TEST(MeshParts, SupportsHoldAPartAsWellFarFromTheOrigin) {
  TetMesh cube = cube_mesh(2.0, 1);
  cube.points.array() += 1 << 21;  // in millimetres of a survey, say
  EXPECT_TRUE(free_parts(cube, {0, 1, 2}).empty());
  EXPECT_EQ(free_parts(cube, {0, 1}).front().motions.cols(), 1);
  EXPECT_EQ(free_parts(cube, {3}).front().motions.cols(), 3);
}

}  // namespace
}  // namespace hmax
