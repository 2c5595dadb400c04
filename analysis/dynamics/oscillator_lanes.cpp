#include "analysis/dynamics/oscillator_lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <vector>

#include "analysis/dynamics/lane_rk.hpp"
#include "core/instructions/compiled_for.hpp"
#include "core/instructions/cosines.hpp"
#include "integrators/control.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/state.hpp"

namespace hmax {

namespace {

using Eigen::Vector2d;

/// Four registers of the widest kind for each number, so that additions of some fill the latency of others.
constexpr std::size_t lane_count = 32;

/// What Oscillator computes, of a different one in each lane.
class Systems {
 public:
  void set(std::size_t lane, const Oscillator& system) {
    const OscillatorParameters& p = system.parameters();
    c_m_[lane] = p.c / p.m;
    k1_m_[lane] = p.k1 / p.m;
    k3_m_[lane] = p.k3 / p.m;
    P_m_[lane] = p.P / p.m;
    w_[lane] = p.w;
  }

  /// w t, whose cosine force() takes.
  [[gnu::always_inline]] double angle(std::size_t lane, double t) const { return w_[lane] * t; }
  /// Oscillator::at() of a lane.
  [[gnu::always_inline]] double force(std::size_t lane, double cosine) const {
    const double force = P_m_[lane] * cosine;
    return P_m_[lane] != 0 ? force : 0.0;  // no -0 where no force is
  }
  /// Oscillator::rhs_at() of a lane: x' = v, v' = (force - x (k1 + k3 x^2) / m) - c v / m.
  [[gnu::always_inline]] void rhs_at(std::size_t lane, double force, const Vector2d& y,
                                     Vector2d& dydt) const {
    const double x = y[0], v = y[1];
    dydt[0] = v;
    dydt[1] = (force - x * (k1_m_[lane] + k3_m_[lane] * (x * x))) - c_m_[lane] * v;
  }

 private:
  alignas(64) std::array<double, lane_count> c_m_{}, k1_m_{}, k3_m_{}, P_m_{}, w_{};
};

// ---- adaptive steps, each lane at its own time

using Coefficients = StaticCoefficients<tableaux::Dop853>;

/// The place of each stage among the different times c_i, i > 0, of a step; their number at last.
constexpr auto node_of_stage = [] {
  std::array<std::size_t, Coefficients::stages() + 1> place{};
  std::size_t& count = place[Coefficients::stages()];
  for (std::size_t i = 1; i < Coefficients::stages(); ++i)
    place[i] = Coefficients::first_at_node_of(i) == i ? count++ : place[Coefficients::first_at_node_of(i)];
  return place;
}();
constexpr std::size_t nodes = node_of_stage.back();

struct AdaptiveLanes {
  LaneRk<tableaux::Dop853, lane_count> rk;
  Systems systems;
  RmsNorm<double> norm;
  InstructionSet set;
  bool steady;  ///< no force changes in time
  /// [node][lane]: w t, then its cosine and the force; [lane] alone where forces are steady.
  alignas(64) std::array<double, nodes * lane_count> angles{}, forces{};
};

[[gnu::always_inline]] inline void attempt(AdaptiveLanes& lanes) {
  const std::size_t used = lanes.rk.used(), stride = lanes.steady ? 0 : used;
  if (!lanes.steady) {
    Coefficients::for_each_later_stage([&](auto i) __attribute__((always_inline)) {
      if constexpr (Coefficients::first_at_node_of(i) == i)
        for (std::size_t lane = 0; lane < used; ++lane)
          lanes.angles[node_of_stage[i] * used + lane] =
              lanes.systems.angle(lane, lanes.rk.stage_time(i, lane));
    });
    cosines(std::span(lanes.angles).first(nodes * used), lanes.forces, lanes.set);
    for (std::size_t node = 0; node < nodes; ++node)
      for (std::size_t lane = 0; lane < used; ++lane)
        lanes.forces[node * used + lane] = lanes.systems.force(lane, lanes.forces[node * used + lane]);
  }
  lanes.rk.attempt([&](auto i, std::size_t lane, const Vector2d& y, Vector2d& dydt)
                       __attribute__((always_inline)) {
                         lanes.systems.rhs_at(lane, lanes.forces[node_of_stage[i] * stride + lane], y, dydt);
                       });
  lanes.rk.weigh(lanes.norm);
}

/// The loop over time of all runs.
class AdaptiveRuns {
 public:
  AdaptiveRuns(const LaneClient& client, const Tolerances<double>& tolerances, std::int64_t most_attempts,
               bool steady, InstructionSet set)
      : client_(client),
        tolerances_(tolerances),
        most_attempts_(most_attempts),
        attempt_(CompiledFor<attempt>::of(set)) {
    lanes_.norm = {tolerances.rtol, tolerances.atol};
    lanes_.set = set;
    lanes_.steady = steady;
  }

  void run() {
    while (fill(), used_ > 0) {
      lanes_.rk.use(used_);
      attempt_(lanes_);
      // Backwards, so that a lane that is moved has been judged.
      for (std::size_t lane = used_; lane-- > 0;) judge(lane);
    }
  }

 private:
  struct Lane {
    OscillatorRun* run;
    Adaptive<double, DeadbandController> control;
    Proposal<double> step{};
    double t = 0;
    std::int64_t attempts = 0;
  };

  /// The error of one lane, as a control asks a stepper for it.
  struct LaneError {
    double squared;
    template <class Norm>
    double error_squared(double /*h*/, const Vector2d& /*y*/, const Vector2d& /*y_new*/,
                         const Norm& /*norm*/) const {
      return squared;
    }
  };

  /// A step for every lane, as far as there are runs.
  void fill() {
    for (std::size_t lane = 0; lane < used_; ++lane) propose(lane);
    while (used_ < lane_count && begin(used_)) propose(used_++);
  }

  void put(std::size_t lane, const Oscillator& system) {
    lanes_.systems.set(lane, system);
    if (lanes_.steady) lanes_.forces[lane] = system.at(0);
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
      Lane& begun = under_way_[lane].emplace(Lane{run, Control(tolerances_, tableaux::Dop853::error_order)});
      begun.control.start(lanes_.rk, *run->system, {0, run->t_end}, run->y);
      return true;
    }
    return false;
  }

  void end(std::size_t lane, Outcome outcome, const Vector2d& y) {
    OscillatorRun& run = *under_way_[lane]->run;
    run.outcome = outcome;
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
      Lane& run = *under_way_[lane];
      run.step = run.control.propose(run.t);
      if (run.attempts++ == most_attempts_) {
        end(lane, Outcome::too_many_steps, lanes_.rk.state(lane));
      } else if (run.step.t_next == run.t) {
        end(lane, Outcome::step_too_small, lanes_.rk.state(lane));
      } else {
        lanes_.rk.set_step(lane, run.t, run.step.h);
        return;
      }
    }
  }

  /// What becomes of the attempt of a lane.
  void judge(std::size_t lane) {
    Lane& run = *under_way_[lane];
    const Vector2d there = lanes_.rk.candidate(lane);
    const Judgement judgement =
        run.control.judge(LaneError{lanes_.rk.error_squared(lane)}, *run.run->system, run.step, there, there);
    if (judgement == Judgement::retry) return;
    if (judgement == Judgement::give_up) return end(lane, Outcome::step_too_small, lanes_.rk.state(lane));
    if (!is_bounded(there)) return end(lane, Outcome::diverged, lanes_.rk.state(lane));
    if (client_.is_over && client_.is_over(*run.run, there)) return end(lane, Outcome::stopped, there);
    if (run.step.last) return end(lane, Outcome::reached_end, there);
    lanes_.rk.accept(lane);
    run.t = run.step.t_next;
  }

  using Control = Adaptive<double, DeadbandController>;
  const LaneClient& client_;
  std::size_t used_ = 0;  ///< lanes, from the first, that have runs
  Tolerances<double> tolerances_;
  std::int64_t most_attempts_;
  void (*attempt_)(AdaptiveLanes&);
  AdaptiveLanes lanes_;
  std::array<std::optional<Lane>, lane_count> under_way_;
};

// ---- fixed steps, all lanes at one time

/// A step of all lanes: its size and cos(w t) at each stage.
template <class Method>
struct SharedStep {
  double h;
  std::array<double, Method::tableau.stages> cosine;
};

/// Those that ExplicitRk takes with FixedStep.
template <class Method>
std::vector<SharedStep<Method>> steps_of(double w, double t_end, double h) {
  using Tableau = StaticCoefficients<Method>;
  std::vector<SharedStep<Method>> steps;
  FixedStep<double> control(h);
  control.start(0, Oscillator(), Span<double>{0, t_end}, Vector2d());
  double t = 0;
  // The first stage of a step takes the force from the end of the step before where a stage stands there.
  double first = std::cos(w * t);
  for (bool last = false; !last;) {
    const Proposal<double> next = control.propose(t);
    SharedStep<Method>& step = steps.emplace_back(SharedStep<Method>{next.h, {}});
    step.cosine[0] = first;
    for (std::size_t i = 1; i < step.cosine.size(); ++i)
      step.cosine[i] = std::cos(w * (t + static_cast<double>(Tableau::node(i)) * next.h));
    control.judge(0, Oscillator(), next, Vector2d(), Vector2d());
    t = next.t_next;
    last = next.last;
    constexpr std::size_t at_end = Tableau::first_at_end();
    first = at_end < step.cosine.size() ? step.cosine[at_end] : std::cos(w * t);
  }
  return steps;
}

template <class Method>
struct SharedLanes {
  LaneRk<Method, lane_count> rk;
  Systems systems;
  alignas(64) std::array<double, lane_count> bounded;  ///< 1 while every state has been, else 0
};

template <class Method>
[[gnu::always_inline]] inline void advance(SharedLanes<Method>& lanes,
                                           std::span<const SharedStep<Method>> steps) {
  const std::size_t used = lanes.rk.used();
  for (const SharedStep<Method>& step : steps) {
    for (std::size_t lane = 0; lane < used; ++lane) lanes.rk.set_step(lane, 0, step.h);
    lanes.rk.attempt([&](auto i, std::size_t lane, const Vector2d& y, Vector2d& dydt) __attribute__((
        always_inline)) { lanes.systems.rhs_at(lane, lanes.systems.force(lane, step.cosine[i]), y, dydt); });
    for (std::size_t lane = 0; lane < used; ++lane) {
      lanes.bounded[lane] = is_bounded(lanes.rk.candidate(lane)) ? lanes.bounded[lane] : 0;
      lanes.rk.accept(lane);
    }
  }
}

/// As many runs as there are lanes begin and end together.
template <class Method>
void run_shared(std::span<OscillatorRun> runs, std::span<const SharedStep<Method>> steps,
                InstructionSet set) {
  SharedLanes<Method> lanes;
  for (std::size_t begun = 0; begun < runs.size(); begun += lane_count) {
    const auto some = runs.subspan(begun, std::min(lane_count, runs.size() - begun));
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      // Beside the runs copies are made, which nobody looks at: what has been there before could have become
      // subnormal, and slow.
      const OscillatorRun& run = some[lane < some.size() ? lane : 0];
      const Vector2d start = is_bounded(run.y) ? run.y : Vector2d::Zero();
      Vector2d slope;
      run.system->rhs(0, start, slope);
      lanes.rk.start(lane, start, slope);
      lanes.systems.set(lane, *run.system);
      lanes.bounded[lane] = is_bounded(run.y) ? 1 : 0;
    }
    lanes.rk.use(some.size());
    CompiledFor<advance<Method>>::of(set)(lanes, steps);
    for (std::size_t lane = 0; lane < some.size(); ++lane) {
      some[lane].y = lanes.rk.state(lane);
      some[lane].outcome = lanes.bounded[lane] != 0 ? Outcome::reached_end : Outcome::diverged;
    }
  }
}

}  // namespace

void run_side_by_side(const LaneClient& client, const Tolerances<double>& tolerances,
                      std::int64_t most_attempts, bool steady, InstructionSet set) {
  AdaptiveRuns(client, tolerances, most_attempts, steady, set).run();
}

SharedSteps shared_steps(std::string_view method, double w, double t_end, double h, InstructionSet set) {
  SharedSteps found;
  const auto try_method = [&]<class Method>(const Method&) {
    if (Method::id == method)
      found = [steps = steps_of<Method>(w, t_end, h), set](std::span<OscillatorRun> runs) {
        run_shared<Method>(runs, steps, set);
      };
  };
  std::apply([&](const auto&... each) { (try_method(each), ...); }, tableaux::All{});
  return found;
}

}  // namespace hmax
