#include "problems/mesh/files/mesh_import.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/sort_unique.hpp"
#include "problems/digits.hpp"
#include "problems/mesh/at.hpp"
#include "problems/mesh/coincident_points.hpp"
#include "problems/mesh/files/mesh_defects.hpp"
#include "problems/mesh/files/ten_nodes.hpp"
#include "problems/mesh/refine.hpp"
#include "problems/mesh/renumber.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

Eigen::MatrixXd scattered(const Eigen::MatrixXd& now, const std::vector<Index>& order, Eigen::Index columns) {
  if (now.cols() != static_cast<Eigen::Index>(order.size()))
    throw std::invalid_argument(std::to_string(now.cols()) +
                                " columns of values do not belong to a mesh of " +
                                std::to_string(order.size()) + "; give one for each");
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(now.rows(), columns);
  for (std::size_t i = 0; i < order.size(); ++i) result.col(order[i]) = now.col(static_cast<Eigen::Index>(i));
  return result;
}

}  // namespace

std::int64_t MeshOrigin::tetrahedron_number(Eigen::Index tetrahedron) const {
  return file.numbers.at(at(tetrahedra.at(at(tetrahedron))));
}

std::int64_t MeshOrigin::point_number(Eigen::Index point) const {
  return file.point_numbers.at(at(points.at(at(point))));
}

Eigen::MatrixXd MeshOrigin::on_points(const Eigen::MatrixXd& now) const {
  return scattered(now, points, file.mesh.point_count());
}

Eigen::MatrixXd MeshOrigin::on_tetrahedra(const Eigen::MatrixXd& now) const {
  return scattered(now, tetrahedra, file.mesh.tetrahedron_count());
}

std::vector<TetMesh::Index> MeshOrigin::model_points() const {
  std::vector<Index> points_now(at(file.mesh.point_count()), -1);
  for (std::size_t i = 0; i < points.size(); ++i) points_now[at(points[i])] = static_cast<Index>(i);
  return points_now;
}

std::vector<TetMesh::Index> number_regions(TetMesh& mesh) {
  std::vector<Index> names = mesh.regions;
  sort_unique(names);
  if (names.size() < 2) {
    mesh.regions.clear();
    return names.empty() ? std::vector<Index>{0} : names;
  }
  for (Index& region : mesh.regions)
    region = static_cast<Index>(std::ranges::lower_bound(names, region) - names.begin());
  return names;
}

MeshImport import_mesh(MeshFile file, double unit) {
  if (!(unit > 0 && std::isfinite(unit)))
    throw std::invalid_argument("a unit of " + shortest_digits(unit) +
                                " m is no length; give a positive one");
  require_valid(file);
  file.mesh.points *= unit;
  Renumbering order = local_order(file.mesh);
  MeshImport result;
  result.mesh = renumbered(file.mesh, order);
  const Eigen::Index used =
      file.mesh.point_count() - static_cast<Eigen::Index>(unused_points(file.mesh).size());
  order.points.resize(at(used));  // the idle ones are the last
  result.mesh.points.conservativeResize(3, used);
  result.origin = {.file = std::move(file),
                   .points = std::move(order.points),
                   .tetrahedra = std::move(order.tetrahedra),
                   .regions = number_regions(result.mesh)};
  return result;
}

MeshImport import_as_it_is(MeshFile file) {
  MeshImport result{.mesh = file.mesh, .origin = {}};
  result.origin.points.resize(at(file.mesh.point_count()));
  result.origin.tetrahedra.resize(at(file.mesh.tetrahedron_count()));
  std::iota(result.origin.points.begin(), result.origin.points.end(), 0);
  std::iota(result.origin.tetrahedra.begin(), result.origin.tetrahedra.end(), 0);
  result.origin.regions = number_regions(result.mesh);
  result.origin.file = std::move(file);
  return result;
}

Eigen::Index merge_points(MeshFile& file, double tolerance) {
  if (!(tolerance >= 0 && tolerance < largest_coincidence))
    throw std::invalid_argument("a tolerance of " + shortest_digits(tolerance) +
                                " does not merge points; give a share of the shortest edge from 0 to below " +
                                shortest_digits(largest_coincidence));
  const std::vector<Index> first = coincident_points(file.mesh, tolerance);
  for (Eigen::Index t = 0; t < file.mesh.tetrahedron_count(); ++t)
    for (const auto& [i, j] : tetrahedron_edges) {
      const Index a = file.mesh.tetrahedra(i, t), b = file.mesh.tetrahedra(j, t);
      if (a != b && first[at(a)] == first[at(b)] && file.mesh.points.col(a) != file.mesh.points.col(b))
        throw std::invalid_argument(file.where(t) + " would lose an edge where points within " +
                                    shortest_digits(tolerance) +
                                    " of an edge are merged; give a smaller tolerance");
    }
  std::vector<Index> now(first.size());
  std::vector<std::int64_t> numbers;
  const std::size_t merged_before = file.merged.size();
  for (std::size_t i = 0; i < first.size(); ++i) {
    const bool stays = first[i] == static_cast<Index>(i);
    now[i] = stays ? static_cast<Index>(numbers.size()) : now[at(first[i])];
    if (!stays) {
      file.merged.emplace_back(file.point_numbers[i], first[i]);
      continue;
    }
    file.mesh.points.col(static_cast<Eigen::Index>(numbers.size())) =
        file.mesh.points.col(static_cast<Eigen::Index>(i));
    numbers.push_back(file.point_numbers[i]);
  }
  const auto gone = static_cast<Eigen::Index>(file.merged.size() - merged_before);
  if (gone == 0) return 0;
  file.mesh.points.conservativeResize(3, static_cast<Eigen::Index>(numbers.size()));
  file.point_numbers = std::move(numbers);
  for (Index& corner : file.mesh.tetrahedra.reshaped()) corner = now[at(corner)];
  for (Index& middle : file.middles.reshaped())
    if (middle >= 0) middle = now[at(middle)];
  for (MeshGroup& group : file.groups)
    for (Index& corner : group.corners) corner = now[at(corner)];
  for (auto& [number, point] : file.merged) point = now[at(point)];  // those merged before, too
  return gone;
}

MeshFile refined(const MeshFile& file, int times) {
  MeshFile fine = file;
  const bool ten_nodes = file.middles.cols() > 0;
  TetMesh result = refined(file.mesh, times);  // says first whether so often is too often
  TetMesh coarse = file.mesh;
  for (int i = 0; i < times && !ten_nodes && !fine.groups.empty(); ++i) {
    const EdgeTable table = edge_table(coarse);
    std::vector<Index> middles(at(table.edges.cols()));
    std::iota(middles.begin(), middles.end(), static_cast<Index>(coarse.point_count()));
    for (MeshGroup& group : fine.groups) group = refined_group(group, table, middles);
    coarse = i + 1 < times ? refined(coarse) : TetMesh{};
  }
  if (!ten_nodes) fine.mesh = std::move(result);
  for (int i = 0; i < times && ten_nodes; ++i) fine = refined_ten_nodes(fine);
  number_new_points(fine);
  fine.numbers.resize(at(fine.mesh.tetrahedron_count()));
  std::iota(fine.numbers.begin(), fine.numbers.end(), 1);
  fine.places.assign(fine.numbers.size(), 0);
  return fine;
}

Mending mend(MeshFile& file, TetMesh::Index count) {
  std::vector<Index> fixed;
  for (const MeshGroup& group : file.groups)
    fixed.insert(fixed.end(), group.corners.begin(), group.corners.end());
  MendedMesh done = mended(file.mesh, count, fixed);
  // The middles of edges go along with their ends.
  std::vector<char> moved(at(file.mesh.point_count()), 0);
  for (Eigen::Index t = 0; t < file.middles.cols(); ++t)
    for (std::size_t e = 0; e < tetrahedron_edges.size(); ++e) {
      const Index middle = file.middles(static_cast<Eigen::Index>(e), t);
      if (middle < 0 || std::exchange(moved[at(middle)], 1) != 0) continue;
      for (const int end : tetrahedron_edges[e]) {
        const Index corner = file.mesh.tetrahedra(end, t);
        done.mesh.points.col(middle) += (done.mesh.points.col(corner) - file.mesh.points.col(corner)) / 2;
      }
    }
  file.mesh = std::move(done.mesh);
  return std::move(done.mending);
}

MeshFile renumbered(const MeshFile& file) {
  const Renumbering order = local_order(file.mesh);
  MeshFile result = counted_from_one(renumbered(file.mesh, order), file.name);
  result.format = file.format;
  result.names = file.names;
  result.groups = file.groups;
  std::vector<Index> now(order.points.size());
  for (std::size_t i = 0; i < now.size(); ++i) now[at(order.points[i])] = static_cast<Index>(i);
  for (MeshGroup& group : result.groups)
    for (Index& corner : group.corners) corner = now[at(corner)];
  return result;
}

}  // namespace hmax
