/// The fates of starts in the plane, one by one or many side by side.
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "analysis/dynamics/oscillator_lanes.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/planar.hpp"
#include "integrators/state.hpp"

namespace hmax {

namespace {

using Eigen::Vector2d;

/// Ends a run from inside.
struct Left {};

/// When a motion has found its fate.
struct Destiny {
  std::vector<std::pair<int, Trap>> traps;  ///< by the number of the equilibrium
  Window window;
  double longest;  ///< time after which a motion is undecided [s]

  Destiny(const Problem& problem, const Window& seen, const std::vector<Equilibrium>& equilibria)
      : window(seen), longest(problem.t_end) {
    const PlanarField field = planar_field(problem, 0, window.size());
    for (std::size_t i = 0; i < equilibria.size(); ++i) {
      const Equilibrium& e = equilibria[i];
      if (e.type != EquilibriumType::stable_node && e.type != EquilibriumType::stable_focus) continue;
      traps.emplace_back(static_cast<int>(i), Trap(e.state, field.jacobian(e.state), window.size()));
      longest = std::max(longest, 20 * std::log(1e3) / -e.eigenvalues[0].real());
    }
  }

  /// Undecided while the motion has to go on.
  [[nodiscard]] int of(const Vector2d& here) const {
    int fate = undecided;
    for (const auto& [number, trap] : traps)
      if (trap.holds(here)) fate = number;
    const auto away = (here - window.lower).cwiseAbs().array();
    if (!(away < 1e6 * window.size().array()).all()) fate = unbounded;
    return fate;
  }
};

}  // namespace

std::function<int(const Vector2d&)> fate_of_starts(const Problem& problem, const Window& window,
                                                   const std::vector<Equilibrium>& equilibria) {
  const Destiny destiny(problem, window, equilibria);
  const Method method = find_method(problem.stiff ? "radau_iia_5" : "dop_853");
  const RunSpec spec{.t_end = destiny.longest,
                     .adaptive = true,
                     .rtol = basin_tolerances.rtol,
                     .atol = basin_tolerances.atol,
                     .max_steps = adaptive_attempts};
  return [=, own = std::make_shared<Problem>(problem)](const Vector2d& start) -> int {
    int fate = undecided;
    own->y0 = start;
    try {
      const RunRecord record = method.bind(*own).run(spec, [&](double, const auto& y) {
        fate = destiny.of(y);
        if (fate != undecided) throw Left{};
      });
      if (record.outcome == Outcome::diverged || record.outcome == Outcome::step_too_small) return unbounded;
    } catch (const Left&) {
    }
    return fate;
  };
}

FatesOf fates_of_starts(const Problem& problem, const Window& window,
                        const std::vector<Equilibrium>& equilibria, InstructionSet set) {
  const auto* oscillator = std::get_if<Oscillator>(&problem.system);
  if (!oscillator || problem.stiff || is_driven(problem))
    return [fate_of = fate_of_starts(problem, window, equilibria)](std::span<const Vector2d> starts,
                                                                   std::span<int> fates) {
      std::ranges::transform(starts, fates.begin(), fate_of);
    };
  return [system = *oscillator, destiny = Destiny(problem, window, equilibria), set](
             std::span<const Vector2d> starts, std::span<int> fates) {
    std::vector<OscillatorRun> runs(starts.size());
    std::size_t begun = 0;
    const auto fate = [&](const OscillatorRun& run) -> int& {
      return fates[std::size_t(&run - runs.data())];
    };
    const LaneClient client{
        .next = [&]() -> OscillatorRun* {
          for (; begun < starts.size(); ++begun) {
            const Vector2d& y = starts[begun];
            fates[begun] = is_bounded(y) ? destiny.of(y) : unbounded;
            if (fates[begun] != undecided) continue;
            runs[begun] = {&system, destiny.longest, y};
            return &runs[begun++];
          }
          return nullptr;
        },
        .ended =
            [&](OscillatorRun& run) {
              if (run.outcome == Outcome::diverged || run.outcome == Outcome::step_too_small)
                fate(run) = unbounded;
            },
        .is_over = [&](const OscillatorRun& run,
                       const Vector2d& y) { return (fate(run) = destiny.of(y)) != undecided; }};
    run_side_by_side(client, basin_tolerances, adaptive_attempts, true, set);
  };
}

}  // namespace hmax
