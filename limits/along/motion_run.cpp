#include "limits/along/motion_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "analysis/dynamics/growth.hpp"
#include "catalogue/methods/bind.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/inversion.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "integrators/explicit/adaptive.hpp"
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// The largest position and the largest velocity; of problems that are not mechanical the largest state
/// twice.
struct Sizes {
  double positions = 0, velocities = 0;

  void include(const Sizes& other) {
    positions = std::max(positions, other.positions);
    velocities = std::max(velocities, other.velocities);
  }
};

Sizes sizes_of(const Eigen::Ref<const Eigen::VectorXd>& y, bool mechanical) {
  if (!mechanical) {
    const double size = y.lpNorm<Eigen::Infinity>();
    return {size, size};
  }
  const Eigen::Index n = y.size() / 2;
  return {y.head(n).lpNorm<Eigen::Infinity>(), y.tail(y.size() - n).lpNorm<Eigen::Infinity>()};
}

/// y' at y0, the largest at some times of the run: a load may begin later.
Sizes rates_at_start(const Problem& problem, double t_end, bool mechanical) {
  constexpr int instants = 64;
  Sizes rates;
  for (int i = 0; i < instants; ++i)
    if (const Eigen::VectorXd f = rhs_of(problem, t_end * (0.37 + i) / instants, problem.y0); f.allFinite())
      rates.include(sizes_of(f, mechanical));
  return rates;
}

/// What is known of the sizes before the first run; 0 where nothing moves.
Sizes guessed_sizes(const Problem& problem, double t_end, bool mechanical) {
  Sizes sizes = sizes_of(problem.y0, mechanical);
  if (sizes.positions > 0 && sizes.velocities > 0) return sizes;
  const Sizes rates = rates_at_start(problem, t_end, mechanical);
  if (!(sizes.velocities > 0)) sizes.velocities = t_end * rates.velocities;
  if (!(sizes.positions > 0)) sizes.positions = mechanical ? t_end * sizes.velocities : sizes.velocities;
  return sizes;
}

/// A run by dormand_prince_54 that is told how exact it has to be.
RunEnd<double> run_motion(const Problem& problem, const MotionTolerances& tolerances, double t_end,
                          double every, const Sink& show) {
  return std::visit(
      [&]<class Sys>(const Sys& system) {
        using State = typename Sys::State;
        using Method = tableaux::DormandPrince54;
        const Span<double> span{0, t_end};
        State y(problem.y0);
        Eigen::VectorXd atol = Eigen::VectorXd::Constant(y.size(), tolerances.atol);
        if (tolerances.has_velocities) atol.tail(y.size() / 2).setConstant(tolerances.atol_velocities);
        AnyObserver<State> observer(span, every, y, [&](double t, const State& at) { show(t, at); });
        return integrate(ExplicitRk<StaticCoefficients<Method>, State>(StaticCoefficients<Method>{}), system,
                         span, y,
                         adaptive<Method, DeadbandController>(
                             ComponentTolerances<double>{.rtol = tolerances.rtol, .atol = std::move(atol)}),
                         observer, most_observed_steps);
      },
      problem.system);
}

/// Tolerances of shares of sizes; where nothing moves any will do.
MotionTolerances shares_of(const Sizes& sizes, Tolerances<double> shares, bool mechanical) {
  constexpr double least = 1e-290, most = 1e290;
  const auto of = [&](double size) { return std::clamp(shares.atol * (size > 0 ? size : 1), least, most); };
  return {.rtol = shares.rtol,
          .atol = of(sizes.positions),
          .atol_velocities = of(sizes.velocities),
          .has_velocities = mechanical};
}

std::string_view words_of(Outcome outcome) {
  if (outcome == Outcome::diverged) return "its state is not finite";
  return outcome == Outcome::step_too_small ? "its steps become too short" : "it takes too many steps";
}

/// @throws InputError  because a motion does not reach its end
[[noreturn]] void refuse(const Problem& problem, double t_end, const RunEnd<double>& end) {
  throw input_error("the motion of {} does not reach t = {} s: {} at t = {} s; take a shorter --t-end",
                    problem.id, to_text(problem.shown.time(t_end)), words_of(end.outcome),
                    short_number(problem.shown.time(end.t)));
}

/// The sizes that a crude run sees, as far as it comes, of a body until an element is turned inside out.
/// @throws InputError  where that takes too many steps, of which an exact run takes more
Sizes seen_sizes(const Problem& problem, const Sizes& guess, double t_end, const Watcher& watcher,
                 bool mechanical) {
  struct Inverted {};
  constexpr Tolerances<double> crude{1e-4, 1e-6};
  Sizes seen;
  try {
    const RunEnd<double> end = run_motion(problem, shares_of(guess, crude, mechanical), t_end, 0,
                                          [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
                                            if (watcher) watcher();
                                            if (inversion_at(problem, t, y)) throw Inverted{};
                                            if (y.allFinite()) seen.include(sizes_of(y, mechanical));
                                          });
    if (end.outcome == Outcome::too_many_steps) refuse(problem, t_end, end);
  } catch (const Inverted&) {
  }
  return seen;
}

bool is_far(double guess, double seen) {
  constexpr double far = 1e3;
  return seen > 0 && !(guess <= far * seen && seen <= far * guess);
}

}  // namespace

MotionTolerances motion_tolerances(const Problem& problem, double t_end, const Watcher& watcher) {
  if (!(t_end > 0) && (problem.shown.t0 != 0 || problem.shown.direction < 0))
    throw input_error(
        "the end time {} does not lie behind the start t = {} of the motion, which goes {}; "
        "give another --t-end",
        to_text(problem.shown.time(t_end)), to_text(problem.shown.t0),
        problem.shown.direction < 0 ? "back in time" : "forward");
  check({.t_end = t_end, .adaptive = true, .rtol = motion_shares.rtol, .atol = motion_shares.atol},
        find_method("dormand_prince_54"), problem);
  const bool mechanical = is_second_order(problem);
  const Sizes guess = guessed_sizes(problem, t_end, mechanical);
  Sizes seen = seen_sizes(problem, guess, t_end, watcher, mechanical);
  if (is_far(guess.positions, seen.positions) || is_far(guess.velocities, seen.velocities))
    seen = seen_sizes(problem, seen, t_end, watcher, mechanical);
  constexpr double most_growth = 1e6;
  const Sizes start = sizes_of(problem.y0, mechanical);
  double growth = std::numeric_limits<double>::infinity();
  if (start.positions > 0) growth = seen.positions / start.positions;
  if (start.velocities > 0) growth = std::min(growth, seen.velocities / start.velocities);
  if (std::isfinite(growth) && growth > most_growth) {
    seen.positions *= most_growth / growth;
    seen.velocities *= most_growth / growth;
  }
  return shares_of(seen, motion_shares, mechanical);
}

std::int64_t show_motion(const Problem& problem, const MotionTolerances& tolerances, double t_end, int points,
                         const Watcher& watcher, const Sink& show) {
  const RunEnd<double> end = run_motion(problem, tolerances, t_end, points > 0 ? t_end / points : 0,
                                        [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
                                          if (watcher) watcher();
                                          show(t, y);
                                        });
  if (end.outcome != Outcome::reached_end) refuse(problem, t_end, end);
  return end.stats.steps;
}

std::string in_words(const MotionTolerances& tolerances) {
  std::string words = fmt::format("rtol {}, atol {:.3g}", to_text(tolerances.rtol), tolerances.atol);
  if (tolerances.has_velocities)
    words += fmt::format(" of positions and {:.3g} of velocities", tolerances.atol_velocities);
  return words;
}

}  // namespace hmax
