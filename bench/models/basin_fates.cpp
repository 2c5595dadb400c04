/// The fates of starts in the plane, one by one or many side by side.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>

#include "bench/catalogue/catalogue.hpp"
#include "bench/models/planar.hpp"
#include "integrators/control.hpp"
#include "integrators/ensemble/lane_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"

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
    if (!((here - window.lower).cwiseQuotient(window.size()).cwiseAbs().maxCoeff() < 1e6)) fate = unbounded;
    return fate;
  }
};

/// So many runs side by side: four registers of the widest kind for each number.
using Lanes = LaneRk<tableaux::Dop853, Oscillator, 32>;
using Norm = RmsNorm<double>;
using Attempt = void (*)(Lanes&, const Oscillator&, const Norm&);

// The attribute compiles these bodies alone, with all they call, for their instruction set: inline functions
// that other code shares keep the instructions that every processor has.
[[gnu::flatten]] void attempt_portable(Lanes& lanes, const Oscillator& system, const Norm& norm) {
  lanes.attempt(system, norm);
}
#ifdef __x86_64__
[[gnu::flatten, gnu::target("avx2")]] void attempt_avx2(Lanes& lanes, const Oscillator& system,
                                                        const Norm& norm) {
  lanes.attempt(system, norm);
}
[[gnu::flatten, gnu::target("avx512f,avx512vl")]] void attempt_avx512(Lanes& lanes, const Oscillator& system,
                                                                      const Norm& norm) {
  lanes.attempt(system, norm);
}
#endif

Attempt attempt_of([[maybe_unused]] InstructionSet set) {
#ifdef __x86_64__
  if (set == InstructionSet::avx512) return attempt_avx512;
  if (set == InstructionSet::avx2) return attempt_avx2;
#endif
  return attempt_portable;
}

/// The error of one lane, as a control asks a stepper for it.
struct LaneError {
  double squared;
  double error_squared(double /*h*/, const Vector2d& /*y*/, const Vector2d& /*y_new*/,
                       const Norm& /*norm*/) const {
    return squared;
  }
};

/// Runs of many starts: the loop of integrate() with every lane at a step of a run of its own.
class LaneRuns {
 public:
  LaneRuns(const Oscillator& system, const Destiny& destiny, Attempt attempt)
      : system_(system), destiny_(destiny), attempt_(attempt) {}

  void operator()(std::span<const Vector2d> starts, std::span<int> fates) {
    starts_ = starts;
    fates_ = fates;
    next_ = 0;
    for (std::size_t lane = 0; lane < Lanes::lanes; ++lane) begin(lane);
    while (std::ranges::any_of(runs_, [](const auto& run) { return run.has_value(); })) {
      for (std::size_t lane = 0; lane < Lanes::lanes; ++lane) propose(lane);
      attempt_(lanes_, system_, norm);
      for (std::size_t lane = 0; lane < Lanes::lanes; ++lane) judge(lane);
    }
  }

 private:
  using Control = Adaptive<double, DeadbandController>;
  static constexpr Norm norm{basin_tolerances.rtol, basin_tolerances.atol};

  struct Run {
    std::size_t start;  ///< its number
    Control control{basin_tolerances, tableaux::Dop853::error_order};
    Proposal<double> step{};
    double t = 0;
    std::int64_t attempts = 0;
  };

  /// Gives a lane the next start whose fate takes steps, or rest where there is none.
  void begin(std::size_t lane) {
    runs_[lane].reset();
    lanes_.set_step(lane, 0);
    for (; next_ < starts_.size(); ++next_) {
      const Vector2d& y = starts_[next_];
      fates_[next_] = is_bounded(y) ? destiny_.of(y) : unbounded;
      if (fates_[next_] != undecided) continue;
      lanes_.start(system_, lane, y);
      Run& run = runs_[lane].emplace(Run{.start = next_++});
      LaneError none{};
      run.control.start(none, system_, {0, destiny_.longest}, y);
      return;
    }
  }

  void end(std::size_t lane, int fate) {
    fates_[runs_[lane]->start] = fate;  // NOLINT(bugprone-unchecked-optional-access): it runs
    begin(lane);
  }

  /// The next step of a lane; a run that has none ends.
  void propose(std::size_t lane) {
    while (runs_[lane]) {
      Run& run = *runs_[lane];
      run.step = run.control.propose(run.t);
      if (run.attempts++ == adaptive_attempts) {
        end(lane, undecided);
      } else if (run.step.t_next == run.t) {
        end(lane, unbounded);
      } else {
        lanes_.set_step(lane, run.step.h);
        return;
      }
    }
  }

  /// What becomes of the attempt of a lane.
  void judge(std::size_t lane) {
    if (!runs_[lane]) return;
    Run& run = *runs_[lane];
    const Vector2d there = lanes_.candidate(lane);
    const Judgement judgement =
        run.control.judge(LaneError{lanes_.error_squared(lane)}, system_, run.step, there, there);
    if (judgement == Judgement::give_up) return end(lane, unbounded);
    if (judgement == Judgement::retry) return;
    const int fate = is_bounded(there) ? destiny_.of(there) : unbounded;
    if (fate != undecided || run.step.last) return end(lane, fate);
    lanes_.accept(lane);
    run.t = run.step.t_next;
  }

  Oscillator system_;
  Destiny destiny_;
  Attempt attempt_;
  Lanes lanes_;
  std::array<std::optional<Run>, Lanes::lanes> runs_;  ///< nothing in lanes that rest
  std::span<const Vector2d> starts_;
  std::span<int> fates_;
  std::size_t next_ = 0;  ///< the first start that no lane has taken
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
  if (oscillator && !problem.stiff && !is_driven(problem))
    return [runs = std::make_shared<LaneRuns>(*oscillator, Destiny(problem, window, equilibria),
                                              attempt_of(set))](
               std::span<const Vector2d> starts, std::span<int> fates) { (*runs)(starts, fates); };
  return [fate_of = fate_of_starts(problem, window, equilibria)](std::span<const Vector2d> starts,
                                                                 std::span<int> fates) {
    std::ranges::transform(starts, fates.begin(), fate_of);
  };
}

}  // namespace hmax
