#include "problems/mesh/mend.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "core/sort_unique.hpp"
#include "problems/mesh/at.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;
using Eigen::Vector3d;

/// A point is moved where the least mean height around it grows by this share at least.
constexpr double least_gain = 1e-3;
/// How far a point may go, as a share of the mean length of its edges: within the body or a flat surface, and
/// on a curved one.
constexpr double reach = 0.5, outer_reach = 0.05;
/// A surface is flat around a point where the normals of its triangles are within this angle of their mean:
/// no point that slides then leaves the surface by more than `outer_reach`.
constexpr double flat = 5 * std::numbers::pi / 180;
/// Two triangles side by side make a plane: what files round does not turn their normals by this angle.
constexpr double plane = 0.1 * std::numbers::pi / 180;
/// How much larger or smaller the body may become, as a share of its volume.
constexpr double volume_share = 1e-3;

/// Heights that a move does not change differ by rounding.
constexpr double height_rounding = 1e-9;

/// Sums over tetrahedra at a point: V / h^2, h the height of the point over the face opposite to it, and V.
struct PointSums {
  double stiffness = 0, volume = 0;

  void add(const PointSums& other) {
    stiffness += other.stiffness;
    volume += other.volume;
  }
  [[nodiscard]] double mean_height() const { return std::sqrt(volume / stiffness); }
};

/// Of one tetrahedron, at each of its corners: V / h^2 = A^2 / 9 V, A the area of the opposite face.
std::array<PointSums, 4> sums_of(const Corners& x) {
  const double volume = signed_volume(x);
  std::array<PointSums, 4> sums;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& [a, b, c] = tetrahedron_faces[i];
    const double square = (x.col(b) - x.col(a)).cross(x.col(c) - x.col(a)).squaredNorm() / 4;
    sums[i] = {.stiffness = square / (9 * volume), .volume = volume};
  }
  return sums;
}

/// Least heights of tetrahedra, and least mean heights of points [m].
struct Heights {
  double least = std::numeric_limits<double>::infinity();
  double least_mean = std::numeric_limits<double>::infinity();
};

/// The tetrahedra of a point, and the points of these.
struct Star {
  std::vector<Index> points;                        ///< sorted
  std::vector<PointSums> elsewhere;                 ///< of these points, in other tetrahedra
  std::vector<std::array<std::size_t, 4>> corners;  ///< of each tetrahedron, places in `points`
};

/// Where a point may go.
struct Freedom {
  double radius = 0;                 ///< from its first place [m]; 0: it stays
  bool outside = false;              ///< on the surface
  std::optional<Vector3d> normal{};  ///< of the plane in which it slides; none: in any direction
};

std::vector<std::vector<Index>> tetrahedra_of_points(const TetMesh& mesh) {
  std::vector<std::vector<Index>> around(static_cast<std::size_t>(mesh.point_count()));
  for (Index t = 0; t < mesh.tetrahedron_count(); ++t)
    for (const Index point : mesh.tetrahedra.col(t)) around[at(point)].push_back(t);
  return around;
}

/// Directions of a search, of length 1: the neighbours of a cell in a grid, in space or in a plane.
std::vector<Vector3d> directions(const std::optional<Vector3d>& normal) {
  std::vector<Vector3d> all;
  if (normal) {
    const Vector3d u = normal->unitOrthogonal(), v = normal->cross(u);
    for (int k = 0; k < 16; ++k) {
      const double angle = k * std::numbers::pi / 8;
      all.emplace_back(std::cos(angle) * u + std::sin(angle) * v);
    }
    return all;
  }
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) all.emplace_back(Vector3d(x, y, z).normalized());
  return all;
}

/// Which triangles of a surface have another in the same plane beside them.
std::vector<char> triangles_in_planes(const MeshSurface& surface, const Eigen::Matrix3Xd& normals) {
  std::vector<char> in_plane(static_cast<std::size_t>(normals.cols()), 0);
  std::map<std::pair<Index, Index>, Eigen::Index> beside;
  for (Eigen::Index k = 0; k < normals.cols(); ++k)
    for (int i = 0; i < 3; ++i) {
      const Index a = surface.triangles(i, k), b = surface.triangles((i + 1) % 3, k);
      const auto [other, first] = beside.try_emplace(std::minmax(a, b), k);
      if (first || normals.col(k).cross(normals.col(other->second)).norm() > std::sin(plane)) continue;
      in_plane[static_cast<std::size_t>(k)] = in_plane[static_cast<std::size_t>(other->second)] = 1;
    }
  return in_plane;
}

class Mender {
 public:
  Mender(const TetMesh& mesh, const std::vector<Index>& fixed)
      : mesh_(mesh),
        first_(mesh.points),
        around_(tetrahedra_of_points(mesh)),
        freedom_(around_.size()),
        sums_(around_.size()),
        settled_(around_.size(), 0) {
    for (Index t = 0; t < mesh.tetrahedron_count(); ++t)
      most_change_ += volume_share * signed_volume(corners_of(mesh, t));
    for (Index point = 0; point < mesh.point_count(); ++point) sums_[at(point)] = sums_around(point);
    for (Index t = 0; t < mesh.tetrahedron_count(); ++t) {
      ranks_.push_back(rank_of(t));
      add(t);
    }
    free_points(fixed);
  }

  /// Of the whole mesh.
  [[nodiscard]] Heights least() const {
    if (ranks_.empty()) return {.least = 0, .least_mean = 0};
    Heights all;
    for (const auto& [least_mean, least, t] : ranks_) {
      all.least_mean = std::min(all.least_mean, least_mean);
      all.least = std::min(all.least, least);
    }
    return all;
  }

  /// Mends the tetrahedron of lowest rank that gains by it; false where none does.
  bool mend_one() {
    while (!candidates_.empty()) {
      const Index t = std::get<2>(*candidates_.begin());
      candidates_.erase(candidates_.begin());
      bool gained = false;
      for (bool more = true; more;) {
        more = false;
        for (const Index point : mesh_.tetrahedra.col(t)) more = move(point) || more;
        gained = gained || more;
      }
      if (gained) return true;
    }
    return false;
  }

  [[nodiscard]] MendedMesh result(const Heights& before) {
    const Heights after = least();
    MendedMesh done{.mesh = std::move(mesh_), .mending = {}};
    for (Index point = 0; point < done.mesh.point_count(); ++point) {
      const double distance = (done.mesh.points.col(point) - first_.col(point)).norm();
      if (distance > 0) done.mending.moved.push_back(point);
      done.mending.farthest = std::max(done.mending.farthest, distance);
    }
    done.mending.least_height_before = before.least;
    done.mending.least_mean_height_before = before.least_mean;
    done.mending.least_height_after = after.least;
    done.mending.least_mean_height_after = after.least_mean;
    return done;
  }

 private:
  /// The least mean height of its points, and its own least height: the lower, the sooner it is mended.
  using Rank = std::tuple<double, double, Index>;

  [[nodiscard]] Rank rank_of(Index t) const {
    double least_mean = std::numeric_limits<double>::infinity();
    for (const Index point : mesh_.tetrahedra.col(t))
      least_mean = std::min(least_mean, sums_[at(point)].mean_height());
    return {least_mean, least_height(corners_of(mesh_, t)), t};
  }

  void add(Index t) {
    const auto& [least_mean, least, same] = ranks_[at(t)];
    if (std::isfinite(least_mean) && std::isfinite(least)) candidates_.insert(ranks_[at(t)]);
  }

  /// Of a point, without the tetrahedra of another one.
  [[nodiscard]] PointSums sums_around(Index point, Index other = -1) const {
    PointSums sums;
    for (const Index t : around_[at(point)]) {
      const auto corners = mesh_.tetrahedra.col(t);
      if ((corners.array() == other).any()) continue;
      const std::array<PointSums, 4> own = sums_of(corners_of(mesh_, t));
      for (std::size_t i = 0; i < 4; ++i)
        if (corners(static_cast<Eigen::Index>(i)) == point) sums.add(own[i]);
    }
    return sums;
  }

  void free_points(const std::vector<Index>& fixed) {
    const EdgeTable table = edge_table(mesh_);
    std::vector<int> edges(around_.size(), 0);
    for (const auto& edge : table.edges.colwise())
      for (const Index point : edge) {
        freedom_[at(point)].radius += (mesh_.points.col(edge(0)) - mesh_.points.col(edge(1))).norm();
        ++edges[at(point)];
      }
    for (std::size_t i = 0; i < edges.size(); ++i)
      if (edges[i] > 0) freedom_[i].radius *= reach / edges[i];
    restrict_surface();
    for (std::size_t i = 0; i < around_.size(); ++i)
      for (const Index t : around_[i])
        if (mesh_.region(t) != mesh_.region(around_[i].front())) freedom_[i].radius = 0;
    for (const Index point : fixed) freedom_[at(point)].radius = 0;
  }

  /// Points of the surface keep its shape: those of a plane slide in it, its rim stays, others stay near.
  void restrict_surface() {
    const MeshSurface surface = surface_of(mesh_);
    const Eigen::Matrix3Xd normals = normals_of(surface);
    const std::vector<char> in_plane = triangles_in_planes(surface, normals);
    Eigen::Matrix3Xd means = Eigen::Matrix3Xd::Zero(3, mesh_.point_count());
    for (Eigen::Index k = 0; k < normals.cols(); ++k)
      for (const Index point : surface.triangles.col(k)) means.col(point) += normals.col(k);
    means.colwise().normalize();
    std::vector<double> cosines(around_.size(), 1);
    std::vector<char> beside_plane(around_.size(), 0);
    for (Eigen::Index k = 0; k < normals.cols(); ++k)
      for (const Index point : surface.triangles.col(k)) {
        cosines[at(point)] = std::min(cosines[at(point)], means.col(point).dot(normals.col(k)));
        if (in_plane[static_cast<std::size_t>(k)] != 0) beside_plane[at(point)] = 1;
      }
    for (const Index point : surface.points) {
      Freedom& freedom = freedom_[at(point)];
      freedom.outside = true;
      if (cosines[at(point)] >= std::cos(flat))
        freedom.normal = means.col(point);
      else
        freedom.radius *= beside_plane[at(point)] != 0 ? 0 : outer_reach / reach;
    }
  }

  /// Of the triangles of the surface, outward, of length 1.
  [[nodiscard]] Eigen::Matrix3Xd normals_of(const MeshSurface& surface) const {
    Eigen::Matrix3Xd normals(3, surface.triangles.cols());
    for (Eigen::Index k = 0; k < normals.cols(); ++k) {
      const auto triangle = surface.triangles.col(k);
      const Vector3d a = mesh_.points.col(triangle(0));
      normals.col(k) =
          (mesh_.points.col(triangle(1)) - a).cross(mesh_.points.col(triangle(2)) - a).normalized();
    }
    return normals;
  }

  [[nodiscard]] Star star_of(Index point) const {
    Star star{.points = neighbours({point}), .elsewhere = {}, .corners = {}};
    for (const Index other : star.points) star.elsewhere.push_back(sums_around(other, point));
    for (const Index t : around_[at(point)]) {
      std::array<std::size_t, 4>& places = star.corners.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) {
        const Index corner = mesh_.tetrahedra(static_cast<Eigen::Index>(i), t);
        places[i] =
            static_cast<std::size_t>(std::ranges::lower_bound(star.points, corner) - star.points.begin());
      }
    }
    return star;
  }

  [[nodiscard]] Heights heights_around(Index point, const Star& star) const {
    Heights found;
    std::vector<PointSums> sums = star.elsewhere;
    for (std::size_t k = 0; k < star.corners.size(); ++k) {
      const Corners x = corners_of(mesh_, around_[at(point)][k]);
      found.least = std::min(found.least, least_height(x));
      const std::array<PointSums, 4> own = sums_of(x);
      for (std::size_t i = 0; i < 4; ++i) sums[star.corners[k][i]].add(own[i]);
    }
    for (const PointSums& each : sums) found.least_mean = std::min(found.least_mean, each.mean_height());
    return found;
  }

  [[nodiscard]] double volume_around(Index point) const {
    double volume = 0;
    for (const Index t : around_[at(point)]) volume += signed_volume(corners_of(mesh_, t));
    return volume;
  }

  /// Where the least mean height around a point is largest and no tetrahedron is lower than the lowest was,
  /// as far as a search along directions finds it; nothing where that gains next to nothing.
  [[nodiscard]] std::optional<Vector3d> best_place(Index point) {
    const Freedom& freedom = freedom_[at(point)];
    const Star star = star_of(point);
    const std::vector<Vector3d> ways = directions(freedom.normal);
    const Vector3d start = mesh_.points.col(point), first = first_.col(point);
    const Heights before = heights_around(point, star);
    Vector3d best = start;
    double highest = before.least_mean;
    for (double step = freedom.radius / 2; step > 1e-3 * freedom.radius;) {
      const Vector3d from = best;
      for (const Vector3d& way : ways) {
        const Vector3d tried = from + step * way;
        if ((tried - first).norm() > freedom.radius) continue;
        mesh_.points.col(point) = tried;
        const Heights now = heights_around(point, star);
        if (!(now.least >= (1 - height_rounding) * before.least &&
              now.least_mean > (1 + height_rounding) * highest))
          continue;
        highest = now.least_mean;
        best = tried;
      }
      if (best == from) step /= 2;
    }
    mesh_.points.col(point) = start;
    return highest > (1 + least_gain) * before.least_mean ? std::optional(best) : std::nullopt;
  }

  /// Moves a point to its best place; false where it stays.
  bool move(Index point) {
    const Freedom& freedom = freedom_[at(point)];
    if (!(freedom.radius > 0) || settled_[at(point)] != 0) return false;
    settled_[at(point)] = 1;
    const std::optional<Vector3d> best = best_place(point);
    if (!best) return false;
    const Vector3d start = mesh_.points.col(point);
    const double volume = volume_around(point);
    mesh_.points.col(point) = *best;
    const double change = freedom.outside ? change_ + volume_around(point) - volume : change_;
    if (std::abs(change) > most_change_) {
      mesh_.points.col(point) = start;
      return false;
    }
    change_ = change;
    refresh(point);
    return true;
  }

  /// What the move of a point changed; points for which that matters may gain anew.
  void refresh(Index point) {
    const std::vector<Index> changed = neighbours({point});
    for (const Index other : changed) sums_[at(other)] = sums_around(other);
    for (const Index other : changed)
      for (const Index t : around_[at(other)]) {
        candidates_.erase(ranks_[at(t)]);
        ranks_[at(t)] = rank_of(t);
      }
    for (const Index other : neighbours(changed)) {
      if (other != point) settled_[at(other)] = 0;
      for (const Index t : around_[at(other)]) add(t);
    }
  }

  /// The points of the tetrahedra at points, sorted.
  [[nodiscard]] std::vector<Index> neighbours(const std::vector<Index>& points) const {
    std::vector<Index> found;
    for (const Index point : points)
      for (const Index t : around_[at(point)])
        for (const Index corner : mesh_.tetrahedra.col(t)) found.push_back(corner);
    sort_unique(found);
    return found;
  }

  TetMesh mesh_;
  Eigen::Matrix3Xd first_;                  ///< where the points stood
  std::vector<std::vector<Index>> around_;  ///< tetrahedra of each point
  std::vector<Rank> ranks_;                 ///< of each tetrahedron
  std::set<Rank> candidates_;               ///< of tetrahedra that may gain
  std::vector<Freedom> freedom_;
  std::vector<PointSums> sums_;          ///< around each point
  std::vector<char> settled_;            ///< points around which nothing has changed since they were tried
  double change_ = 0, most_change_ = 0;  ///< of the volume of the body by points of its surface [m^3]
};

}  // namespace

MendedMesh mended(const TetMesh& mesh, Index count, const std::vector<Index>& fixed) {
  if (count < 0)
    throw std::invalid_argument("a mesh cannot have " + std::to_string(count) +
                                " tetrahedra mended; give 0 or more");
  Mender mender(mesh, fixed);
  const Heights before = mender.least();
  for (Index i = 0; i < count && mender.mend_one(); ++i) {
  }
  return mender.result(before);
}

}  // namespace hmax
