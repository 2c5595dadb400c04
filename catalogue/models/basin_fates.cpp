/// The fates of starts in the plane, one by one or many side by side.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <span>

#include "analysis/dynamics/oscillator_lanes.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/planar.hpp"
#include "core/input_error.hpp"
#include "integrators/state.hpp"

namespace hmax {

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Ends a run from inside.
struct Left {};

/// Whether |f(y + z) - 2 f(y + z / 2)| <= slack |z| in each direction, with |z| = 1 in units of r, and both
/// sides in units of `scale`: f is linear there, or piecewise linear with kinks in y, but for terms of at
/// most four times the slack. Those that grow as |z|^p have 1 / (1 - 2^(1 - p)) times: 3.4 of contacts with
/// p = 1.5, 2 of p = 2.
bool is_linear_at(const PlanarField& field, const Vector2d& y, const Vector2d& r, const Vector2d& scale,
                  double slack) {
  constexpr int directions = 64;
  for (int k = 0; k < directions; ++k) {
    const double phi = 2 * std::numbers::pi * (k + 0.5) / directions;
    const Vector2d z = r.cwiseProduct(Vector2d(std::cos(phi), std::sin(phi)));
    const Vector2d other = field.rhs(y + z) - 2 * field.rhs(y + z / 2);
    if (!(other.cwiseQuotient(scale).norm() <= slack * z.cwiseQuotient(scale).norm())) return false;
  }
  return true;
}

/// The trap of a stable equilibrium: of a thousandth of the window, or so much less that what is not linear
/// stays within its slack at every distance from y up to there, and that nothing else at rest is that near.
/// @param share  becomes what is left of that thousandth
Trap trap_of(const PlanarField& field, const std::vector<Equilibrium>& equilibria, const Equilibrium& e,
             const Vector2d& size, double& share) {
  const Vector2d& y = e.state;
  const Matrix2d J = field.jacobian(y);
  const auto trap = [&](const Vector2d& of) { return e.kink ? Trap(y, *e.kink, of) : Trap(y, J, of); };
  const Vector2d scale = e.kink ? Vector2d(1, e.kink->unit) : size;
  const double slack = trap(size).slack();
  // Nearer, rounding of f is more than the slack.
  const Vector2d rounding = 8 * std::numeric_limits<double>::epsilon() * (J.cwiseAbs() * y.cwiseAbs());
  const double seen =
      rounding.cwiseQuotient(scale).norm() / slack / (1e-3 * size).cwiseQuotient(scale).minCoeff();
  share = 1;
  // From the smallest distance upwards: far beyond a wall f is linear again, as at a kink.
  for (double next = std::exp2(std::ceil(std::log2(std::clamp(seen, 1e-6, 1.0)))); next <= 1; next *= 2)
    if (!is_linear_at(field, y, 1e-3 * next * size, scale, slack)) {
      share = next / 2;
      break;
    }
  for (const Equilibrium& other : equilibria) {
    const double distance = (other.state - y).cwiseAbs().cwiseQuotient(1e-3 * size).maxCoeff();
    if (distance > 0) share = std::min(share, distance / 2);
  }
  return trap(share * size);
}

/// When a motion has found its fate.
struct Destiny {
  Arrival arrival;
  double longest;  ///< time after which a motion is undecided [s]

  Destiny(const Problem& problem, const Window& window, const std::vector<Equilibrium>& equilibria)
      : arrival{.traps = {}, .window = window}, longest(problem.t_end) {
    const PlanarField field = planar_field(problem, 0, window.size());
    for (std::size_t i = 0; i < equilibria.size(); ++i) {
      const Equilibrium& e = equilibria[i];
      if (!is_stable(e.type)) continue;
      double share = 1;
      arrival.traps.push_back({static_cast<int>(i), trap_of(field, equilibria, e, window.size(), share)});
      longest = std::max(longest, 20 * std::log(1e3 / share) / -e.eigenvalues[0].real());
    }
  }

  /// Undecided while the motion has to go on.
  [[nodiscard]] int of(const Vector2d& here) const { return arrival.rule().of(here); }
};

}  // namespace

std::function<int(const Vector2d&)> fate_of_starts(const Problem& problem, const Window& window,
                                                   const std::vector<Equilibrium>& equilibria,
                                                   const std::atomic<bool>* interrupted) {
  const Destiny destiny(problem, window, equilibria);
  const Method method = find_method(problem.stiff ? "radau_iia_5" : "dop_853");
  const Tolerances<double> tolerances = tolerances_in(window, basin_tolerances);
  const RunSpec spec{.t_end = destiny.longest,
                     .adaptive = true,
                     .rtol = tolerances.rtol,
                     .atol = tolerances.atol,
                     .max_steps = adaptive_attempts};
  return [=, own = std::make_shared<Problem>(problem)](const Vector2d& start) -> int {
    int fate = undecided;
    own->y0 = start;
    try {
      const RunRecord record = method.bind(*own).run(spec, [&](double, const auto& y) {
        fate = destiny.of(y);
        if (fate != undecided || (interrupted && *interrupted)) throw Left{};
      });
      if (record.outcome == Outcome::diverged) return unbounded;
    } catch (const Left&) {
    }
    return fate;
  };
}

FatesOf fates_of_starts(const Problem& problem, const Window& window,
                        const std::vector<Equilibrium>& equilibria, const MotionRunner& runner,
                        const std::function<void()>& ended) {
  const auto* oscillator = std::get_if<Oscillator>(&problem.system);
  const auto* system = std::get_if<AnySystem>(&problem.system);
  const auto formulas = system ? system->formulas() : nullptr;
  if ((!oscillator && !formulas) || problem.stiff || is_driven(problem)) {
    if (runner.is_device)
      throw input_error(
          "--device gpu finds basins of the oscillators of the liver and of files of formulas, not of {}; leave --device out",
          problem.id);
    return [ended, fate_of = fate_of_starts(problem, window, equilibria, runner.interrupted)](
               std::span<const Vector2d> starts, std::span<int> fates) {
      for (std::size_t i = 0; i < starts.size(); ++i, ended()) fates[i] = fate_of(starts[i]);
    };
  }
  const Destiny destiny(problem, window, equilibria);
  const AdaptiveSteps steps{.tolerances = tolerances_in(window, basin_tolerances),
                            .most_attempts = adaptive_attempts,
                            .steady = true,
                            .arrival = destiny.arrival,
                            .interrupted = runner.interrupted};
  const RunMotions run = oscillator ? runner.adaptive(steps) : runner.formulas(steps, {formulas});
  const std::optional<Oscillator> own = oscillator ? std::optional(*oscillator) : std::nullopt;
  const FormulaPiece piece{
      {formulas, !oscillator && system->is_autonomous()}, {0, destiny.longest}, destiny.longest};
  return [ended, own, piece, destiny, run](std::span<const Vector2d> starts, std::span<int> fates) {
    std::vector<OscillatorRun> runs(starts.size());
    std::ranges::fill(fates, undecided);
    std::size_t begun = 0;
    const auto next = [&]() -> OscillatorRun* {
      for (; begun < starts.size(); ++begun) {
        const Vector2d& y = starts[begun];
        fates[begun] = is_bounded(y) ? destiny.of(y) : unbounded;
        if (fates[begun] != undecided) {
          ended();
          continue;
        }
        runs[begun] = {own ? &*own : nullptr, destiny.longest, y};
        runs[begun].piece = &piece;
        return &runs[begun++];
      }
      return nullptr;
    };
    const auto has_run = [&](const OscillatorRun& each) {
      int& fate = fates[std::size_t(&each - runs.data())];
      if (each.outcome == Outcome::stopped) fate = destiny.of(each.y);
      if (each.outcome == Outcome::diverged) fate = unbounded;
      ended();
    };
    run({next, has_run});
  };
}

}  // namespace hmax
