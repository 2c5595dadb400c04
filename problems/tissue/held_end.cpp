#include "problems/tissue/held_end.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "problems/mesh/mesh_quality.hpp"

namespace hmax {

TetMesh::Index HeldEnd::opposite(const TetMesh& mesh) const {
  std::vector<TetMesh::Index> far = points_of_end(mesh, -towards, 0.02);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const TetMesh::Index i : far) middle += mesh.points.col(i) / static_cast<double>(far.size());
  return *std::ranges::min_element(
      far, {}, [&](TetMesh::Index i) { return (mesh.points.col(i) - middle).squaredNorm(); });
}

PressingForce pressing_force(double force, const TetMesh& mesh, const HeldEnd& end) {
  PressingForce load{.points = {}, .force = force * end.towards};
  const Eigen::Vector3d tip = mesh.points.col(end.opposite(mesh));
  const double radius = 0.15 * diagonal_of(mesh);
  for (const TetMesh::Index i : surface_of(mesh).points)
    if ((mesh.points.col(i) - tip).norm() <= radius) load.points.push_back(i);
  return load;
}

TetMesh::Index faced_point(const TetMesh& mesh, const MeshSurface& surface, const HeldEnd& way,
                           double radius) {
  constexpr double square = 0.8;  // the projected area over the area
  const auto place = [&](TetMesh::Index i) { return Eigen::Vector3d(mesh.points.col(i)); };
  const auto faces = [&](TetMesh::Index point) {
    double projected = 0, area = 0;
    for (const auto& points : surface.triangles.colwise()) {
      if (std::ranges::none_of(points,
                               [&](TetMesh::Index i) { return (place(i) - place(point)).norm() <= radius; }))
        continue;
      const Eigen::Vector3d a = place(points[0]), normal = (place(points[1]) - a).cross(place(points[2]) - a);
      projected -= normal.dot(way.towards);
      area += normal.norm();
    }
    return projected >= square * area;
  };
  const Eigen::RowVectorXd along = way.towards.transpose() * mesh.points;
  const double middle = (along.minCoeff() + along.maxCoeff()) / 2;
  std::vector<TetMesh::Index> candidates = surface.points;
  std::ranges::stable_sort(candidates, {}, [&](TetMesh::Index i) { return along[i]; });
  candidates.insert(candidates.begin(), way.opposite(mesh));
  for (const TetMesh::Index point : candidates)
    if (along[point] <= middle && faces(point)) return point;
  return candidates.front();
}

}  // namespace hmax
