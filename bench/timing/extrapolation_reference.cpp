#include "bench/timing/extrapolation_reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <variant>

namespace hmax {

namespace {

using Real = long double;
using State = ExtrapolationReference::State;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

constexpr Real epsilon = std::numeric_limits<Real>::epsilon();
constexpr int most_rows = 14;
constexpr int usual_attempts = 50'000;
constexpr int most_iterations = 30;
constexpr int parts = 32;  // of an implicit step that explicit ones may take

/// Substeps of the rows of the extrapolation table. Ratios near sqrt 2 keep what the table makes of rounding
/// below a factor of about 200 where errors go in powers of h; even numbers give the midpoint rule its powers
/// of h^2.
constexpr std::array<int, most_rows> slow_growth{2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192};
constexpr std::array<int, most_rows> even{2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28};

/// I - h J as an LU factorisation with row interchanges, restricted to the band of J.
class ShiftedBand {
 public:
  /// @returns  false when the matrix is singular or not finite
  bool factor(const ExtrapolationReference::System::Jacobian& J, Real h) {
    fill(J, h);
    const Eigen::Index n = band_.cols();
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Index below = std::min(n - 1 - k, lower_), right = std::min(n - 1, k + diagonal_);
      Eigen::Index down = 0;
      const Real pivot = band_.col(k).segment(diagonal_, below + 1).cwiseAbs().maxCoeff(&down);
      if (!(pivot > 0) || !std::isfinite(pivot)) return false;
      pivots_[static_cast<std::size_t>(k)] = k + down;
      if (down != 0)
        for (Eigen::Index j = k; j <= right; ++j) std::swap(at(k, j), at(k + down, j));
      auto multipliers = band_.col(k).segment(diagonal_ + 1, below);
      multipliers /= at(k, k);
      for (Eigen::Index j = k + 1; j <= right; ++j)
        if (const Real top = at(k, j); top != 0)
          band_.col(j).segment(diagonal_ + k + 1 - j, below) -= top * multipliers;
    }
    return true;
  }

  void solve(State& x) const {
    const Eigen::Index n = band_.cols();
    for (Eigen::Index k = 0; k < n; ++k) {
      std::swap(x[k], x[pivots_[static_cast<std::size_t>(k)]]);
      const Eigen::Index below = std::min(n - 1 - k, lower_);
      x.segment(k + 1, below) -= x[k] * band_.col(k).segment(diagonal_ + 1, below);
    }
    for (Eigen::Index k = n - 1; k >= 0; --k) {
      x[k] /= band_(diagonal_, k);
      const Eigen::Index above = std::min(k, diagonal_);
      x.segment(k - above, above) -= x[k] * band_.col(k).segment(diagonal_ - above, above);
    }
  }

 private:
  Real& at(Eigen::Index i, Eigen::Index j) { return band_(diagonal_ + i - j, j); }

  void fill(const ExtrapolationReference::System::Jacobian& any, Real h) {
    std::visit(
        [&](const auto& J) {
          const Eigen::Index n = J.cols();
          Eigen::Index upper = 0;
          lower_ = 0;
          each_entry(J, [&](Eigen::Index i, Eigen::Index j, Real) {
            lower_ = std::max(lower_, i - j);
            upper = std::max(upper, j - i);
          });
          diagonal_ = std::min(lower_ + upper, n - 1);  // row interchanges fill that much above the diagonal
          band_.setZero(diagonal_ + lower_ + 1, n);
          pivots_.resize(static_cast<std::size_t>(n));
          each_entry(J, [&](Eigen::Index i, Eigen::Index j, Real value) { at(i, j) = -h * value; });
          for (Eigen::Index j = 0; j < n; ++j) at(j, j) += 1;
        },
        any);
  }
  template <class Visit>
  static void each_entry(const Matrix& J, const Visit& visit) {
    for (Eigen::Index j = 0; j < J.cols(); ++j)
      for (Eigen::Index i = 0; i < J.rows(); ++i) visit(i, j, J(i, j));
  }
  template <class Visit>
  static void each_entry(const Eigen::SparseMatrix<Real>& J, const Visit& visit) {
    for (Eigen::Index j = 0; j < J.outerSize(); ++j)
      for (Eigen::SparseMatrix<Real>::InnerIterator it(J, j); it; ++it) visit(it.row(), it.col(), it.value());
  }

  Matrix band_;  // entry (i, j) stands in row diagonal_ + i - j of column j
  Eigen::Index lower_ = 0, diagonal_ = 0;
  std::vector<Eigen::Index> pivots_;
};

/// Integrates with extrapolation of variable order and step.
class Engine {
 public:
  Engine(const ExtrapolationReference::System& system, ExtrapolatedRule rule, Real tolerance)
      : system_(system), rule_(rule), tolerance_(tolerance) {}

  /// From y at t to t_end, calling at_step(t, y) after every step; y is the last state that was reached.
  /// @param h  first step to try in, next step to try out
  /// @returns  whether t_end was reached
  template <class AtStep>
  bool advance(Real& t, State& y, Real t_end, Real& h, const AtStep& at_step,
               int most_attempts = usual_attempts) {
    if (largest_.size() != y.size()) largest_ = y.cwiseAbs();
    for (int attempts = 0; t < t_end; ++attempts) {
      if (attempts == most_attempts) return false;
      const bool last = t + 1.01L * h >= t_end;
      const Real step = last ? t_end - t : h;
      if (!(t + step > t)) return false;
      const bool accepted = attempt(t, y, step);
      if (accepted) {
        y += increment_;
        largest_ = largest_.cwiseMax(y.cwiseAbs());
        t = last ? t_end : t + step;
        at_step(t, y);
      }
      // A step cut short by t_end says nothing against the longer one.
      h = accepted && last ? std::max(h, next_) : next_;
    }
    return true;
  }

  /// A first step to try: a thousandth of the time in which the state changes by its own size.
  Real first_step(Real t, const State& y, Real t_end) {
    State slope(y.size());
    system_.rhs(t, y, slope);
    const Real speed = slope.cwiseAbs().maxCoeff();
    return speed > 0 ? std::min(t_end - t, (y.cwiseAbs().maxCoeff() + 1e-6L) / speed * 1e-3L) : t_end - t;
  }

 private:
  [[nodiscard]] bool implicit() const { return rule_ == ExtrapolatedRule::implicit_euler; }
  /// At tolerances near rounding high orders are always the cheapest: fewer rows than these are never enough.
  [[nodiscard]] int fewest_rows() const { return implicit() ? most_rows : 7; }
  [[nodiscard]] int substeps(int row) const {
    return (implicit() ? slow_growth : even)[static_cast<std::size_t>(row)];
  }

  /// One step: rows of the table until two neighbours agree. increment_ is y(t + h) - y(t); next_ is the next
  /// step to try, the one that would have been cheapest per unit of time.
  bool attempt(Real t, const State& y, Real h) {
    next_ = h / 4;
    Real least = std::numeric_limits<Real>::infinity();
    int work = 1;
    State difference;
    for (int row = 0; row < most_rows; ++row) {
      auto& newest = table_[static_cast<std::size_t>(row)];
      if (!(implicit() ? euler(t, y, h, substeps(row), newest) : midpoint(t, y, h, substeps(row), newest)))
        return false;
      work += substeps(row);
      // T_(j,k) = T_(j,k-1) + (T_(j,k-1) - T_(j-1,k-1)) / ((n_j / n_(j-k))^p - 1) for j = row; table_[i]
      // holds T_(j-1,j-1-i) until it receives T_(j,j-i).
      for (int k = 1; k <= row; ++k) {
        const auto i = static_cast<std::size_t>(row - k);
        Real ratio = static_cast<Real>(substeps(row)) / static_cast<Real>(substeps(row - k));
        if (!implicit()) ratio *= ratio;
        difference = (table_[i + 1] - table_[i]) / (ratio - 1);
        table_[i] = table_[i + 1] + difference;
      }
      if (row + 1 < fewest_rows()) continue;
      const Real error = relative(difference, y, table_[0]) / tolerance_;
      if (!std::isfinite(error)) return false;
      // What the last column changed is of size h^(p row + 1).
      const Real power = 1 / static_cast<Real>(implicit() ? row + 1 : 2 * row + 1);
      const Real factor = std::clamp(0.8L * std::pow(0.5L / std::max(error, 1e-30L), power), 0.1L, 6.0L);
      if (const Real cost = static_cast<Real>(work) / factor; cost < least) {
        least = cost;
        next_ = h * factor;
      }
      if (error <= 1) {
        increment_ = table_[0];
        return true;
      }
    }
    next_ = std::min(next_, h / 2);
    return false;
  }

  /// The largest component of `difference` relative to the same component at either end of y ... y +
  /// increment, or to 1e-10 of the largest value it ever had, which matters only where it passes through
  /// zero.
  template <class Increment>
  [[nodiscard]] Real relative(const State& difference, const State& y, const Increment& increment) const {
    Real worst = 0;
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      if (difference[i] == 0) continue;
      const Real size = std::max({std::abs(y[i]), std::abs(y[i] + increment[i]), 1e-10L * largest_[i]});
      const Real one = std::abs(difference[i]) / (size + 1e-40L);
      if (!(one <= worst)) worst = one;
    }
    return worst;
  }

  /// y_1 = y_0 + h f(y_0), y_(i+1) = y_(i-1) + 2 h f(y_i), all of it as increments over y.
  bool midpoint(Real t, const State& y, Real H, int n, State& increment) {
    const Real h = H / static_cast<Real>(n);
    State before = State::Zero(y.size()), slope(y.size());
    system_.rhs(t, y, slope);
    increment = h * slope;
    for (int i = 1; i < n; ++i) {
      argument_ = y + increment;
      system_.rhs(t + static_cast<Real>(i) * h, argument_, slope);
      before += 2 * h * slope;
      before.swap(increment);
    }
    return increment.allFinite();
  }

  /// y_(i+1) = y_i + h f(t_(i+1), y_(i+1)) by Newton's iteration up to rounding. The matrix I - h J is kept
  /// while it serves.
  bool euler(Real t, const State& y, Real H, int n, State& increment) {
    const Real h = H / static_cast<Real>(n);
    State move = State::Zero(y.size()), residual(y.size());
    increment = State::Zero(y.size());
    if (!factor(t, y, h)) return false;
    for (int i = 1; i <= n; ++i) {
      const Real now = t + static_cast<Real>(i) * h;
      // The last move is the first guess of the next one.
      Real last = std::numeric_limits<Real>::infinity();
      bool converged = false;
      for (int iteration = 0; iteration < most_iterations && !converged; ++iteration) {
        argument_ = y + (increment + move);
        system_.rhs(now, argument_, residual);
        residual = h * residual - move;
        matrix_.solve(residual);
        move += residual;
        const Real size = relative(residual, y, increment + move);
        if (!std::isfinite(size)) return false;
        const Real rate = size / last;
        last = size;
        // Converged when the next correction is below rounding, or when rounding is all that still moves.
        converged = (rate < 1 ? size * rate : size) < epsilon / 4 || (rate > 0.3L && size < 1e-15L);
        if (!converged && rate > 0.1L) {
          argument_ = y + (increment + move);
          if (!factor(now, argument_, h)) return false;
        }
      }
      if (!converged) return false;
      increment += move;
    }
    return true;
  }

  bool factor(Real t, const State& y, Real h) {
    system_.jacobian(t, y, jacobian_);
    return matrix_.factor(jacobian_, h);
  }

  const ExtrapolationReference::System& system_;
  ExtrapolatedRule rule_;
  Real tolerance_;
  std::array<State, most_rows> table_;
  State increment_, argument_, largest_;
  Real next_ = 0;
  ExtrapolationReference::System::Jacobian jacobian_;
  ShiftedBand matrix_;
};

/// The rounding of linear solves is amplified by the table, so the stiff rule cannot be asked for as much.
Real tight(ExtrapolatedRule rule) { return rule == ExtrapolatedRule::explicit_midpoint ? 1e-17L : 1e-16L; }
Real loose(ExtrapolatedRule rule) { return 10 * tight(rule); }

/// From y at `from` to t. @returns  false where it is not reached in so many attempts: y is another state
/// then
bool advanced(const ExtrapolationReference::System& system, ExtrapolatedRule rule, State& y, Real from,
              Real t, int most_attempts) {
  Real h = t - from;
  Engine engine(system, rule, tight(rule));
  return engine.advance(
      from, y, t, h, [](Real, const State&) {}, most_attempts);
}

}  // namespace

ExtrapolationReference::ExtrapolationReference(const System& system, const State& y0, double t_end,
                                               ExtrapolatedRule rule, const std::function<void()>& watch)
    : system_(system), rule_(rule) {
  if (rule == ExtrapolatedRule::implicit_euler && !system.has_jacobian())
    throw std::invalid_argument(
        "the implicit Euler rule needs a Jacobian, which this system has not; use the explicit midpoint "
        "rule");
  if (!(t_end >= 0)) throw std::invalid_argument("the end time of a reference must not be negative");
  if (!y0.allFinite()) throw std::invalid_argument("the initial state of a reference must be finite");

  points_.emplace_back(0, y0);
  Engine engine(system_, rule, tight(rule));
  Real t = 0, h = engine.first_step(0, y0, t_end);
  State y = y0;
  engine.advance(t, y, t_end, h, [&](Real now, const State& state) {
    points_.emplace_back(now, state);
    if (watch) watch();
  });
  valid_until_ = static_cast<double>(points_.back().t);
  if (points_.back().t < valid_until_) valid_until_ = std::nextafter(valid_until_, 0.0);

  Engine checker(system_, rule, loose(rule));
  State checked = y0;
  Real difference = 0, largest = y0.cwiseAbs().maxCoeff();
  t = 0;
  h = checker.first_step(0, y0, t_end);
  const std::size_t every = std::max<std::size_t>(1, steps() / 300);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    if (i % every != 0 && i != points_.size() - 1) continue;
    checker.advance(t, checked, points_[i].t, h, [&](Real, const State&) {
      if (watch) watch();
    });
    difference = std::max(difference, (checked - points_[i].y).cwiseAbs().maxCoeff());
    largest = std::max(largest, points_[i].y.cwiseAbs().maxCoeff());
  }
  // Between two steps the tolerance itself may be in error, and a double half a unit in its last place.
  extended_error_bound_ = static_cast<double>(16 * (difference + tight(rule) * largest));
  error_bound_ =
      extended_error_bound_ + static_cast<double>(largest) * std::numeric_limits<double>::epsilon() / 2;
  relative_error_at_end_ = ((checked - points_.back().y).cwiseAbs().array() * 4 /
                            points_.back().y.cwiseAbs().array().max(std::numeric_limits<Real>::min()))
                               .matrix()
                               .cast<double>();
}

const std::vector<State>& ExtrapolationReference::divided(const Point& left, long double part) const {
  std::call_once(left.is_divided, [&] {
    constexpr ExtrapolatedRule rule = ExtrapolatedRule::explicit_midpoint;
    State y = left.y;
    for (int i = 1; i < parts && advanced(system_, rule, y, left.t + (i - 1) * part, left.t + i * part, 1);
         ++i)
      left.between.push_back(y);
  });
  return left.between;
}

State ExtrapolationReference::extended_at(long double t) const {
  const auto nothing = [&] {
    return State::Constant(points_.front().y.size(), std::numeric_limits<Real>::quiet_NaN());
  };
  if (!(t >= 0) || t > points_.back().t) return nothing();
  auto after = std::upper_bound(points_.begin(), points_.end(), t,
                                [](Real time, const Point& point) { return time < point.t; });
  const Point& left = *(after - 1);
  if (left.t == t) return left.y;
  State y = left.y;
  Real from = left.t;
  if (rule_ == ExtrapolatedRule::implicit_euler) {
    const Real part = (after->t - left.t) / parts;
    const std::vector<State>& between = divided(left, part);
    const auto near = std::min(static_cast<std::size_t>((t - left.t) / part), between.size());
    if (near > 0) {
      y = between[near - 1];
      from += static_cast<Real>(near) * part;
    }
    if (!between.empty() && advanced(system_, ExtrapolatedRule::explicit_midpoint, y, from, t, 1)) return y;
  }
  return advanced(system_, rule_, y, from, t, usual_attempts) ? y : nothing();
}

std::string ExtrapolationReference::name() const {
  return rule_ == ExtrapolatedRule::explicit_midpoint
             ? "extrapolated explicit midpoint rule in long double, tolerance 1e-17"
             : "extrapolated implicit Euler in long double, tolerance 1e-16";
}

}  // namespace hmax
