#include "problems/mesh/mesh_parts.hpp"

#include <algorithm>
#include <iterator>

#include <Eigen/Geometry>

#include "core/dense_solvers.hpp"
#include "core/sort_unique.hpp"
#include "problems/mesh/at.hpp"
#include "problems/mesh/disjoint_sets.hpp"
#include "problems/mesh/faces.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

DisjointSets joined_by_faces(const TetMesh& mesh) {
  DisjointSets sets(mesh.tetrahedron_count());
  for_faces(mesh, [&](std::span<const std::int64_t> owners) {
    for (const std::int64_t owner : owners.subspan(1))
      sets.join(static_cast<Index>(owners.front() / 4), static_cast<Index>(owner / 4));
  });
  return sets;
}

}  // namespace

std::vector<MeshPart> parts_of(const TetMesh& mesh) {
  DisjointSets sets = joined_by_faces(mesh);
  std::vector<Index> part_of(at(mesh.tetrahedron_count()));
  std::vector<MeshPart> parts;
  for (Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    const Index root = sets.root(t);  // which is the first tetrahedron of its part
    if (root == t) {
      part_of[at(t)] = static_cast<Index>(parts.size());
      parts.emplace_back();
    }
    part_of[at(t)] = part_of[at(root)];
    parts[at(part_of[at(t)])].tetrahedra.push_back(t);
  }
  if (parts.size() > 1) {
    std::vector<std::pair<Index, Index>> uses;  // a point, and a part that has it
    for (Index t = 0; t < mesh.tetrahedron_count(); ++t)
      for (const Index point : mesh.tetrahedra.col(t)) uses.emplace_back(point, part_of[at(t)]);
    sort_unique(uses);
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const bool shared = (i > 0 && uses[i - 1].first == uses[i].first) ||
                          (i + 1 < uses.size() && uses[i + 1].first == uses[i].first);
      if (shared) parts[at(uses[i].second)].hinges.push_back(uses[i].first);
    }
  }
  std::ranges::stable_sort(parts, std::greater{},
                           [](const MeshPart& part) { return part.tetrahedra.size(); });
  return parts;
}

namespace {

/// Displacements of points x in the six rigid motions: along the axes, and w x (x - centre) / size about
/// them, shape (3 points, 6).
Eigen::MatrixXd rigid_motions(const TetMesh& mesh, const std::vector<Index>& points,
                              const Eigen::Vector3d& centre, double size) {
  Eigen::MatrixXd motions(3 * static_cast<Index>(points.size()), 6);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d arm = (mesh.points.col(points[i]) - centre) / size;
    auto rows = motions.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    rows.leftCols<3>().setIdentity();
    for (int axis = 0; axis < 3; ++axis) rows.col(3 + axis) = Eigen::Vector3d::Unit(axis).cross(arm);
  }
  return motions;
}

/// Orthonormal motions of points that do not move those among them that are held.
Eigen::MatrixXd motions_left(const TetMesh& mesh, const std::vector<Index>& points,
                             const std::vector<Index>& held) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Index i : points) centre += mesh.points.col(i) / static_cast<double>(points.size());
  double size = 0;
  for (const Index i : points) size = std::max(size, (mesh.points.col(i) - centre).norm());
  const Eigen::MatrixXd of_held = rigid_motions(mesh, held, centre, size);
  // Squares: points nearer to a line than a millionth of the size stand in it.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> squares(
      Eigen::MatrixXd(of_held.transpose() * of_held));
  constexpr double nothing = 1e-12;
  Index count = 0;
  while (count < 6 && squares.eigenvalues()[count] <= nothing) ++count;
  if (count == 0) return {};
  return orthonormal_basis(rigid_motions(mesh, points, centre, size) *
                           squares.eigenvectors().leftCols(count));
}

}  // namespace

std::vector<FreePart> free_parts(const TetMesh& mesh, const std::vector<Index>& held) {
  // Every part, as if nothing were held.
  std::vector<FreePart> free;
  for (std::vector<Index>& tetrahedra : loose_parts(mesh, {})) {
    FreePart part{.tetrahedra = std::move(tetrahedra), .points = {}, .motions = {}};
    for (const Index t : part.tetrahedra)
      part.points.insert(part.points.end(), mesh.tetrahedra.col(t).begin(), mesh.tetrahedra.col(t).end());
    sort_unique(part.points);
    std::vector<Index> own;
    std::ranges::set_intersection(part.points, held, std::back_inserter(own));
    part.motions = motions_left(mesh, part.points, own);
    if (part.motions.cols() > 0) free.push_back(std::move(part));
  }
  return free;
}

std::vector<std::vector<TetMesh::Index>> loose_parts(const TetMesh& mesh, const std::vector<Index>& held) {
  DisjointSets sets(mesh.point_count());
  for (const auto& tetrahedron : mesh.tetrahedra.colwise())
    for (int i = 1; i < 4; ++i) sets.join(tetrahedron(0), tetrahedron(i));
  std::vector<char> is_held(at(mesh.point_count()), 0);
  for (const Index point : held) is_held[at(sets.root(point))] = 1;
  std::vector<Index> number(at(mesh.point_count()), -1);
  std::vector<std::vector<Index>> loose;
  for (Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    const std::size_t root = at(sets.root(mesh.tetrahedra(0, t)));
    if (is_held[root]) continue;
    if (number[root] < 0) {
      number[root] = static_cast<Index>(loose.size());
      loose.emplace_back();
    }
    loose[at(number[root])].push_back(t);
  }
  return loose;
}

}  // namespace hmax
