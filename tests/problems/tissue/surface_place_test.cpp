#include "problems/tissue/surface_place.hpp"

#include <gtest/gtest.h>

#include "problems/mesh/files/mesh_names.hpp"

namespace hmax {
namespace {

using Eigen::Vector3d;

TEST(SurfacePlace, OfACubeIsThatOfItsSides) {
  const TetMesh cube = mesh_by_name("cube:n=2,edge=1");
  const MeshSurface surface = surface_of(cube);
  const Vector3d low = cube.points.rowwise().minCoeff();
  const auto place = [&](double x, double y, double z) {
    return place_beside(cube.points, surface.triangles, low + Vector3d(x, y, z));
  };
  for (const auto& [at, distance, inside] :
       {std::tuple{Vector3d(0.5, 0.5, 0.5), 0.5, true},
        {Vector3d(0.1, 0.4, 0.3), 0.1, true},
        {Vector3d(0.3, 0.4, 1.2), 0.2, false},
        {Vector3d(1.3, 0.4, 1.4), 0.5, false},  // nearest to a side of a triangle
        {Vector3d(-2, -1, 3), 3, false}}) {     // and to a corner
    const SurfacePlace found = place(at(0), at(1), at(2));
    EXPECT_NEAR(found.distance, distance, 1e-12) << at.transpose();
    EXPECT_EQ(found.inside, inside) << at.transpose();
  }
}

TEST(SurfacePlace, IsInsideTheLiverWhereATetrahedronIs) {
  const TetMesh liver = mesh_by_name("liver");
  const MeshSurface surface = surface_of(liver);
  for (TetMesh::Index t = 0; t < liver.tetrahedron_count(); t += 50) {
    Vector3d middle = Vector3d::Zero();
    for (const TetMesh::Index i : liver.tetrahedra.col(t)) middle += liver.points.col(i) / 4;
    EXPECT_TRUE(place_beside(liver.points, surface.triangles, middle).inside) << t;
  }
  const Vector3d far = 2 * liver.points.rowwise().maxCoeff() - liver.points.rowwise().minCoeff();
  EXPECT_FALSE(place_beside(liver.points, surface.triangles, far).inside);
}

}  // namespace
}  // namespace hmax
