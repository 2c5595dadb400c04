/// The loop over time for many runs side by side, each in a lane with a step control of its own.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "integrators/control.hpp"
#include "integrators/state.hpp"
#include "integrators/stats.hpp"

namespace hmax {

/// What integrate() does of each run, for as many runs as there are lanes at a time. A lane whose run has
/// ended takes the next one; where there is none it takes that of the last lane, so that those that are left
/// stand side by side.
///
/// The client says what is run:
///   std::optional<Control> begin(lane)   puts the next start into the lane, and its control after start();
///                                        nothing where there is none, maybe until another run has ended
///   void attempt()                       one attempt of every lane in use, with its error
///   bool is_over(lane, y)                of a state that is about to be accepted: whether the run ends there
///   void end(lane, outcome, y)           of a run, with the last state; the lane is free then
///   void move(from, to)                  what the client knows of a lane goes to another one
/// @tparam LanesT   LaneRk
/// @tparam Control  Adaptive
template <class LanesT, class Control>
class LaneRuns {
 public:
  using State = typename LanesT::State;
  using Real = typename LanesT::Real;

  /// @param most_attempts  of a run, after which it ends as too_many_steps
  explicit LaneRuns(std::int64_t most_attempts) : most_attempts_(most_attempts) {}

  /// Until the client has no more starts and every run has ended.
  /// @param system  of the type that every run has; it says which states it admits
  template <class Client, System Sys>
  void operator()(Client& client, LanesT& lanes, const Sys& system) {
    while (fill(client, lanes), used_ > 0) {
      lanes.use(used_);
      client.attempt();
      // Backwards, so that a lane that is moved has been judged.
      for (std::size_t lane = used_; lane-- > 0;) judge(client, lanes, system, lane);
    }
  }

 private:
  struct Run {
    Control control;
    Proposal<Real> step{};
    Real t = 0;
    std::int64_t attempts = 0;
  };

  /// The error of one lane, as a control asks a stepper for it.
  struct LaneError {
    Real squared;
    template <class Norm>
    Real error_squared(Real /*h*/, const State& /*y*/, const State& /*y_new*/, const Norm& /*norm*/) const {
      return squared;
    }
  };

  /// A step for every lane, as far as there are runs.
  template <class Client>
  void fill(Client& client, LanesT& lanes) {
    for (std::size_t lane = 0; lane < used_; ++lane) propose(client, lanes, lane);
    while (used_ < LanesT::lanes && begin(client, used_)) {
      const std::size_t lane = used_++;
      propose(client, lanes, lane);
    }
  }

  template <class Client>
  bool begin(Client& client, std::size_t lane) {
    runs_[lane].reset();
    if (std::optional<Control> control = client.begin(lane)) runs_[lane].emplace(Run{.control = *control});
    return runs_[lane].has_value();
  }

  template <class Client>
  void end(Client& client, LanesT& lanes, std::size_t lane, Outcome outcome, const State& y) {
    client.end(lane, outcome, y);
    if (begin(client, lane) || --used_ == lane) return;
    runs_[lane] = runs_[used_];
    lanes.move(used_, lane);
    client.move(used_, lane);
  }

  /// The next step of a lane; a run that has none ends.
  template <class Client>
  void propose(Client& client, LanesT& lanes, std::size_t lane) {
    while (lane < used_) {
      Run& run = *runs_[lane];
      run.step = run.control.propose(run.t);
      if (run.attempts++ == most_attempts_) {
        end(client, lanes, lane, Outcome::too_many_steps, lanes.state(lane));
      } else if (run.step.t_next == run.t) {
        end(client, lanes, lane, Outcome::step_too_small, lanes.state(lane));
      } else {
        lanes.set_step(lane, run.t, run.step.h);
        return;
      }
    }
  }

  /// What becomes of the attempt of a lane.
  template <class Client, System Sys>
  void judge(Client& client, LanesT& lanes, const Sys& system, std::size_t lane) {
    Run& run = *runs_[lane];
    const State there = lanes.candidate(lane);
    const Judgement judgement =
        run.control.judge(LaneError{lanes.error_squared(lane)}, system, run.step, there, there);
    if (judgement == Judgement::retry) return;
    if (judgement == Judgement::give_up)
      return end(client, lanes, lane, Outcome::step_too_small, lanes.state(lane));
    if (!admits(system, there)) return end(client, lanes, lane, Outcome::diverged, lanes.state(lane));
    if (client.is_over(lane, there)) return end(client, lanes, lane, Outcome::stopped, there);
    if (run.step.last) return end(client, lanes, lane, Outcome::reached_end, there);
    lanes.accept(lane);
    run.t = run.step.t_next;
  }

  std::int64_t most_attempts_;
  std::size_t used_ = 0;  ///< lanes, from the first, that have runs
  std::array<std::optional<Run>, LanesT::lanes> runs_;
};

}  // namespace hmax
