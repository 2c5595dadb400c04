#include "analysis/dynamics/equilibria.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/dense_solvers.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// The angle from a to b, in (-pi, pi].
/// atan2 of cross and dot product, independent of both lengths.
double turn(const Vector2d& a, const Vector2d& b) {
  const Vector2d u = a.stableNormalized(), w = b.stableNormalized();
  return std::atan2(u(0) * w(1) - u(1) * w(0), u.dot(w));
}

/// The angle by which g turns from a to b on a straight line; NaN where that cannot be said.
/// Halves the line until both halves turn by less than pi / 4, so that no whole turn is missed between two
/// looks of a smooth g.
/// @param looks   that are left, of all lines
/// @param slides  whether g goes the shorter way where it jumps, as a field does whose motions slide there
template <class Function>
double turn_between(const Function& g, const Vector2d& a, const Vector2d& ga, const Vector2d& b,
                    const Vector2d& gb, int& looks, bool slides) {
  const Vector2d middle = (a + b) / 2;
  const Vector2d gm = g(middle);
  for (const Vector2d& known : {gm, gb})
    if (!known.allFinite() || known.isZero(0)) return std::nan("");
  const double first = turn(ga, gm), second = turn(gm, gb);
  constexpr double little = std::numbers::pi / 4;
  if (std::abs(first) < little && std::abs(second) < little) return first + second;
  if (middle == a || middle == b) {  // neighbouring numbers
    const double jump = turn(ga, gb);
    return slides && std::abs(jump) < 0.99 * std::numbers::pi ? jump : std::nan("");
  }
  if (--looks <= 0) return std::nan("");
  return turn_between(g, a, ga, middle, gm, looks, slides) +
         turn_between(g, middle, gm, b, gb, looks, slides);
}

/// The points of the ring |u|_max = 1 from which Newton's steps start: off the axes and diagonals, on which
/// kinks lie.
constexpr std::array<std::array<double, 2>, 8> ring{
    {{1, 0.4}, {0.3, 1}, {-0.4, 1}, {-1, 0.3}, {-1, -0.4}, {-0.3, -1}, {0.4, -1}, {1, -0.3}}};

Vector2d on_ring(const Vector2d& y, const Vector2d& r, std::size_t k) {
  return y + r.cwiseProduct(Vector2d(ring[k][0], ring[k][1]));
}

bool is_within(const Vector2d& d, const Vector2d& r) { return (d.cwiseAbs().array() <= r.array()).all(); }

/// J at the points of a ring.
using Slopes = std::array<Matrix2d, ring.size()>;
Slopes slopes(const PlanarField& field, const Vector2d& y, const Vector2d& r) {
  Slopes J;
  for (std::size_t k = 0; k < ring.size(); ++k)
    J[k] = field.jacobian(on_ring(y, r, k)) * (r / r.norm()).asDiagonal();
  return J;
}

/// By how much two Jacobians differ, as a share of both; rows for themselves.
double difference(const Matrix2d& A, const Matrix2d& B) {
  double most = 0;
  for (int i = 0; i < 2; ++i) {
    const double sum = A.row(i).stableNorm() + B.row(i).stableNorm();
    if (sum > 0) most = std::max(most, (A.row(i) - B.row(i)).stableNorm() / sum);
  }
  return most;
}

}  // namespace

// The winding number of f along the border, from the angles between neighbouring values.
std::optional<int> degree_around(const std::function<Vector2d(const Vector2d&)>& f, const Window& window,
                                 bool slides) {
  require_valid(window);
  constexpr int pieces = 64;
  int looks = 10'000;
  const Vector2d &lower = window.lower, &upper = window.upper;
  const std::array<Vector2d, 5> corners{lower, Vector2d(upper(0), lower(1)), upper,
                                        Vector2d(lower(0), upper(1)), lower};
  double angle = 0;
  Vector2d from = lower, there = f(from);
  for (std::size_t side = 0; side < 4; ++side)
    for (int piece = 1; piece <= pieces; ++piece) {
      // 64 pieces a side, counter-clockwise from the lower left corner.
      const double share = double(piece) / pieces;
      const Vector2d to = (1 - share) * corners[side] + share * corners[side + 1];
      const Vector2d next = f(to);
      angle += turn_between(f, from, there, to, next, looks, slides);
      if (!std::isfinite(angle)) return std::nullopt;
      from = to;
      there = next;
    }
  return static_cast<int>(std::lround(angle / (2 * std::numbers::pi)));
}

Equilibria::Equilibria(const PlanarField& field, const Window& window)
    : field_{[this, rhs = field.rhs](const Vector2d& y) {
               ++evaluations_;
               return rhs(y);
             },
             [this, jacobian = field.jacobian](const Vector2d& y) {
               ++evaluations_;
               return jacobian(y);
             },
             field.jacobian_error},
      window_(window),
      size_(window.size()) {
  require_valid(window);
}

// J S (d / S) = -f with S the sizes of the window, each component of f in units of its own slopes. J is
// singular where its determinant is rounding of the two products that it is the difference of; then, as on a
// line of equilibria, the nearest zero of the linear field is wanted.
std::optional<Vector2d> Equilibria::step(const Vector2d& y) {
  Vector2d f = field_.rhs(y);
  if (f.isZero(0)) return Vector2d(0, 0);  // J need not exist there
  Matrix2d J = field_.jacobian(y) * size_.asDiagonal();
  if (!f.allFinite() || !J.allFinite()) return std::nullopt;
  for (int i = 0; i < 2; ++i) {
    const double slope = J.row(i).stableNorm();
    if (slope == 0) continue;
    f(i) /= slope;
    J.row(i) /= slope;
  }
  const double one = J(0, 0) * J(1, 1), other = J(0, 1) * J(1, 0), D = one - other;
  Vector2d d;
  if (std::abs(D) > 4 * epsilon * (std::abs(one) + std::abs(other))) {
    d = Vector2d(J(0, 1) * f(1) - J(1, 1) * f(0), J(1, 0) * f(0) - J(0, 0) * f(1)) / D;
  } else {  // rows that are the same but for their signs, or zero
    const double sign = J.row(0).dot(J.row(1)) < 0 ? -1 : 1;
    const bool both = !J.row(0).isZero(0) && !J.row(1).isZero(0);
    const double rest = both ? std::abs(f(0) - sign * f(1)) : J.row(0).isZero(0) ? f(0) : f(1);
    if (both && rest > 1e-12 + 1e-9 * std::abs(f(0))) return std::nullopt;
    if (!both && rest != 0) return std::nullopt;
    d = -(f(0) + sign * f(1)) / (both ? 4 : 1) * (J.row(0) + sign * J.row(1)).transpose();
  }
  if (!d.allFinite()) return std::nullopt;
  return d.cwiseProduct(size_);
}

/// Whether so many steps lead from each point of the border of a box into the box `to`. Where f is not finite
/// it has no motions either: those points do not count.
bool Equilibria::returns(const Vector2d& y, const Vector2d& r, const Vector2d& to, int steps) {
  int counted = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    Vector2d z = on_ring(y, r, k);
    if (!field_.rhs(z).allFinite()) continue;
    ++counted;
    bool is_back = false;
    for (int i = 0; i < steps && !is_back; ++i) {
      const auto d = step(z);
      if (!d || d->isZero(0)) return false;
      z += *d;
      is_back = is_within(z - y, to);
    }
    if (!is_back) return false;
  }
  return counted > 1;
}

std::optional<Equilibria::Boxes> Equilibria::boxes(const Vector2d& y, int steps) {
  constexpr int lowest = -100, highest = 5;
  // A zero of higher order is known to the root of rounding.
  const Vector2d least = (steps > 1 ? 1e-8 : 32 * epsilon) * y.cwiseAbs();
  std::optional<Boxes> found;
  Vector2d before = Vector2d::Zero();
  int passed = 0, tried = 0;
  for (int power = lowest; power <= highest; power += 3) {
    const Vector2d r = (std::ldexp(1.0, power) * size_).cwiseMax(least);
    if (r == before) continue;
    ++tried;
    // Many steps may pass another zero: they must lead into the box before, so that boxes are a chain.
    const Vector2d to = steps > 1 && tried > 1 ? Vector2d(before.cwiseMin(r / 4)) : Vector2d(r / 4);
    passed = returns(y, r, to, steps) ? passed + 1 : 0;
    if (passed == 0 && found) break;
    if (passed == 2) found = Boxes{before, r, tried == 2};
    if (passed > 2) found->outer = r;
    before = r;
  }
  return found;
}

/// The largest |f - f(y) - J (y' - y)| on the border of a box, of each component.
Vector2d Equilibria::bend(const Vector2d& y, const Vector2d& r) {
  const Vector2d f = field_.rhs(y);
  const Matrix2d J = field_.jacobian(y);
  Vector2d most = Vector2d::Zero();
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vector2d z = on_ring(y, r, k), rest = field_.rhs(z) - f - J * (z - y);
    if (rest.allFinite()) most = most.cwiseMax(rest.cwiseAbs());
  }
  return most;
}

/// What rounding makes of f around y: the bend on the border of a small box, and the linear part of a larger.
Vector2d Equilibria::rounding(const Vector2d& y, const Vector2d& small, const Vector2d& large) {
  return bend(y, small.cwiseMax(8 * epsilon * y.cwiseAbs())) +
         epsilon * (field_.jacobian(y).cwiseAbs() * large);
}

/// Whether only rounding keeps Newton's steps from ending in smaller boxes, neither a jump of f nor slopes
/// that change.
bool Equilibria::is_simple(const Vector2d& y, const Boxes& found) {
  if (found.from_rounding) return true;
  const Slopes far = slopes(field_, y, found.inner), near = slopes(field_, y, found.inner / 64);
  for (std::size_t k = 0; k < ring.size(); ++k)
    if (!(difference(far[k], near[k]) < 0.1)) return false;
  return is_within(bend(y, found.inner / 1024), 1e-9 * field_.jacobian(y).cwiseAbs() * size_);
}

double Equilibria::change_of_slopes(const Vector2d& y, const Vector2d& r) {
  const Slopes J = slopes(field_, y, r);
  double change = 0;
  for (const Matrix2d& other : J) change = std::max(change, difference(J[0], other));
  return change;
}

// What hides a zero is rounding, which is as large in a smaller box: of a smooth f the bend falls by 64 or
// more. Where there is none at all f is flat, by rounding only if it is still small where it no longer is.
bool Equilibria::is_hidden_zero(const Vector2d& y, const Boxes& found) {
  const auto bend_in = [&](double share) {
    return bend(y, (share * found.inner).cwiseMax(8 * epsilon * y.cwiseAbs()));
  };
  if (!is_within(field_.rhs(y), 8 * rounding(y, found.inner / 1024, found.inner))) return false;
  if (found.from_rounding) return true;
  const Vector2d far = bend_in(1. / 1024), near = bend_in(1. / 8192);
  return is_within(found.inner, size_ / 4) && is_within(far, 16 * near) &&
         (near.array() > 0 || bend_in(1).array() <= 1e-6 * bend(y, size_).array()).all();
}

/// Whether Newton's method leads from around y to zeros that are not y.
bool Equilibria::has_neighbours(const Vector2d& y, const Vector2d& r) {
  for (std::size_t k = 0; k < ring.size(); ++k) {
    Vector2d z = on_ring(y, r, k), d = r;
    for (int i = 0; i < 60 && !is_within(d, 1e-6 * r); ++i) {
      const auto next = step(z);
      if (!next) break;
      d = *next;
      z += d;
    }
    if (is_within(d, 1e-6 * r) && is_within(z - y, 8 * r) && !is_within(z - y, r / 4)) return true;
  }
  return false;
}

/// Units of the second component in which both change each other alike, by J on the border of a box.
double Equilibria::ratio_of_units(const Vector2d& y, const Vector2d& r) {
  Matrix2d J = Matrix2d::Zero();
  for (std::size_t k = 0; k < ring.size(); ++k) J += field_.jacobian(on_ring(y, r, k)).cwiseAbs();
  return J(0, 1) > 0 && J(1, 0) > 0 ? std::sqrt(J(1, 0) / J(0, 1)) : size_(1) / size_(0);
}

// Of a smooth field J changes by an eighth as much on an eighth of the way.
bool Equilibria::is_kink(const Vector2d& y, const Vector2d& r) {
  const Vector2d units(1, ratio_of_units(y, r));
  const auto change = [&](const Vector2d& at) {
    double most = 0;
    Matrix2d first;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Matrix2d J =
          units.cwiseInverse().asDiagonal() * field_.jacobian(on_ring(y, at, k)) * units.asDiagonal();
      if (k == 0) first = J;
      most = std::max(most, (J - first).norm() / (J.norm() + first.norm()));
    }
    return most;
  };
  const double near = change(r);
  return near > field_.jacobian_error && near > change(8 * r) / 2;
}

void Equilibria::judge_kink(const Boxes& found, Equilibrium& e) {
  // As far from rounding as from what bends.
  const Vector2d r = found.outer * std::sqrt(found.inner.cwiseQuotient(found.outer).maxCoeff());
  const std::int64_t before = evaluations_;
  const double unit = ratio_of_units(e.state, r);
  Kink kink = kink_around(field_.rhs, e.state, r, unit);
  if (kink.rays.empty()) {  // terms of second order change the rate in proportion to the distance
    const Kink nearer = kink_around(field_.rhs, e.state, r / 2, unit);
    const double change = nearer.rays.empty() ? nearer.rate - kink.rate : 0;
    kink.rate += 2 * change;
    kink.rate_error += std::abs(change) / 10;
  }
  evaluations_ = before;  // bounded by the number of points
  e.kink = kink;
  if (kink.rays.empty()) {
    e.index = 1;
    e.eigenvalues = {std::complex(kink.rate, kink.frequency), std::complex(kink.rate, -kink.frequency)};
    e.type = std::abs(kink.rate) <= kink.rate_error ? EquilibriumType::centre
             : kink.rate < 0                        ? EquilibriumType::stable_focus
                                                    : EquilibriumType::unstable_focus;
    return;
  }
  const auto [least, largest] = std::ranges::minmax(kink.rays, {}, &Kink::Ray::rate);
  e.eigenvalues = {std::complex(largest.rate), std::complex(least.rate)};
  e.type = largest.rate < 0 ? EquilibriumType::stable_node
           : least.rate > 0 ? EquilibriumType::unstable_node
           : e.index == -1  ? EquilibriumType::saddle
                            : EquilibriumType::degenerate;
  if (largest.rate < 0 || least.rate > 0) e.index = 1;
}

/// @param arrived  whether y is a zero to rounding
void Equilibria::judge(Vector2d y, bool arrived) {
  const Vector2d inside = y.cwiseMax(window_.lower).cwiseMin(window_.upper);
  if (!is_within(y - inside, 16 * epsilon * y.cwiseAbs())) return;
  // A coordinate that is zero to rounding is printed as 0.
  const auto rounded = [&](const Vector2d& to) -> Vector2d {
    const Vector2d near = (inside.cwiseAbs().array() <= to.array()).select(0.0, inside);
    return near.cwiseMax(window_.lower).cwiseMin(window_.upper);
  };
  auto found = boxes(y, 1);
  if (found && !is_simple(y, *found)) found.reset();
  const bool simple = found.has_value();
  if (!found && is_within(field_.rhs(y), 8 * rounding(y, 1e-9 * size_, size_))) {
    found = boxes(y, 60);
    if (found && !is_hidden_zero(rounded(found->inner), *found)) found.reset();
  }
  if (!found && !(arrived && is_within(field_.rhs(y), 8 * rounding(y, Vector2d(0, 0), y.cwiseAbs())))) return;
  y = rounded(found ? Vector2d(simple ? found->inner / 4 : found->inner) : Vector2d(1e-15 * size_));
  if (is_known(y)) return;
  const Matrix2d J = field_.jacobian(y);
  Equilibrium e{.state = y, .type = EquilibriumType::degenerate, .eigenvalues = eigenvalues_2x2(J)};
  Vector2d reach = found ? found->outer : Vector2d(1e-6 * size_);
  if (found && std::ranges::any_of(
                   known_, [&](const Known& other) { return is_within(other.point.state - y, reach); }))
    reach = found->inner;
  const bool is_bent = simple && is_kink(y, found->inner);
  if (simple && !is_bent) e.type = classify(J);
  e.index = e.type == EquilibriumType::degenerate ? degree_around(field_.rhs, {y - reach, y + reach}, true)
            : e.type == EquilibriumType::saddle   ? std::optional(-1)
                                                  : std::optional(1);
  if (is_bent) judge_kink(*found, e);
  if (!found && (!e.index || has_neighbours(y, reach))) isolated_ = false;
  known_.push_back({e, reach});
}

bool Equilibria::is_known(const Vector2d& y) const {
  return std::ranges::any_of(
      known_, [&](const Known& other) { return is_within(y - other.point.state, other.reach); });
}

bool Equilibria::holds(const Window& box) const {
  return std::ranges::any_of(known_, [&](const Known& known) {
    const Vector2d& y = known.point.state;
    return (y.array() >= box.lower.array()).all() && (y.array() <= box.upper.array()).all();
  });
}

bool Equilibria::covers(const Window& box) const {
  return std::ranges::any_of(known_, [&](const Known& known) {
    return is_within(box.lower - known.point.state, known.reach) &&
           is_within(box.upper - known.point.state, known.reach);
  });
}

void Equilibria::take(const Vector2d& start, double leash) {
  // Linear convergence to a double root gains one bit a step, so many more steps than to a simple one.
  constexpr int most_steps = 300, most_that_grow = 40;
  Vector2d y = start, d = size_;
  const auto is_small = [&](double share, double of_window) {
    return is_within(d, share * y.cwiseAbs().cwiseMax(of_window * size_));
  };
  double before = infinity;
  for (int count = 0, grown = 0; count < most_steps && grown < most_that_grow && !is_small(epsilon, 0);
       ++count) {
    if (is_known(y)) return;
    const auto full = step(y);
    if (!full) return;
    d = *full;
    const double length = d.cwiseQuotient(size_).stableNorm();
    if (!std::isfinite(length)) return;
    if (length > 1) d /= length;  // near a fold of f the full step may leave for infinity
    y += d;
    if (!((y - start).cwiseQuotient(size_).norm() <= leash)) return;
    grown += length >= before;
    before = length;
  }
  if (is_small(1e-3, 1e-3) && !is_known(y)) judge(y, is_small(1e-9, 1e-6));
}

void Equilibria::take_grid() {
  constexpr int starts = 15;
  for (int i = 0; i < starts; ++i)
    for (int j = 0; j < starts; ++j)
      take(window_.lower + Vector2d(i + 0.5, j + 0.5).cwiseProduct(size_) / starts);
}

std::optional<int> Equilibria::index_sum() const {
  int sum = 0;
  for (const Known& known : known_) {
    if (!known.point.index) return std::nullopt;
    sum += *known.point.index;
  }
  return sum;
}

std::vector<Equilibrium> Equilibria::points() const {
  std::vector<Equilibrium> all;
  for (const Known& known : known_) all.push_back(known.point);
  std::ranges::sort(all, {}, [](const Equilibrium& e) { return std::pair(e.state(0), e.state(1)); });
  return all;
}

std::vector<Equilibrium> find_equilibria(const PlanarField& field, const Window& window) {
  Equilibria found(field, window);
  found.take_grid();
  return found.points();
}

}  // namespace hmax
