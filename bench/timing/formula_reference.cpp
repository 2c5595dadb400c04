#include "bench/timing/formula_reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "integrators/breakpoints.hpp"

#if HMAX_HAVE_BOOST
#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#else
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"
#endif

namespace hmax {

namespace {

constexpr int grid_intervals = 2000;
constexpr double tight = 1e-13, loose = 1e-11;
// Where the two computations part by more than this share of the largest state there is nothing to rely on:
// an engine may well put a finite number on a pole.
constexpr double largest_parting = 1e-4;

/// The units of each component, shape (dim).
Eigen::VectorXd by_component(const StateUnits& units, const AnySystem& system) {
  Eigen::VectorXd all = Eigen::VectorXd::Constant(system.dim(), units.others);
  all.head(system.dofs()).setConstant(units.positions);
  return all;
}

/// The largest numbers of a state.
StateUnits sizes_of(const AnySystem& system, const Eigen::VectorXd& y) {
  const auto largest = [](const auto& part) {
    return part.size() == 0 ? 0.0 : part.template lpNorm<Eigen::Infinity>();
  };
  const Eigen::Index n = system.dofs();
  return {largest(y.head(n)), largest(y.tail(y.size() - n))};
}

/// Powers of two near the sizes so far, which change no digits; where nothing has moved yet near what an
/// interval from y at t makes of it.
StateUnits units_of(const AnySystem& system, StateUnits sizes, double t, const Eigen::VectorXd& y,
                    double interval) {
  if (!(sizes.others > 0)) {
    Eigen::VectorXd f = y;
    for (const double share : {0.0, 0.5, 1.0}) {
      system.rhs(t + share * interval, y, f);
      if (f.allFinite()) sizes.others = std::max(sizes.others, interval * sizes_of(system, f).others);
    }
  }
  if (!(sizes.positions > 0)) sizes.positions = interval * sizes.others;
  const auto near = [](double size) {
    constexpr double least = 1e-290, most = 1e290;
    return size > 0 ? std::exp2(std::round(std::log2(std::clamp(size, least, most)))) : 1;
  };
  // A small state beside a large one of another unit keeps the tolerance of numbers near one.
  return {std::min(1.0, near(sizes.positions)), std::min(1.0, near(sizes.others))};
}

/// Integrates y from t0 to t1, between which f does not jump; false when the engine gives up or y is no
/// longer finite.
/// @param tolerance  relative, and absolute in these units
bool advance_piece(const AnySystem& system, Eigen::VectorXd& y, double t0, double t1, double tolerance,
                   const StateUnits& units) {
  const Eigen::VectorXd unit = by_component(units, system);
#if HMAX_HAVE_BOOST
  namespace odeint = boost::numeric::odeint;
  using Values = std::vector<double>;
  Eigen::VectorXd state = y, slope = y;
  auto rhs = [&](const Values& from, Values& to, double t) {
    state = Eigen::Map<const Eigen::VectorXd>(from.data(), state.size()).cwiseProduct(unit);
    system.rhs(t, state, slope);
    slope = slope.cwiseQuotient(unit);
    std::copy(slope.begin(), slope.end(), to.begin());
  };
  odeint::bulirsch_stoer<Values> stepper(tolerance, tolerance);
  state = y.cwiseQuotient(unit);
  Values values(state.begin(), state.end());
  double t = t0, h = t1 - t0;
  for (int attempts = 0; t < t1; ++attempts) {
    if (attempts == 10'000 || !(std::abs(h) > 0)) return false;
    h = std::min(h, t1 - t);
    stepper.try_step(rhs, values, t, h);
    if (t1 - t <= 4 * std::numeric_limits<double>::epsilon() * std::abs(t1)) break;
  }
  y = Eigen::Map<const Eigen::VectorXd>(values.data(), y.size()).cwiseProduct(unit);
  return y.allFinite();
#else
  const auto end = integrate(Rk<tableaux::Dop853, Eigen::VectorXd>{}, system, Span<double>{t0, t1}, y,
                             Adaptive<double, PiController>(
                                 {.rtol = tolerance, .atol = tolerance * unit.minCoeff(), .h_max = t1 - t0},
                                 tableaux::Dop853::error_order),
                             ObserveNothing{}, 100'000);
  return end.outcome == Outcome::reached_end;
#endif
}

/// The same where f may jump at the breakpoints of the system.
bool advance(const AnySystem& system, Eigen::VectorXd& y, double t0, double t1, double tolerance,
             const StateUnits& units) {
  const auto piece = [&](const AnySystem& of, Span<double> span, std::int64_t) {
    const bool done = advance_piece(of, y, span.t0, span.t_end, tolerance, units);
    return RunEnd<double>{done ? Outcome::reached_end : Outcome::diverged, span.t_end, {}};
  };
  return run_by_pieces(system, Span<double>{t0, t1}, y, std::numeric_limits<std::int64_t>::max(), piece)
             .outcome == Outcome::reached_end;
}

}  // namespace

FormulaReference::FormulaReference(const AnySystem& system, const Eigen::VectorXd& y0, double t_end,
                                   const std::function<void()>& watch)
    : system_(system), interval_(t_end / grid_intervals), grid_{y0} {
  Eigen::VectorXd y = y0, checked = y0;
  double difference = 0, largest = y0.size() == 0 ? 0 : y0.cwiseAbs().maxCoeff();
  StateUnits sizes = sizes_of(system_, y);
  // What other systems round to may be more than a share of their motion.
  const bool of_formulas = system_.formulas() != nullptr;
  for (int i = 0; i < grid_intervals; ++i) {
    if (watch) watch();
    units_.push_back(of_formulas ? units_of(system_, sizes, i * interval_, y, interval_) : StateUnits{});
    if (!advance(system_, y, i * interval_, (i + 1) * interval_, tight, units_.back())) break;
    if (!advance(system_, checked, i * interval_, (i + 1) * interval_, loose, units_.back())) break;
    const double parting = (y - checked).cwiseAbs().maxCoeff();
    largest = std::max(largest, y.cwiseAbs().maxCoeff());
    const StateUnits here = sizes_of(system_, y);
    sizes = {std::max(sizes.positions, here.positions), std::max(sizes.others, here.others)};
    if (!(parting <= largest_parting * largest)) break;
    difference = std::max(difference, parting);
    grid_.push_back(y);
  }
  error_bound_ = difference + largest * std::numeric_limits<double>::epsilon();
}

double FormulaReference::valid_until() const { return static_cast<double>(grid_.size() - 1) * interval_; }

Eigen::VectorXd FormulaReference::at(double t) const {
  Eigen::VectorXd y =
      Eigen::VectorXd::Constant(grid_.front().size(), std::numeric_limits<double>::quiet_NaN());
  if (!(t >= 0) || t > valid_until() + interval_ * 1e-6) return y;
  const auto i = std::min(static_cast<std::size_t>(t / interval_), grid_.size() - 1);
  const double start = static_cast<double>(i) * interval_;
  y = grid_[i];
  if (t > start) advance(system_, y, start, t, tight, units_[std::min(i, units_.size() - 1)]);
  return y;
}

std::string FormulaReference::name() {
#if HMAX_HAVE_BOOST
  return "Boost.Odeint bulirsch_stoer, tolerance 1e-13";
#else
  return "dop_853, tolerance 1e-13 (Boost.Odeint is missing, so this reference is not independent)";
#endif
}

}  // namespace hmax
