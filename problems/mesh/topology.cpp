#include "problems/mesh/topology.hpp"

#include <algorithm>
#include <numeric>

#include "core/sort_unique.hpp"
#include "problems/mesh/disjoint_sets.hpp"
#include "problems/mesh/faces.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

/// Sorts by the lowest point first: `first[a]` to `first[a + 1]` of what `fill` then writes belongs to point
/// a.
std::vector<std::size_t> buckets(std::vector<std::size_t> counts) {
  std::exclusive_scan(counts.begin(), counts.end(), counts.begin(), std::size_t{0});
  return counts;
}

/// Pairs of points, each once. @param pair  (k, lower, upper) of the pairs k = 0 to count - 1
template <class Pair>
EdgeTable unique_edges(Eigen::Index points, Eigen::Index count, Pair pair) {
  std::vector<std::size_t> counts(static_cast<std::size_t>(points) + 1, 0);
  for (Eigen::Index k = 0; k < count; ++k) ++counts[static_cast<std::size_t>(pair(k).first)];
  const std::vector<std::size_t> first = buckets(std::move(counts));
  std::vector<Index> upper(static_cast<std::size_t>(count));
  std::vector<std::size_t> next = first;
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto [a, b] = pair(k);
    upper[next[static_cast<std::size_t>(a)]++] = b;
  }
  EdgeTable table;
  table.first.assign(static_cast<std::size_t>(points) + 1, 0);
  std::size_t kept = 0;
  std::vector<Index> lower(upper.size());
  for (std::size_t a = 0; a < static_cast<std::size_t>(points); ++a) {
    const auto begin = upper.begin() + static_cast<std::ptrdiff_t>(first[a]);
    const auto end = upper.begin() + static_cast<std::ptrdiff_t>(first[a + 1]);
    std::sort(begin, end);
    const std::size_t start = kept;
    for (auto it = begin; it != end; ++it)
      if (kept == start || upper[kept - 1] != *it) {
        upper[kept] = *it;
        lower[kept++] = static_cast<Index>(a);
      }
    table.first[a + 1] = static_cast<Index>(kept);
  }
  table.edges.resize(2, static_cast<Eigen::Index>(kept));
  for (std::size_t e = 0; e < kept; ++e) table.edges.col(static_cast<Eigen::Index>(e)) << lower[e], upper[e];
  return table;
}

}  // namespace

TetMesh::Index EdgeTable::find(Index a, Index b) const {
  if (a > b) std::swap(a, b);
  const auto upper = edges.row(1);
  const auto end = upper.begin() + first[static_cast<std::size_t>(a) + 1],
             found = std::lower_bound(upper.begin() + first[static_cast<std::size_t>(a)], end, b);
  return found != end && *found == b ? static_cast<Index>(found - upper.begin()) : -1;
}

EdgeTable edge_table(const TetMesh& mesh) {
  return unique_edges(mesh.point_count(), 6 * mesh.tetrahedron_count(), [&](Eigen::Index k) {
    const auto& [i, j] = tetrahedron_edges[static_cast<std::size_t>(k % 6)];
    const Index a = mesh.tetrahedra(i, k / 6), b = mesh.tetrahedra(j, k / 6);
    return std::pair(std::min(a, b), std::max(a, b));
  });
}

MeshEdges element_pairs(const TetMesh& mesh) {
  if (!mesh.has_ten_nodes()) return edges_of(mesh);
  std::vector<std::array<int, 2>> own;
  for (int a = 0; a < 10; ++a)
    for (int b = a + 1; b < 10; ++b) own.push_back({a, b});
  const auto each = static_cast<Eigen::Index>(own.size());
  return unique_edges(mesh.point_count(), each * mesh.element_count(),
                      [&](Eigen::Index k) {
                        const auto& [i, j] = own[static_cast<std::size_t>(k % each)];
                        const Index a = mesh.ten_node(i, k / each), b = mesh.ten_node(j, k / each);
                        return std::pair(std::min(a, b), std::max(a, b));
                      })
      .edges;
}

MeshEdges two_edge_pairs(const EdgeTable& table) {
  const std::size_t count = table.first.size() - 1;
  std::vector<std::vector<Index>> beside(count);
  for (const auto& edge : table.edges.colwise())
    for (const int own : {0, 1}) beside[static_cast<std::size_t>(edge[own])].push_back(edge[1 - own]);
  std::vector<std::array<Index, 2>> pairs;
  std::vector<Index> near;
  for (std::size_t a = 0; a < count; ++a) {
    near = beside[a];
    for (const Index b : beside[a]) {
      const auto& beyond = beside[static_cast<std::size_t>(b)];
      near.insert(near.end(), beyond.begin(), beyond.end());
    }
    sort_unique(near);
    for (const Index b : near)
      if (b > static_cast<Index>(a)) pairs.push_back({static_cast<Index>(a), b});
  }
  MeshEdges all(2, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t k = 0; k < pairs.size(); ++k)
    all.col(static_cast<Eigen::Index>(k)) << pairs[k][0], pairs[k][1];
  return all;
}

MeshSurface surface_of(const TetMesh& mesh) {
  MeshSurface surface;
  std::vector<std::int64_t> owners;
  for_faces(mesh, [&](std::span<const std::int64_t> of_face) {
    ++surface.faces;
    if (of_face.size() == 1) owners.push_back(of_face.front());
    if (of_face.size() > 2) surface.crowded.push_back(static_cast<Index>(of_face.front() / 4));
  });
  std::ranges::sort(owners);

  surface.triangles.resize(3, static_cast<Eigen::Index>(owners.size()));
  surface.inside.reserve(owners.size());
  std::vector<char> outside(static_cast<std::size_t>(mesh.point_count()), 0);
  for (std::size_t k = 0; k < owners.size(); ++k) {
    const auto points = face_corners(mesh, owners[k]);
    surface.triangles.col(static_cast<Eigen::Index>(k)) << points[0], points[1], points[2];
    surface.inside.push_back(static_cast<Index>(owners[k] / 4));
    for (const Index point : points) outside[static_cast<std::size_t>(point)] = 1;
  }
  for (std::size_t a = 0; a < outside.size(); ++a)
    if (outside[a]) surface.points.push_back(static_cast<Index>(a));
  surface.edges = unique_edges(mesh.point_count(), 3 * surface.triangles.cols(), [&](Eigen::Index k) {
                    const Index a = surface.triangles(k % 3, k / 3),
                                b = surface.triangles((k + 1) % 3, k / 3);
                    return std::pair(std::min(a, b), std::max(a, b));
                  }).edges;
  return surface;
}

std::vector<TetMesh::Index> unused_points(const TetMesh& mesh) {
  std::vector<char> used(static_cast<std::size_t>(mesh.point_count()), 0);
  for (const Index point : mesh.tetrahedra.reshaped()) used[static_cast<std::size_t>(point)] = 1;
  std::vector<Index> unused;
  for (std::size_t a = 0; a < used.size(); ++a)
    if (!used[a]) unused.push_back(static_cast<Index>(a));
  return unused;
}

MeshTopology topology_of(const TetMesh& mesh) {
  const MeshSurface surface = surface_of(mesh);
  MeshTopology topology;
  topology.points = mesh.point_count();
  topology.edges = edges_of(mesh).cols();
  topology.faces = surface.faces;
  topology.tetrahedra = mesh.tetrahedron_count();
  topology.surface_points = static_cast<Eigen::Index>(surface.points.size());
  topology.surface_edges = surface.edges.cols();
  topology.surface_triangles = surface.triangles.cols();
  topology.unused_points = static_cast<Eigen::Index>(unused_points(mesh).size());
  topology.crowded_faces = static_cast<Eigen::Index>(surface.crowded.size());

  DisjointSets sets(mesh.point_count());
  Eigen::Index joins = 0;
  for (const auto& tetrahedron : mesh.tetrahedra.colwise())
    for (int i = 1; i < 4; ++i) joins += sets.join(tetrahedron(0), tetrahedron(i)) ? 1 : 0;
  topology.components = topology.points - topology.unused_points - joins;
  return topology;
}

}  // namespace hmax
