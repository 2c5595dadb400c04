#include "problems/mesh/files/mesh_defects.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/problems/mesh/meshes.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

MeshFile file_of(const TetMesh& mesh) {
  MeshFile file{.name = "body.msh", .format = "by hand", .mesh = mesh, .numbers = {}, .places = {}};
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    file.numbers.push_back(100 + t);
    file.places.push_back(10 + t);
  }
  return file;
}

std::string refusal(const MeshFile& file) {
  return error_of<std::invalid_argument>([&] { require_valid(file); });
}

TEST(MeshDefects, AGoodMeshHasNone) {
  EXPECT_TRUE(defects_of(ball_mesh(1, 2)).none());
  EXPECT_EQ(refusal(file_of(ball_mesh(1, 2))), "");
}

TEST(MeshDefects, SomeOrAllInvertedAreNamedAndTurned) {
  const TetMesh good = cube_mesh(1, 2);
  TetMesh mesh = good;
  mesh.tetrahedra.row(0).swap(mesh.tetrahedra.row(1));
  EXPECT_EQ(defects_of(mesh).inverted.size(), 48U);
  EXPECT_EQ(
      refusal(file_of(mesh)),
      "body.msh, line 10: tetrahedron 100 is inverted as all others are; turn it with `hmax mesh convert FILE "
      "OUTPUT --fix`");
  EXPECT_EQ(fix_orientation(mesh), 48);
  EXPECT_TRUE(defects_of(mesh).none());
  std::swap(mesh.tetrahedra(2, 5), mesh.tetrahedra(3, 5));
  std::swap(mesh.tetrahedra(2, 7), mesh.tetrahedra(0, 7));
  EXPECT_EQ(defects_of(mesh).inverted, (std::vector<TetMesh::Index>{5, 7}));
  EXPECT_TRUE(says(refusal(file_of(mesh)), "line 15: tetrahedron 105 is inverted (2 in all); turn it"));
  EXPECT_EQ(fix_orientation(mesh), 2);
  EXPECT_NEAR(enclosed_volume(mesh), 1, 1e-14);
}

TEST(MeshDefects, FlatTetrahedraAreNamedAndNotTurned) {
  TetMesh mesh = unit_tetrahedron();
  mesh.tetrahedra.conservativeResize(4, 3);
  mesh.points.conservativeResize(3, 5);
  mesh.points.col(4) << 0.3, 0.3, 0;
  mesh.tetrahedra.col(1) << 0, 1, 2, 4;
  mesh.tetrahedra.col(2) << 0, 1, 1, 3;
  EXPECT_EQ(defects_of(mesh).degenerate, (std::vector<TetMesh::Index>{1, 2}));
  EXPECT_EQ(fix_orientation(mesh), 0);
  EXPECT_TRUE(says(refusal(file_of(mesh)), "line 11: tetrahedron 101 has no volume (2 in all); remove"));
}

TEST(MeshDefects, TheSameTetrahedronAgainIsNamedInAnyOrderOfItsCorners) {
  TetMesh mesh = cube_mesh(1, 1);
  mesh.tetrahedra.conservativeResize(4, 7);
  mesh.tetrahedra.col(6) << mesh.tetrahedra(1, 2), mesh.tetrahedra(2, 2), mesh.tetrahedra(0, 2),
      mesh.tetrahedra(3, 2);
  const MeshDefects defects = defects_of(mesh);
  ASSERT_EQ(defects.duplicates.size(), 1U);
  EXPECT_EQ(defects.duplicates[0], std::pair(6, 2));
  EXPECT_TRUE(says(refusal(file_of(mesh)),
                   "line 16: tetrahedron 106 has the same corners as tetrahedron 102; remove"));
  mesh.regions = {20, 20, 20, 20, 20, 20, 30};
  MeshFile file = file_of(mesh);
  file.names[30] = "tumour";
  EXPECT_TRUE(says(refusal(file), "tetrahedron 102, in the regions 30 'tumour' and 20; remove one"));
}

/// Two tetrahedra with the face of points 0, 1, 2 in common, the second with its apex at height z.
TetMesh two_on_a_face(double z) {
  TetMesh mesh = unit_tetrahedron();
  mesh.tetrahedra.conservativeResize(4, 2);
  mesh.points.conservativeResize(3, 5);
  mesh.points.col(4) << 0.3, 0.3, z;
  mesh.tetrahedra.col(1) << 0, 2, 1, 4;
  return mesh;
}

TEST(MeshDefects, TwoOnTheSameSideOfTheirFaceOverlapInAnyOrderOfCorners) {
  EXPECT_TRUE(defects_of(two_on_a_face(-0.5)).none());
  for (const bool first : {false, true})
    for (const bool second : {false, true}) {
      TetMesh folded = two_on_a_face(0.5), good = two_on_a_face(-0.5);
      for (TetMesh* mesh : {&folded, &good}) {
        if (first) std::swap(mesh->tetrahedra(0, 0), mesh->tetrahedra(1, 0));
        if (second) std::swap(mesh->tetrahedra(2, 1), mesh->tetrahedra(3, 1));
      }
      EXPECT_EQ(defects_of(folded).overlaps,
                (std::vector<std::pair<TetMesh::Index, TetMesh::Index>>{{1, 0}}));
      EXPECT_TRUE(defects_of(good).overlaps.empty());
      EXPECT_TRUE(says(refusal(file_of(folded)), "overlaps tetrahedron 10"));
      // Turned, all volumes are positive and the two overlap as before.
      fix_orientation(folded);
      fix_orientation(good);
      EXPECT_TRUE(defects_of(folded).inverted.empty());
      EXPECT_EQ(defects_of(folded).overlaps.size(), 1U);
      EXPECT_TRUE(defects_of(good).none());
    }
}

TEST(MeshDefects, AnElementThatIsTrulyInvertedIsNotTurned) {
  // A vertex inside is pushed through the face opposite to it.
  TetMesh mesh = cube_mesh(1, 2);
  TetMesh::Index centre = 0;
  while (!mesh.points.col(centre).isApprox(Eigen::Vector3d::Constant(0.5))) ++centre;
  mesh.points.col(centre) << 1.2, 0.6, 0.5;
  const MeshDefects defects = defects_of(mesh);
  EXPECT_FALSE(defects.inverted.empty());
  EXPECT_FALSE(defects.overlaps.empty());
  const std::string said = refusal(file_of(mesh));
  EXPECT_TRUE(says(said, "is inverted and overlaps tetrahedron"));
  EXPECT_TRUE(says(said, "another order of corners does not help"));
  EXPECT_THROW(require_no_overlap(file_of(mesh)), std::invalid_argument);
  fix_orientation(mesh);
  EXPECT_FALSE(defects_of(mesh).none());
}

TEST(MeshDefects, ThreeTetrahedraOnAFaceOverlap) {
  TetMesh mesh = unit_tetrahedron();
  mesh.tetrahedra.conservativeResize(4, 3);
  mesh.points.conservativeResize(3, 6);
  mesh.points.rightCols(2) << 1, 2, 1, 2, 1, 2;
  mesh.tetrahedra.col(1) << 1, 2, 3, 4;
  mesh.tetrahedra.col(2) << 1, 2, 3, 5;
  EXPECT_TRUE(says(refusal(file_of(mesh)), "shares a face with more than one other"));
}

}  // namespace
}  // namespace hmax
