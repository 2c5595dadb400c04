#include "problems/mesh/renumber.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "problems/mesh/topology.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

/// The neighbours of every point along edges, fewest neighbours first.
class Neighbours {
 public:
  explicit Neighbours(const TetMesh& mesh) : first_(static_cast<std::size_t>(mesh.point_count()) + 1, 0) {
    const MeshEdges edges = edges_of(mesh);
    std::vector<std::size_t> counts(first_.size(), 0);
    for (const Index point : edges.reshaped()) ++counts[static_cast<std::size_t>(point)];
    std::exclusive_scan(counts.begin(), counts.end(), first_.begin(), std::size_t{0});
    all_.resize(static_cast<std::size_t>(2 * edges.cols()));
    std::vector<std::size_t> next = first_;
    for (Eigen::Index e = 0; e < edges.cols(); ++e)
      for (const int end : {0, 1}) all_[next[static_cast<std::size_t>(edges(end, e))]++] = edges(1 - end, e);
    for (Index a = 0; a + 1 < static_cast<Index>(first_.size()); ++a)
      std::sort(begin(a), end(a),
                [&](Index b, Index c) { return std::pair(degree(b), b) < std::pair(degree(c), c); });
  }

  [[nodiscard]] std::vector<Index>::iterator begin(Index a) {
    return at(first_[static_cast<std::size_t>(a)]);
  }
  [[nodiscard]] std::vector<Index>::iterator end(Index a) {
    return at(first_[static_cast<std::size_t>(a) + 1]);
  }
  [[nodiscard]] std::size_t degree(Index a) const {
    return first_[static_cast<std::size_t>(a) + 1] - first_[static_cast<std::size_t>(a)];
  }

 private:
  std::vector<Index>::iterator at(std::size_t i) { return all_.begin() + static_cast<std::ptrdiff_t>(i); }
  std::vector<std::size_t> first_;
  std::vector<Index> all_;
};

struct Levels {
  std::size_t count, last;  ///< how many, and where in the order the last one begins
};

/// Appends the part of `start` to `order`, breadth first.
Levels walk_levels(Neighbours& neighbours, Index start, std::vector<Index>& order, std::vector<char>& seen) {
  std::size_t next = order.size();
  Levels levels{0, next};
  order.push_back(start);
  seen[static_cast<std::size_t>(start)] = 1;
  while (next < order.size()) {
    ++levels.count;
    levels.last = next;
    for (const std::size_t level_end = order.size(); next < level_end; ++next)
      for (auto it = neighbours.begin(order[next]); it != neighbours.end(order[next]); ++it)
        if (!seen[static_cast<std::size_t>(*it)]) {
          seen[static_cast<std::size_t>(*it)] = 1;
          order.push_back(*it);
        }
  }
  return levels;
}

}  // namespace

Renumbering local_order(const TetMesh& mesh) {
  Neighbours neighbours(mesh);
  const auto points = static_cast<Index>(mesh.point_count());
  std::vector<char> seen(static_cast<std::size_t>(points), 0);
  Renumbering order;
  order.points.reserve(static_cast<std::size_t>(points));
  std::vector<Index> idle;
  for (Index a = 0; a < points; ++a) {
    if (seen[static_cast<std::size_t>(a)]) continue;
    if (neighbours.degree(a) == 0) {
      idle.push_back(a);
      continue;
    }
    // From the far end of a walk start the next one, as long as that makes it longer.
    Index start = a;
    std::size_t longest = 0;
    const std::size_t before = order.points.size();
    while (true) {
      const Levels levels = walk_levels(neighbours, start, order.points, seen);
      if (levels.count <= longest) break;
      longest = levels.count;
      start =
          *std::ranges::min_element(order.points.begin() + static_cast<std::ptrdiff_t>(levels.last),
                                    order.points.end(), {}, [&](Index b) { return neighbours.degree(b); });
      for (std::size_t i = before; i < order.points.size(); ++i)
        seen[static_cast<std::size_t>(order.points[i])] = 0;
      order.points.resize(before);
    }
  }
  std::ranges::reverse(order.points);
  order.points.insert(order.points.end(), idle.begin(), idle.end());

  std::vector<Index> now(order.points.size());
  for (std::size_t i = 0; i < now.size(); ++i)
    now[static_cast<std::size_t>(order.points[i])] = static_cast<Index>(i);
  // Elements by their four lowest points.
  std::vector<std::pair<std::array<Index, 4>, Index>> keys(static_cast<std::size_t>(mesh.element_count()));
  for (std::size_t e = 0; e < keys.size(); ++e) {
    const std::span<const Index> element = mesh.element(static_cast<Eigen::Index>(e));
    std::array<Index, 10> corners{};
    const auto end = std::ranges::transform(element, corners.begin(), [&](Index a) {
                       return now[static_cast<std::size_t>(a)];
                     }).out;
    std::partial_sort(corners.begin(), corners.begin() + 4, end);
    std::copy_n(corners.begin(), 4, keys[e].first.begin());
    keys[e].second = static_cast<Index>(e);
  }
  std::ranges::sort(keys);
  order.tetrahedra.reserve(static_cast<std::size_t>(mesh.tetrahedron_count()));
  for (const auto& key : keys)
    for (Eigen::Index part = 0; part < mesh.parts(); ++part)
      order.tetrahedra.push_back(static_cast<Index>(mesh.first_part(key.second) + part));
  return order;
}

TetMesh renumbered(const TetMesh& mesh, const Renumbering& order) {
  TetMesh result;
  result.points = mesh.points(Eigen::all, order.points);
  std::vector<Index> now(order.points.size());
  for (std::size_t i = 0; i < now.size(); ++i)
    now[static_cast<std::size_t>(order.points[i])] = static_cast<Index>(i);
  result.tetrahedra = mesh.tetrahedra(Eigen::all, order.tetrahedra).unaryExpr([&](Index a) {
    return now[static_cast<std::size_t>(a)];
  });
  if (!mesh.regions.empty())
    for (const Index t : order.tetrahedra) result.regions.push_back(mesh.region(t));
  result.ten_node.resize(10, mesh.ten_node.cols());
  for (Eigen::Index e = 0; e < mesh.ten_node.cols(); ++e)
    for (int i = 0; i < 10; ++i)
      result.ten_node(i, e) = now[static_cast<std::size_t>(
          mesh.ten_node(i, order.tetrahedra[static_cast<std::size_t>(8 * e)] / 8))];
  return result;
}

}  // namespace hmax
