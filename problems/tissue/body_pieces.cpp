#include "problems/tissue/body_pieces.hpp"

#include <algorithm>
#include <ranges>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/sort_unique.hpp"
#include "problems/mesh/at.hpp"
#include "problems/mesh/renumber.hpp"
#include "problems/mesh/ten_node.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {
namespace {

/// Columns `first` to `last` of a symmetric matrix of a piece as rows of that of the body.
/// @param columns  of the body, of each of the piece
BodyPieces::Rows rows_of(const TissueBody::DofMatrix& A, Eigen::Index first, Eigen::Index last,
                         std::span<const int> columns, Eigen::Index dofs) {
  const int *const outer = A.outerIndexPtr(), from = outer[first];
  BodyPieces::Rows rows(last - first, dofs);
  rows.resizeNonZeros(outer[last] - from);
  for (Eigen::Index i = first; i <= last; ++i) rows.outerIndexPtr()[i - first] = outer[i] - from;
  for (int entry = from; entry < outer[last]; ++entry) {
    rows.innerIndexPtr()[entry - from] = columns[at(A.innerIndexPtr()[entry])];
    rows.valuePtr()[entry - from] = A.valuePtr()[entry];
  }
  return rows;
}

/// The springs of a support that act on the points of a piece, in the numbers of the piece.
/// @param points  of the piece, rising
ElasticSupport within(const ElasticSupport& support, const std::vector<TetMesh::Index>& points) {
  ElasticSupport own;
  for (std::size_t i = 0; i < support.points.size(); ++i) {
    const auto place = std::ranges::lower_bound(points, support.points[i]);
    if (place == points.end() || *place != support.points[i]) continue;
    own.points.push_back(static_cast<TetMesh::Index>(place - points.begin()));
    own.stiffness.push_back(support.stiffness[i]);
  }
  return own;
}

}  // namespace

BodyPieces::BodyPieces(const TetMesh& mesh, TissueSettings settings) : settings_(std::move(settings)) {
  if (settings_.springs.surface_bending > 0 || settings_.springs.second_ring > 0)
    throw std::invalid_argument(
        "surface bending and second rings are of a stiffness relative to the mean of all springs, which no piece of a body "
        "knows; set bending=0 and second_ring=0");
  alpha_ = std::exchange(settings_.alpha, 0.0);
  beta_ = std::exchange(settings_.beta, 0.0);
  settings_.gravity.setZero();
  settings_.forces.clear();
  settings_.tools.clear();
  const Renumbering order = local_order(mesh);
  mesh_ = renumbered(mesh, order);
  std::vector<Index> now(order.points.size());
  for (std::size_t i = 0; i < now.size(); ++i) now[at(order.points[i])] = static_cast<Index>(i);
  for (Support& support : settings_.supports) {
    support.travel.setZero();
    for (Index& point : support.points) {
      if (point < 0 || at(point) >= now.size())
        throw std::invalid_argument("a support names a point that the mesh does not have");
      point = now[at(point)];
    }
  }
  for (ElasticSupport& support : settings_.elastic_supports) {
    check_stiffness(support);
    for (Index& point : support.points) {
      if (point < 0 || at(point) >= now.size())
        throw std::invalid_argument("an elastic support names a point that the mesh does not have");
      point = now[at(point)];
    }
  }
  number_free_points();
  set_masses();
  for (Eigen::Index e = 0; e < mesh_.element_count(); ++e) {
    const auto [low, high] = std::ranges::minmax(mesh_.element(e));
    width_ = std::max(width_, high - low);
  }
  pairs_ = acting_pairs(settings_.model, mesh_, edge_table(mesh_));
}

bool BodyPieces::has_dampers() const {
  return settings_.model.is_of_springs() &&
         (settings_.springs.damper > 0 || settings_.springs.damper_time > 0);
}

void BodyPieces::number_free_points() {
  number_.assign(at(mesh_.point_count()), 0);
  for (const Support& support : settings_.supports)
    for (const Index point : support.points) number_[at(point)] = -1;
  for (Index point = 0; point < mesh_.point_count(); ++point) {
    if (number_[at(point)] < 0) continue;
    number_[at(point)] = free_points();
    free_points_.push_back(point);
  }
  if (free_points_.empty())
    throw std::invalid_argument("every point of the mesh is supported; leave some of them free");
}

/// A mass that is given is that of the whole body: pieces get it by their densities, or point by point.
void BodyPieces::set_masses() {
  if (!settings_.total_mass && !settings_.equal_masses) return;
  double mass = 0;
  std::vector<TissueMaterial>& materials = settings_.materials;
  for (Eigen::Index e = 0; e < mesh_.element_count(); ++e)
    mass += materials.at(materials.size() == 1 ? 0 : at(mesh_.region(mesh_.first_part(e)))).density *
            element_volume(mesh_, e);
  const double given = settings_.total_mass.value_or(mass);
  settings_.total_mass.reset();
  if (settings_.equal_masses)
    mass_of_point_ = given / static_cast<double>(mesh_.point_count());
  else
    for (TissueMaterial& material : materials) material.density *= given / mass;
}

std::vector<BodyPieces::Index> BodyPieces::touching(const std::vector<Index>& points) const {
  const auto lowest = [&](Index e) { return std::ranges::min(mesh_.element(e)); };
  // Elements come in the order of their lowest points.
  const auto first_from = [&](Index point) {
    return *std::ranges::lower_bound(std::views::iota(Index{0}, static_cast<Index>(mesh_.element_count())),
                                     point, {}, lowest);
  };
  const Index stop = first_from(points.back() + 1);
  std::vector<Index> found;
  for (Index e = first_from(points.front() - width_); e < stop; ++e)
    if (std::ranges::any_of(mesh_.element(e), [&](Index i) { return std::ranges::binary_search(points, i); }))
      found.push_back(e);
  return found;
}

std::vector<BodyPieces::Index> BodyPieces::points_of(const std::vector<Index>& elements) const {
  std::vector<Index> points;
  for (const Index e : elements) {
    const std::span<const Index> own = mesh_.element(e);
    points.insert(points.end(), own.begin(), own.end());
  }
  sort_unique(points);
  return points;
}

TetMesh BodyPieces::around(Index begin, Index end, std::vector<Index>& points) const {
  std::vector<Index> elements = touching({free_points_.begin() + begin, free_points_.begin() + end});
  points = points_of(elements);
  if (settings_.model.averages_at_points) {
    elements = touching(points);
    points = points_of(elements);
  }
  std::vector<Index> tetrahedra;
  for (const Index e : elements)
    for (Eigen::Index part = 0; part < mesh_.parts(); ++part)
      tetrahedra.push_back(static_cast<Index>(mesh_.first_part(e) + part));
  const auto local = [&](Index point) {
    return static_cast<Index>(std::ranges::lower_bound(points, point) - points.begin());
  };
  TetMesh piece;
  piece.points = mesh_.points(Eigen::all, points);
  piece.tetrahedra = mesh_.tetrahedra(Eigen::all, tetrahedra).unaryExpr(local);
  if (mesh_.has_ten_nodes()) piece.ten_node = mesh_.ten_node(Eigen::all, elements).unaryExpr(local);
  if (!mesh_.regions.empty())
    for (const Index each : tetrahedra) piece.regions.push_back(mesh_.region(each));
  return piece;
}

BodyPieces::Piece BodyPieces::piece(Index begin, Index end) const {
  std::vector<Index> points;
  const TetMesh mesh = around(begin, end, points);
  TissueSettings settings = settings_;
  settings.supports.clear();
  Support held;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (number_[at(points[i])] < 0) held.points.push_back(static_cast<Index>(i));
  if (!held.points.empty()) settings.supports.push_back(std::move(held));
  for (ElasticSupport& support : settings.elastic_supports) support = within(support, points);
  if (settings.equal_masses) settings.total_mass = mass_of_point_ * static_cast<double>(points.size());
  const TissueBody body(mesh, std::move(settings));

  std::vector<int> columns;
  for (const Index point : body.free_points())
    for (int axis = 0; axis < 3; ++axis) columns.push_back(3 * number_[at(points[at(point)])] + axis);
  const auto own = std::ranges::lower_bound(columns, 3 * begin);
  const Eigen::Index first = own - columns.begin(), last = first + 3 * Eigen::Index{end - begin};
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix matrix;
  body.stiffness(0, still, still, matrix);
  Piece piece{.stiffness = rows_of(matrix, first, last, columns, dofs()),
              .damping = {},
              .mass = body.mass().segment(first, last - first)};
  if (!has_dampers()) return piece;
  body.damping(0, still, still, matrix);
  piece.damping = rows_of(matrix, first, last, columns, dofs());
  return piece;
}

BodyPieces::Neighbours BodyPieces::neighbours(Index begin, Index end) const {
  const auto is_inside = [&](Index number) { return number >= begin && number < end; };
  Neighbours counts{.inside = std::vector<int>(at(end - begin), 1),
                    .outside = std::vector<int>(at(end - begin), 0)};
  for (const auto& edge : pairs_.colwise())
    for (const int own : {0, 1}) {
      const Index number = number_[at(edge[own])], other = number_[at(edge[1 - own])];
      if (number >= 0 && other >= 0 && is_inside(number))
        ++(is_inside(other) ? counts.inside : counts.outside)[at(number - begin)];
    }
  return counts;
}

}  // namespace hmax
