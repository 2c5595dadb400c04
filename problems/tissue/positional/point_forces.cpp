#include "problems/tissue/positional/point_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "core/instructions/compiled_for.hpp"
#include "core/instructions/lanes.hpp"
#include "problems/mesh/at.hpp"
#include "problems/tissue/forces/tet_elements.hpp"
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

Index count_of(std::span<const Index> free) { return free.empty() ? 0 : *std::ranges::max_element(free) + 1; }

using Vector = Eigen::Matrix<Lanes, 3, 1>;
using Matrix = Eigen::Matrix<Lanes, 3, 3>;

template <class Law>
[[gnu::always_inline]] inline AlongSlope<Lanes> along(const Matrix& H, const Lanes& lambda, const Lanes& mu,
                                                      const Vector& g, std::size_t used) {
  if constexpr (requires { Law::along(H, lambda, mu, g); }) {
    return Law::along(H, lambda, mu, g);
  } else {
    std::array<AlongSlope<double>, Lanes::count> of_lane;
    for (AlongSlope<double>& each : of_lane) each = {Vector3d::Zero(), Matrix3d::Zero()};
    for (std::size_t lane = 0; lane < used; ++lane) {
      const auto own = [lane](const Lanes& all) { return all[lane]; };
      const Law law(H.unaryExpr(own), {lambda[lane], mu[lane]});
      const Vector3d slope = g.unaryExpr(own);
      of_lane[lane].stress = law.stress() * slope;
      for (Eigen::Index c = 0; c < 3; ++c)
        of_lane[lane].block.col(c) = law.differential(Vector3d::Unit(c) * slope.transpose()) * slope;
    }
    AlongSlope<Lanes> answer;
    for (Eigen::Index i = 0; i < 3; ++i) {
      answer.stress[i] = Lanes([&](std::size_t lane) { return of_lane[lane].stress[i]; });
      for (Eigen::Index j = 0; j < 3; ++j)
        answer.block(i, j) = Lanes([&](std::size_t lane) { return of_lane[lane].block(i, j); });
    }
    return answer;
  }
}

/// A linear tetrahedron.
struct Element {
  std::array<Index, 4> points;         ///< free ones
  Lame scaled;                         ///< times the volume
  Eigen::Matrix<double, 3, 4> slopes;  ///< gradients of the shape functions [1/m]
};

/// What pieces do to one of their points, four at a time.
template <class Law>
struct Pull {
  const Element* elements;
  std::span<const Place> places;
  const double* q;  ///< shape (3 free points)
  const double* own;
  Vector3d f = Vector3d::Zero();
  Matrix3d K = Matrix3d::Zero();
};

template <class Law>
[[gnu::always_inline]] inline void add_pieces(Pull<Law>& pull) {
  AlongSlope<Lanes> sum{Vector::Constant(0.0), Matrix::Constant(0.0)};
  for (std::size_t first = 0; first < pull.places.size(); first += Lanes::count) {
    // Of each lane: displacements and slopes of the other three corners, and the slope of the own one. Lanes
    // that are left over repeat a piece without stiffness.
    std::array<std::array<const double*, Lanes::count>, 3> displacement, slope;
    std::array<const double*, Lanes::count> own_slope;
    std::array<Lame, Lanes::count> lame{};
    for (std::size_t lane = 0; lane < Lanes::count; ++lane) {
      const bool used = first + lane < pull.places.size();
      const auto [piece, corner] = pull.places[used ? first + lane : first];
      const Element& e = pull.elements[piece];
      for (std::uint32_t other = 0; other < 3; ++other) {
        const std::uint32_t c = (corner + other + 1) % 4;
        displacement[other][lane] = displacement_at(pull.q, e.points[c]);
        slope[other][lane] = e.slopes.data() + 3 * c;
      }
      own_slope[lane] = e.slopes.data() + 3 * corner;
      if (used) lame[lane] = e.scaled;
    }
    const auto gathered = [](const std::array<const double*, Lanes::count>& from, std::size_t axis)
        __attribute__((always_inline)) {
      return Lanes([&](std::size_t lane) __attribute__((always_inline)) { return from[lane][axis]; });
    };
    Matrix U, G;
    Vector g;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<Eigen::Index>(axis);
      for (std::size_t other = 0; other < 3; ++other) {
        U(row, static_cast<Eigen::Index>(other)) =
            gathered(displacement[other], axis) - Lanes(pull.own[axis]);
        G(row, static_cast<Eigen::Index>(other)) = gathered(slope[other], axis);
      }
      g[row] = gathered(own_slope, axis);
    }
    Matrix H;
    for (Eigen::Index j = 0; j < 3; ++j) H.col(j) = U.lazyProduct(G.row(j).transpose());
    const Lanes lambda([&](std::size_t lane) { return lame[lane].lambda; }),
        mu([&](std::size_t lane) { return lame[lane].mu; });
    const AlongSlope<Lanes> felt =
        along<Law>(H, lambda, mu, g, std::min(Lanes::count, pull.places.size() - first));
    sum.stress += felt.stress;
    for (Eigen::Index j = 0; j < 3; ++j) sum.block.col(j) += felt.block.col(j);
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    pull.f[i] = -sum.stress[i].sum();
    for (Eigen::Index j = 0; j < 3; ++j) pull.K(i, j) = sum.block(i, j).sum();
  }
}

template <class Law>
class PointForcesOfLaw final : public PointForces {
 public:
  PointForcesOfLaw(const TetMesh& mesh, std::span<const Lame> lame, std::span<const Index> free)
      : elements_(elements_of(mesh, lame, free)), at_points_(pieces(), count_of(free)) {}

  void add(const Eigen::VectorXd& q, Index i, Vector3d& f, Matrix3d& K) const override {
    Pull<Law> pull{elements_.data(), at_points_[i], q.data(), q.data() + 3 * static_cast<Eigen::Index>(i)};
    add_pieces_(pull);
    f += pull.f;
    K += pull.K;
  }

  [[nodiscard]] std::vector<std::vector<Index>> pieces() const override {
    std::vector<std::vector<Index>> all;
    for (const Element& e : elements_) all.emplace_back(e.points.begin(), e.points.end());
    return all;
  }

 private:
  static std::vector<Element> elements_of(const TetMesh& mesh, std::span<const Lame> lame,
                                          std::span<const Index> free) {
    std::vector<Element> all;
    for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
      std::array<Index, 4> corners, points;
      for (std::size_t a = 0; a < 4; ++a) {
        corners[a] = mesh.tetrahedra(static_cast<Eigen::Index>(a), t);
        points[a] = free[at(corners[a])];
      }
      const RestShape rest(mesh, corners);
      const Lame& own = lame[at(mesh.region(t))];
      Element element{points, {own.lambda * rest.volume, own.mu * rest.volume}, {}};
      element.slopes << -rest.gradients.colwise().sum().transpose(), rest.gradients.transpose();
      all.push_back(element);
    }
    return all;
  }

  std::vector<Element> elements_;
  PiecesAtPoints at_points_;
  void (*add_pieces_)(Pull<Law>&) = CompiledFor<add_pieces<Law>>::of(instruction_sets().front());
};

template <class Law>
class PointForcesOfSprings final : public PointForces {
 public:
  PointForcesOfSprings(const Eigen::Matrix3Xd& rest, const SpringSet& springs, const Law& law,
                       std::span<const Index> free)
      : law_(law), springs_(springs_of(rest, springs, free)), at_points_(pieces(), count_of(free)) {}

  void add(const Eigen::VectorXd& q, Index i, Vector3d& f, Matrix3d& K) const override {
    for (const auto& [piece, corner] : at_points_[i]) {
      const Spring& s = springs_[piece];
      const Vector3d d = s.rest + displacement_of(q, s.points[1]) - displacement_of(q, s.points[0]);
      const double l = std::max(d.norm(), std::numeric_limits<double>::min());
      const Vector3d e = d / l;
      const double strain = (l - s.length) / s.length, tension = s.stiffness * s.length * law_.phi(strain);
      f += (corner == 0 ? tension : -tension) * e;
      // dT/dl e e^T + T / l (I - e e^T)
      const double across = tension / l;
      K += across * Matrix3d::Identity() + (s.stiffness * law_.slope(strain) - across) * e * e.transpose();
    }
  }

  [[nodiscard]] std::vector<std::vector<Index>> pieces() const override {
    std::vector<std::vector<Index>> all;
    for (const Spring& s : springs_) all.emplace_back(s.points.begin(), s.points.end());
    return all;
  }

 private:
  struct Spring {
    std::array<Index, 2> points;  ///< free ones
    Vector3d rest;                ///< from the first to the second [m]
    double length, stiffness;     ///< L [m], k [N/m]
  };
  static std::vector<Spring> springs_of(const Eigen::Matrix3Xd& rest, const SpringSet& springs,
                                        std::span<const Index> free) {
    std::vector<Spring> all;
    for (std::size_t i = 0; i < springs.size(); ++i) {
      const auto& [a, b] = springs.spring(i).points;
      const Vector3d d = rest.col(b) - rest.col(a);
      all.push_back({{free[at(a)], free[at(b)]}, d, d.norm(), springs.spring(i).stiffness});
    }
    return all;
  }

  Law law_;
  std::vector<Spring> springs_;
  PiecesAtPoints at_points_;
};

}  // namespace

template <class Law>
std::unique_ptr<const PointForces> point_forces_of_law(const TetMesh& mesh, std::span<const Lame> lame,
                                                       std::span<const TetMesh::Index> free) {
  return std::make_unique<const PointForcesOfLaw<Law>>(mesh, lame, free);
}

template std::unique_ptr<const PointForces> point_forces_of_law<SmallStrain>(const TetMesh&,
                                                                             std::span<const Lame>,
                                                                             std::span<const TetMesh::Index>);
template std::unique_ptr<const PointForces> point_forces_of_law<GreenStrain>(const TetMesh&,
                                                                             std::span<const Lame>,
                                                                             std::span<const TetMesh::Index>);
template std::unique_ptr<const PointForces> point_forces_of_law<Corotational>(
    const TetMesh&, std::span<const Lame>, std::span<const TetMesh::Index>);
template std::unique_ptr<const PointForces> point_forces_of_law<StableNeoHookean>(
    const TetMesh&, std::span<const Lame>, std::span<const TetMesh::Index>);

std::unique_ptr<const PointForces> point_forces_of_springs(const Eigen::Matrix3Xd& rest,
                                                           const SpringSet& springs,
                                                           std::span<const TetMesh::Index> free) {
  return std::visit(
      [&](const auto& law) -> std::unique_ptr<const PointForces> {
        return std::make_unique<const PointForcesOfSprings<std::decay_t<decltype(law)>>>(rest, springs, law,
                                                                                         free);
      },
      springs.law());
}

}  // namespace hmax
