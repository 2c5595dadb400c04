#include "analysis/dynamics/oscillator_lanes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "analysis/dynamics/oscillator_steps.hpp"
#include "core/instructions/compiled_for.hpp"
#include "core/instructions/cosines.hpp"
#include "integrators/state.hpp"

namespace hmax {

namespace {

using Eigen::Vector2d;

/// Four registers of the widest kind for each number, so that additions of some fill the latency of others.
constexpr std::size_t lane_count = 32;

// ---- adaptive steps, each lane at its own time

struct OwnTimes {
  AdaptiveLanes<lane_count> lanes;
  InstructionSet set;
  bool steady;
};

[[gnu::always_inline]] inline void attempt_all(OwnTimes& own) {
  attempt(own.lanes, own.steady, [&](std::size_t count, const auto& angles, auto& out) {
    cosines(std::span(angles).first(count), out, own.set);
  });
}

/// The loop over time of all runs.
class AdaptiveRuns {
 public:
  AdaptiveRuns(const RunClient& client, const AdaptiveSteps& steps, InstructionSet set)
      : client_(client), steps_(steps), attempt_(CompiledFor<attempt_all>::of(set)) {
    if (steps.arrival) rule_ = steps.arrival->rule();
    own_.lanes.norm = {steps.tolerances.rtol, steps.tolerances.atol};
    own_.set = set;
    own_.steady = steps.steady;
  }

  void run() {
    while (fill(), used_ > 0 && !steps_.are_interrupted()) {
      lanes_.rk.use(used_);
      attempt_(own_);
      // Backwards, so that a lane that is moved has been judged.
      for (std::size_t lane = used_; lane-- > 0;) judge(lane);
    }
  }

 private:
  struct Lane {
    OscillatorRun* run;
    AdaptiveMotion motion;
  };

  /// A step for every lane, as far as there are runs.
  void fill() {
    for (std::size_t lane = 0; lane < used_; ++lane) propose(lane);
    while (used_ < lane_count && begin(used_)) propose(used_++);
  }

  void put(std::size_t lane, const Oscillator& system) {
    lanes_.oscillators.set(lane, OscillatorRates::of(system));
    if (own_.steady) lanes_.forces[lane] = system.at(0);
  }

  /// The next run, from its start.
  bool begin(std::size_t lane) {
    while (OscillatorRun* run = client_.next()) {
      run->outcome = Outcome::diverged;
      if (!is_bounded(run->y)) {
        client_.ended(*run);
        continue;
      }
      Vector2d slope;
      run->system->rhs(0, run->y, slope);
      lanes_.rk.start(lane, run->y, slope);
      put(lane, *run->system);
      under_way_[lane].emplace(
          Lane{run, AdaptiveMotion(steps_.tolerances, *run->system, {0, run->t_end}, run->t_end, run->y)});
      return true;
    }
    return false;
  }

  void end(std::size_t lane, const Vector2d& y) {
    OscillatorRun& run = *under_way_[lane]->run;
    run.outcome = under_way_[lane]->motion.outcome();
    run.attempts = under_way_[lane]->motion.attempts();
    run.y = y;
    client_.ended(run);
    if (begin(lane) || --used_ == lane) return;
    under_way_[lane] = under_way_[used_];
    lanes_.rk.move(used_, lane);
    put(lane, *under_way_[lane]->run->system);
  }

  /// The next step of a lane; a run that has none ends.
  void propose(std::size_t lane) {
    while (lane < used_) {
      AdaptiveMotion& motion = under_way_[lane]->motion;
      if (motion.propose(steps_.most_attempts)) return lanes_.rk.set_step(lane, motion.t(), motion.h());
      end(lane, lanes_.rk.state(lane));
    }
  }

  /// What becomes of the attempt of a lane.
  void judge(std::size_t lane) {
    AdaptiveMotion& motion = under_way_[lane]->motion;
    const Vector2d there = lanes_.rk.candidate(lane);
    const bool is_new = motion.judge(lanes_.rk.error_squared(lane), there,
                                     [&](const Vector2d& y) { return rule_ && rule_->of(y) != undecided; });
    if (motion.has_ended()) return end(lane, is_new ? there : lanes_.rk.state(lane));
    if (is_new) lanes_.rk.accept(lane);
  }

  const RunClient& client_;
  const AdaptiveSteps& steps_;
  std::optional<FateRule> rule_;
  std::size_t used_ = 0;  ///< lanes, from the first, that have runs
  void (*attempt_)(OwnTimes&);
  OwnTimes own_;
  AdaptiveLanes<lane_count>& lanes_ = own_.lanes;
  std::array<std::optional<Lane>, lane_count> under_way_;
};

// ---- formulas, one motion after the other: their operations are no vector operations

constexpr std::int64_t to_the_end = std::numeric_limits<std::int64_t>::max();

/// take(run, rk, slope) of all runs, from the start that stands in `rk`: slope(t, y, dydt).
template <class Method, class Take>
void take_formulas(const RunClient& client, const Take& take) {
  while (OscillatorRun* const run = client.next()) {
    run->outcome = Outcome::diverged;
    if (is_bounded(run->y)) {
      const PlanarFormulas& system = run->piece->system;
      LaneRk<Method, 1> rk;
      Vector2d slope;
      system.rhs(run->piece->span.t0, run->y, slope);
      rk.start(0, run->y, slope);
      take(*run, rk, [&](double t, const double* y, double* dydt) {
        system.program->run(std::clamp(t, system.from, system.to), y, dydt);
      });
      run->y = rk.state(0);
    }
    client.ended(*run);
  }
}

void run_formulas_of(const RunClient& client, const AdaptiveSteps& steps) {
  const RmsNorm<double> norm{steps.tolerances.rtol, steps.tolerances.atol};
  std::optional<FateRule> rule;
  if (steps.arrival) rule = steps.arrival->rule();
  take_formulas<tableaux::Dop853>(client, [&](OscillatorRun& run, auto& rk, const auto& slope) {
    const FormulaPiece& piece = *run.piece;
    AdaptiveMotion motion(steps.tolerances, piece.system, piece.span, piece.whole, run.y, run.attempts);
    go_on(
        motion, rk, to_the_end, steps.most_attempts,
        [&](const Vector2d& y) { return rule && rule->of(y) != undecided; },
        [&] {
          attempt(rk, slope);
          rk.weigh(norm);
          return !steps.are_interrupted();
        });
    run.outcome = motion.outcome();
    run.attempts = motion.attempts();
  });
}

template <class Method>
void run_steps_of_formulas(const RunClient& client) {
  take_formulas<Method>(client, [](OscillatorRun& run, auto& rk, const auto& slope) {
    FixedTimes times(run.t_end, run.h);
    const bool bounded = go_on(times, rk, to_the_end, [&] {
      attempt(rk, slope);
      return true;
    });
    if (bounded) run.outcome = Outcome::reached_end;
  });
}

// ---- fixed steps, all lanes at one time

template <class Method>
[[gnu::always_inline]] inline void advance_all(SharedLanes<Method, lane_count>& lanes,
                                               std::span<const SharedStep<Method>> steps) {
  advance(lanes, steps);
}

/// As many runs as there are lanes begin and end together.
template <class Method>
void run_shared(const RunClient& client, std::span<const SharedStep<Method>> steps, InstructionSet set) {
  SharedLanes<Method, lane_count> lanes;
  std::array<OscillatorRun*, lane_count> runs{};
  for (;;) {
    std::size_t count = 0;
    while (count < lane_count && (runs[count] = client.next())) ++count;
    if (count == 0) return;
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      // Beside the runs copies are made, which nobody looks at: what has been there before could have become
      // subnormal, and slow.
      const OscillatorRun& run = *runs[lane < count ? lane : 0];
      const Vector2d start = is_bounded(run.y) ? run.y : Vector2d::Zero();
      Vector2d slope;
      run.system->rhs(0, start, slope);
      lanes.rk.start(lane, start, slope);
      lanes.oscillators.set(lane, OscillatorRates::of(*run.system));
      lanes.bounded[lane] = is_bounded(run.y) ? 1 : 0;
    }
    lanes.rk.use(count);
    CompiledFor<advance_all<Method>>::of(set)(lanes, steps);
    for (std::size_t lane = 0; lane < count; ++lane) {
      if (is_bounded(runs[lane]->y)) runs[lane]->y = lanes.rk.state(lane);
      runs[lane]->outcome = lanes.bounded[lane] != 0 ? Outcome::reached_end : Outcome::diverged;
      client.ended(*runs[lane]);
    }
  }
}

}  // namespace

MotionRunner in_lanes(InstructionSet set) {
  return {.adaptive = [set](const AdaptiveSteps& steps) -> RunMotions {
            return [steps, set](const RunClient& client) { AdaptiveRuns(client, steps, set).run(); };
          },
          .shared =
              [set](const SharedSteps& asked) {
                RunMotions found;
                with_explicit_method(asked.method, [&]<class Method>(const Method&) {
                  found = [steps = shared_steps<Method>(asked.w, asked.t_end, asked.h),
                           set](const RunClient& client) { run_shared<Method>(client, steps, set); };
                });
                return found;
              },
          .formulas = [](const AdaptiveSteps& steps, const FormulaPrograms&) -> RunMotions {
            return [steps](const RunClient& client) { run_formulas_of(client, steps); };
          },
          .formula_steps =
              [](std::string_view method, const FormulaPrograms&) {
                RunMotions found;
                with_explicit_method(
                    method, [&]<class Method>(const Method&) { found = run_steps_of_formulas<Method>; });
                return found;
              }};
}

}  // namespace hmax
