#include "problems/mesh/files/ten_nodes.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "problems/mesh/at.hpp"
#include "problems/mesh/coincident_points.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/refine.hpp"
#include "problems/mesh/ten_node.hpp"

namespace hmax {
namespace {

using Index = TetMesh::Index;

/// The point in the middle of each edge that the file has, else -1.
std::vector<Index> known_middles(const MeshFile& file, const EdgeTable& table) {
  const TetMesh& mesh = file.mesh;
  std::vector<Index> middles(at(table.edges.cols()), -1);
  for (Eigen::Index t = 0; t < file.middles.cols(); ++t)
    for (std::size_t e = 0; e < tetrahedron_edges.size(); ++e) {
      const Index point = file.middles(static_cast<Eigen::Index>(e), t);
      if (point < 0) continue;
      const Index one = mesh.tetrahedra(tetrahedron_edges[e][0], t),
                  other = mesh.tetrahedra(tetrahedron_edges[e][1], t);
      Index& known = middles[at(table.find(one, other))];
      if (known < 0) known = point;
      // Coincident points without an edge are not merged where files are read.
      const double apart = (mesh.points.col(known) - mesh.points.col(point)).norm();
      if (apart > near_coincidence * (mesh.points.col(one) - mesh.points.col(other)).norm())
        throw std::invalid_argument(file.where(t) + " has node " +
                                    std::to_string(file.point_numbers[at(point)]) +
                                    " in the middle of an edge where its neighbour has node " +
                                    std::to_string(file.point_numbers[at(known)]) +
                                    "; export the mesh again, or use a model of tetrahedra of four nodes");
    }
  return middles;
}

void require_volume(const MeshFile& file, Eigen::Index element) {
  const TenPlaces X = ten_places(file.mesh, element);
  bool good = std::ranges::all_of(ten_node_rule(),
                                  [&](const UnitPlace& place) { return ten_node_determinant(X, place) > 0; });
  for (Eigen::Index part = 0; part < 8; ++part)
    good = good && signed_volume(corners_of(file.mesh, 8 * element + part)) > 0;
  if (!good)
    throw std::invalid_argument(
        file.where(8 * element) +
        " has a part without volume: its sides are bent too far, or its middles are in "
        "the order of another format; export the mesh again, or use a model of "
        "tetrahedra of four nodes");
}

}  // namespace

MeshGroup refined_group(const MeshGroup& group, const EdgeTable& table, std::span<const Index> middles) {
  MeshGroup fine{.dimension = group.dimension, .number = group.number, .name = group.name};
  const std::size_t size = at(group.dimension) + 1;
  for (std::size_t begin = 0; begin < group.corners.size(); begin += size) {
    const Index* p = group.corners.data() + begin;
    std::array<Index, 3> middle{};
    bool known = true;
    for (std::size_t k = 0; k < size && size > 1; ++k) {
      const Index edge = table.find(p[k], p[(k + 1) % size]);
      known = known && edge >= 0;
      if (edge >= 0) middle[k] = middles[at(edge)];
    }
    if (!known) continue;
    if (size == 1) fine.corners.push_back(p[0]);
    if (size == 2) fine.corners.insert(fine.corners.end(), {p[0], middle[0], middle[0], p[1]});
    if (size == 3)
      fine.corners.insert(fine.corners.end(), {p[0], middle[0], middle[2], middle[0], p[1], middle[1],
                                               middle[2], middle[1], p[2], middle[0], middle[1], middle[2]});
  }
  return fine;
}

void number_new_points(MeshFile& file) {
  const auto last = std::ranges::max_element(file.point_numbers);
  std::int64_t next = last == file.point_numbers.end() ? 0 : *last + 1;
  for (const auto& [number, point] : file.merged) next = std::max(next, number + 1);
  while (file.point_numbers.size() < at(file.mesh.point_count())) file.point_numbers.push_back(next++);
}

MeshFile with_ten_nodes(const MeshFile& file) {
  const TetMesh& mesh = file.mesh;
  const EdgeTable table = edge_table(mesh);
  std::vector<Index> middles = known_middles(file, table);
  MeshFile result = file;
  result.middles.resize(6, 0);
  auto next = static_cast<Index>(mesh.point_count());
  for (std::size_t e = 0; e < middles.size(); ++e) {
    if (middles[e] >= 0) continue;
    const auto edge = table.edges.col(static_cast<Eigen::Index>(e));
    middles[e] = next++;
    result.inserted.push_back({middles[e], edge[0], edge[1]});
  }
  TetMesh& fine = result.mesh;
  fine.points.conservativeResize(3, next);
  for (const auto& [point, one, other] : result.inserted)
    fine.points.col(point) = 0.5 * (mesh.points.col(one) + mesh.points.col(other));
  number_new_points(result);

  fine.tetrahedra.resize(4, 8 * mesh.tetrahedron_count());
  fine.ten_node.resize(10, mesh.tetrahedron_count());
  fine.regions.clear();
  result.numbers.clear();
  result.places.clear();
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    TenPoints own{};
    std::ranges::copy(mesh.tetrahedra.col(t), own.begin());
    for (std::size_t e = 0; e < 6; ++e)
      own[4 + e] =
          middles[at(table.find(own[at(tetrahedron_edges[e][0])], own[at(tetrahedron_edges[e][1])]))];
    std::ranges::copy(own, fine.ten_node.col(t).begin());
    Eigen::Index column = 8 * t;
    for (const auto& part : parts_of(fine.points, own))
      std::ranges::copy(part, fine.tetrahedra.col(column++).begin());
    result.numbers.insert(result.numbers.end(), 8, file.numbers[at(t)]);
    result.places.insert(result.places.end(), 8, file.places[at(t)]);
    if (!mesh.regions.empty()) fine.regions.insert(fine.regions.end(), 8, mesh.region(t));
  }
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) require_volume(result, t);
  for (MeshGroup& group : result.groups) group = refined_group(group, table, middles);
  return result;
}

MeshFile refined_ten_nodes(const MeshFile& file) {
  MeshFile fine = with_ten_nodes(file);
  const TetMesh coarse = fine.mesh;
  const EdgeTable table = edge_table(coarse);
  const auto first = static_cast<Index>(coarse.point_count());
  fine.inserted.clear();
  fine.mesh.ten_node.resize(10, 0);
  fine.mesh.points.conservativeResize(3, first + table.edges.cols());
  fine.middles.resize(6, coarse.tetrahedron_count());
  for (Eigen::Index t = 0; t < coarse.tetrahedron_count(); ++t) {
    const auto own = coarse.ten_node.col(t / 8);
    const TenPlaces X = ten_places(coarse, t / 8);
    const auto place = [&](int corner) {
      return unit_places()[at(std::ranges::find(own, coarse.tetrahedra(corner, t)) - own.begin())];
    };
    for (std::size_t e = 0; e < 6; ++e) {
      const auto& [i, j] = tetrahedron_edges[e];
      const Index point = first + table.find(coarse.tetrahedra(i, t), coarse.tetrahedra(j, t));
      fine.middles(static_cast<Eigen::Index>(e), t) = point;
      fine.mesh.points.col(point) = X * ten_node_values((place(i) + place(j)) / 2);
    }
  }
  return fine;
}

}  // namespace hmax
