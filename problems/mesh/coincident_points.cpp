#include "problems/mesh/coincident_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "problems/mesh/at.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

/// The shortest edge at each point; infinite where there is none.
std::vector<double> shortest_edges(const TetMesh& mesh) {
  std::vector<double> shortest(at(mesh.point_count()), std::numeric_limits<double>::infinity());
  for (const auto& t : mesh.tetrahedra.colwise())
    for (const auto& [i, j] : tetrahedron_edges) {
      const double length = (mesh.points.col(t(i)) - mesh.points.col(t(j))).norm();
      for (const Index point : {t(i), t(j)}) shortest[at(point)] = std::min(shortest[at(point)], length);
    }
  return shortest;
}

Index root(std::vector<Index>& parent, Index a) {
  while (parent[at(a)] != a) a = parent[at(a)] = parent[at(parent[at(a)])];
  return a;
}

}  // namespace

std::vector<Index> coincident_points(const TetMesh& mesh, double tolerance) {
  const std::vector<double> edge = shortest_edges(mesh);
  // A direction that no lattice has: few points share a place along it.
  const Eigen::RowVector3d direction(0.5377, 0.6173, 0.5743);
  const Eigen::RowVectorXd along = direction * mesh.points;
  const double rounding = 1e-12 * (along.size() == 0 ? 0 : along.cwiseAbs().maxCoeff());
  std::vector<Index> parent(at(mesh.point_count())), order;
  for (Index i = 0; i < mesh.point_count(); ++i) {
    parent[at(i)] = i;
    order.push_back(i);
  }
  const auto idle = [&](Index i) { return !std::isfinite(edge[at(i)]); };
  std::ranges::sort(order, {}, [&](Index i) { return along(i); });
  const auto join_if_near = [&](Index i, Index j) {
    if ((mesh.points.col(i) - mesh.points.col(j)).norm() > tolerance * std::min(edge[at(i)], edge[at(j)]))
      return;
    const Index one = root(parent, i), other = root(parent, j);
    parent[at(std::max(one, other))] = std::min(one, other);
  };
  // From points with an edge alone: files may hold a million idle points at one place.
  for (std::size_t a = 0; a < order.size(); ++a) {
    const Index i = order[a];
    if (idle(i)) continue;
    const double reach = tolerance * edge[at(i)] + rounding;
    for (std::size_t b = a + 1; b < order.size() && along(order[b]) - along(i) <= reach; ++b)
      join_if_near(i, order[b]);
    for (std::size_t b = a; b-- > 0 && along(i) - along(order[b]) <= reach;)
      if (idle(order[b])) join_if_near(i, order[b]);
  }
  for (Index i = 0; i < mesh.point_count(); ++i) parent[at(i)] = root(parent, i);
  return parent;
}

std::vector<Coincidence> coincidences(const TetMesh& mesh, double tolerance) {
  const std::vector<Index> first = coincident_points(mesh, tolerance);
  std::vector<char> used(first.size(), 0);
  for (const Index point : mesh.tetrahedra.reshaped()) used[at(point)] = 1;
  std::vector<Index> met(first.size(), -1);
  std::vector<Coincidence> all;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (!used[i]) continue;
    Index& earlier = met[at(first[i])];
    if (earlier < 0)
      earlier = static_cast<Index>(i);
    else
      all.push_back({static_cast<Index>(i), earlier});
  }
  return all;
}

}  // namespace hmax
