#include "problems/tissue/positional/point_forces.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "core/instructions/compiled_for.hpp"
#include "core/instructions/lanes.hpp"
#include "problems/mesh/at.hpp"
#include "problems/tissue/positional/free_points.hpp"

namespace hmax {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Index = TetMesh::Index;

/// A place of a free point in a piece.
struct Place {
  std::uint32_t piece, corner;
};

/// The pieces at each free point.
class PiecesAtPoints {
 public:
  /// @param of_piece  free points of each, -1 for held ones
  PiecesAtPoints(const std::vector<std::vector<Index>>& of_piece, Index points) : first_(at(points) + 1, 0) {
    for (const auto& own : of_piece)
      for (const Index point : own)
        if (point >= 0) ++first_[at(point) + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    places_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t piece = 0; piece < of_piece.size(); ++piece)
      for (std::size_t corner = 0; corner < of_piece[piece].size(); ++corner)
        if (const Index point = of_piece[piece][corner]; point >= 0)
          places_[next[at(point)]++] = {static_cast<std::uint32_t>(piece),
                                        static_cast<std::uint32_t>(corner)};
  }
  [[nodiscard]] std::span<const Place> operator[](Index point) const {
    return std::span(places_).subspan(first_[at(point)], first_[at(point) + 1] - first_[at(point)]);
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<Place> places_;
};

template <class Piece>
std::vector<std::vector<Index>> points_of(const std::vector<Piece>& pieces) {
  std::vector<std::vector<Index>> all;
  for (const Piece& piece : pieces) all.emplace_back(std::begin(piece.point), std::end(piece.point));
  return all;
}

/// What tetrahedra do to one of their points, four at a time.
template <TetLaw law>
struct Pull {
  const PointTetrahedron* tetrahedra;
  std::span<const Place> places;
  const double* q;  ///< shape (3 free points)
  const double* own;
  Vector3d f = Vector3d::Zero();
  Matrix3d K = Matrix3d::Zero();
};

/// Displacements, slopes and coefficients of four tetrahedra, as tetrahedron_at_point() has them.
struct FourAtPoint {
  Lanes U[3][3], slopes[3][3], g[3], lambda, mu;
};

template <TetLaw law>
[[gnu::always_inline]] inline void felt_by_point(const FourAtPoint& four, std::size_t used,
                                                 AlongSlope<Lanes>& felt) {
  if constexpr (law != TetLaw::corotational) {
    tetrahedron_at_point<law, Lanes>(four.U, four.slopes, four.g, four.lambda, four.mu, felt);
  } else {
    AlongSlope<double> of_lane[Lanes::count]{};
    for (std::size_t lane = 0; lane < used; ++lane) {
      double U[3][3], slopes[3][3], g[3];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) U[i][j] = four.U[i][j][lane], slopes[i][j] = four.slopes[i][j][lane];
        g[i] = four.g[i][lane];
      }
      tetrahedron_at_point<law, double>(U, slopes, g, four.lambda[lane], four.mu[lane], of_lane[lane]);
    }
    for (int i = 0; i < 3; ++i)
      felt.stress[i] = Lanes([&](std::size_t lane) { return of_lane[lane].stress[i]; });
    for (int k = 0; k < 6; ++k)
      felt.block[k] = Lanes([&](std::size_t lane) { return of_lane[lane].block[k]; });
  }
}

template <TetLaw law>
[[gnu::always_inline]] inline void add_pieces(Pull<law>& pull) {
  AlongSlope<Lanes> sum, felt;
  for (Lanes& each : sum.stress) each = Lanes(0.0);
  for (Lanes& each : sum.block) each = Lanes(0.0);
  for (std::size_t first = 0; first < pull.places.size(); first += Lanes::count) {
    // Of each lane: displacements and slopes of the other three corners, and the slope of the own one. Lanes
    // that are left over have a tetrahedron without stiffness that moves as one.
    std::array<std::array<const double*, Lanes::count>, 3> displacement, slope;
    std::array<const double*, Lanes::count> own_slope;
    std::array<double, Lanes::count> lambda{}, mu{};
    for (std::size_t lane = 0; lane < Lanes::count; ++lane) {
      const bool used = first + lane < pull.places.size();
      const auto [piece, corner] = pull.places[used ? first + lane : first];
      const PointTetrahedron& e = pull.tetrahedra[piece];
      for (std::uint32_t other = 0; other < 3; ++other) {
        const std::uint32_t c = (corner + other + 1) % 4;
        displacement[other][lane] = used ? displacement_at(pull.q, e.point[c]) : pull.own;
        slope[other][lane] = e.slopes[c];
      }
      own_slope[lane] = e.slopes[corner];
      if (used) lambda[lane] = e.lambda, mu[lane] = e.mu;
    }
    const auto gathered = [](const std::array<const double*, Lanes::count>& from, std::size_t axis)
        __attribute__((always_inline)) {
      return Lanes([&](std::size_t lane) __attribute__((always_inline)) { return from[lane][axis]; });
    };
    FourAtPoint four;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t other = 0; other < 3; ++other) {
        four.U[other][axis] = gathered(displacement[other], axis) - Lanes(pull.own[axis]);
        four.slopes[other][axis] = gathered(slope[other], axis);
      }
      four.g[axis] = gathered(own_slope, axis);
    }
    four.lambda = Lanes([&](std::size_t lane) { return lambda[lane]; });
    four.mu = Lanes([&](std::size_t lane) { return mu[lane]; });
    felt_by_point<law>(four, std::min(Lanes::count, pull.places.size() - first), felt);
    for (int i = 0; i < 3; ++i) sum.stress[i] += felt.stress[i];
    for (int k = 0; k < 6; ++k) sum.block[k] += felt.block[k];
  }
  for (int i = 0; i < 3; ++i) {
    pull.f[i] = -sum.stress[i].sum();
    for (int j = 0; j <= i; ++j) pull.K(i, j) = pull.K(j, i) = sum.block[kernel_loops::symmetric(j, i)].sum();
  }
}

template <TetLaw law>
class PointForcesOfLaw final : public PointForces {
 public:
  PointForcesOfLaw(std::vector<PointTetrahedron> tetrahedra, Index points)
      : tetrahedra_(std::move(tetrahedra)), at_points_(pieces(), points) {}

  void add(const Eigen::VectorXd& q, Index i, Vector3d& f, Matrix3d& K) const override {
    Pull<law> pull{tetrahedra_.data(), at_points_[i], q.data(), q.data() + 3 * static_cast<Eigen::Index>(i)};
    add_pieces_(pull);
    f += pull.f;
    K += pull.K;
  }

  [[nodiscard]] std::vector<std::vector<Index>> pieces() const override { return points_of(tetrahedra_); }

 private:
  std::vector<PointTetrahedron> tetrahedra_;
  PiecesAtPoints at_points_;
  void (*add_pieces_)(Pull<law>&) = CompiledFor<add_pieces<law>>::of(instruction_sets().front());
};

template <class Law>
class PointForcesOfSprings final : public PointForces {
 public:
  PointForcesOfSprings(std::vector<PointSpring> springs, const Law& law, Index points)
      : law_(law), springs_(std::move(springs)), at_points_(pieces(), points) {}

  void add(const Eigen::VectorXd& q, Index i, Vector3d& f, Matrix3d& K) const override {
    for (const auto& [piece, corner] : at_points_[i]) {
      const PointSpring& s = springs_[piece];
      const double *near = displacement_at(q.data(), s.point[0]),
                   *far = displacement_at(q.data(), s.point[1]);
      double d[3];
      for (int k = 0; k < 3; ++k) d[k] = s.rest[k] + far[k] - near[k];
      add_spring_at_point(law_, s, corner == 0, d, f.data(), K.data());
    }
    for (Eigen::Index j = 1; j < 3; ++j)
      for (Eigen::Index k = 0; k < j; ++k) K(k, j) = K(j, k);
  }

  [[nodiscard]] std::vector<std::vector<Index>> pieces() const override { return points_of(springs_); }

 private:
  Law law_;
  std::vector<PointSpring> springs_;
  PiecesAtPoints at_points_;
};

}  // namespace

std::unique_ptr<const PointForces> point_forces_of_law(TetLaw law, std::vector<PointTetrahedron> tetrahedra,
                                                       Index points) {
  std::unique_ptr<const PointForces> made;
  with_law(law, [&]<TetLaw known>(LawConstant<known>) {
    made = std::make_unique<const PointForcesOfLaw<known>>(std::move(tetrahedra), points);
  });
  return made;
}

std::unique_ptr<const PointForces> point_forces_of_springs(std::vector<PointSpring> springs,
                                                           const SpringLaw& law, Index points) {
  return std::visit(
      [&](const auto& own) -> std::unique_ptr<const PointForces> {
        return std::make_unique<const PointForcesOfSprings<std::decay_t<decltype(own)>>>(std::move(springs),
                                                                                         own, points);
      },
      law);
}

}  // namespace hmax
