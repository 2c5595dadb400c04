/// Steps of motions of oscillators: one source for the lanes of the processor, N motions at a time, and for
/// the threads of a device, N = 1.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/lane_rk.hpp"
#include "core/instructions/device_code.hpp"
#include "integrators/control.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/state.hpp"
#include "integrators/stepper.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// The numbers of an oscillator that its right-hand side takes.
struct OscillatorRates {
  double c_m, k1_m, k3_m, P_m;  ///< parameters by mass
  double w;                     ///< [rad/s]

  static OscillatorRates of(const Oscillator& system) {
    const OscillatorParameters& p = system.parameters();
    return {p.c / p.m, p.k1 / p.m, p.k3 / p.m, p.P / p.m, p.w};
  }
};

/// What Oscillator computes, of a different one in each lane.
template <std::size_t N>
class LaneOscillators {
 public:
  HMAX_DEVICE void set(std::size_t lane, const OscillatorRates& of) {
    c_m_[lane] = of.c_m;
    k1_m_[lane] = of.k1_m;
    k3_m_[lane] = of.k3_m;
    P_m_[lane] = of.P_m;
    w_[lane] = of.w;
  }

  /// w t, whose cosine force() takes.
  [[gnu::always_inline]] HMAX_DEVICE double angle(std::size_t lane, double t) const { return w_[lane] * t; }
  /// Oscillator::at() of a lane.
  [[gnu::always_inline]] HMAX_DEVICE double force(std::size_t lane, double cosine) const {
    const double force = P_m_[lane] * cosine;
    return P_m_[lane] != 0 ? force : 0.0;  // no -0 where no force is
  }
  /// Oscillator::rhs_at() of a lane: x' = v, v' = (force - x (k1 + k3 x^2) / m) - c v / m.
  [[gnu::always_inline]] HMAX_DEVICE void rhs_at(std::size_t lane, double force, const Eigen::Vector2d& y,
                                                 Eigen::Vector2d& dydt) const {
    const double x = y[0], v = y[1];
    dydt[0] = v;
    dydt[1] = (force - x * (k1_m_[lane] + k3_m_[lane] * (x * x))) - c_m_[lane] * v;
  }

 private:
  alignas(64) std::array<double, N> c_m_{}, k1_m_{}, k3_m_{}, P_m_{}, w_{};
};

// ---- adaptive steps, each motion at its own time

/// What a motion has of its own at adaptive steps of dop_853.
class AdaptiveMotion {
 public:
  using Control = Adaptive<double, DeadbandController>;

  /// @tparam S      a System of the plane
  /// @param span    of the motion or of a piece of it;  @param whole  [s] length of the motion
  /// @param before  attempts of the pieces before
  template <class S>
  AdaptiveMotion(const Tolerances<double>& tolerances, const S& system, Span<double> span, double whole,
                 const Eigen::Vector2d& y, std::int64_t before = 0)
      : control_(tolerances, tableaux::Dop853::error_order), t_(span.t0), attempts_(before) {
    control_.prepare({0, whole});
    control_.start(*this, system, span, y);
  }

  /// The next step; without one the motion has ended. @returns whether there is one
  HMAX_DEVICE bool propose(std::int64_t most_attempts) {
    step_ = control_.propose(t_);
    if (attempts_++ == most_attempts) return end(Outcome::too_many_steps);
    if (step_.t_next == t_) return end(Outcome::step_too_small);
    return true;
  }

  /// What becomes of an attempt: whether its candidate is the new state.
  /// @param is_over  is_over(y): whether a motion ends, as `stopped`, at a state that is about to be accepted
  template <class IsOver>
  HMAX_DEVICE bool judge(double error_squared, const Eigen::Vector2d& candidate, const IsOver& is_over) {
    const Judgement judgement = control_.judge(LaneError{error_squared}, 0, step_, candidate, candidate);
    if (judgement == Judgement::retry) return false;
    if (judgement == Judgement::give_up) return end(Outcome::step_too_small);
    if (!is_bounded(candidate)) return end(Outcome::diverged);
    if (is_over(candidate))
      end(Outcome::stopped);
    else if (step_.last)
      end(Outcome::reached_end);
    t_ = step_.t_next;
    return true;
  }

  [[nodiscard]] HMAX_DEVICE double t() const { return t_; }
  [[nodiscard]] HMAX_DEVICE double h() const { return step_.h; }
  [[nodiscard]] HMAX_DEVICE bool has_ended() const { return ended_; }
  [[nodiscard]] HMAX_DEVICE std::int64_t attempts() const { return attempts_; }
  /// How it has ended.
  [[nodiscard]] HMAX_DEVICE Outcome outcome() const { return outcome_; }

 private:
  /// The error of one attempt, as a control asks a stepper for it.
  struct LaneError {
    double squared;
    template <class Norm>
    HMAX_DEVICE double error_squared(double /*h*/, const Eigen::Vector2d& /*y*/,
                                     const Eigen::Vector2d& /*y_new*/, const Norm& /*norm*/) const {
      return squared;
    }
  };

  HMAX_DEVICE bool end(Outcome outcome) {
    outcome_ = outcome;
    ended_ = true;
    return false;
  }

  Control control_;
  Proposal<double> step_{};
  double t_;
  std::int64_t attempts_;
  Outcome outcome_ = Outcome::reached_end;
  bool ended_ = false;
};

namespace adaptive_parts {
using Coefficients = StaticCoefficients<tableaux::Dop853>;

/// The place of each stage among the different times c_i, i > 0, of a step; their number at last.
constexpr auto node_of_stage = [] {
  std::array<std::size_t, Coefficients::stages() + 1> place{};
  std::size_t& count = place[Coefficients::stages()];
  for (std::size_t i = 1; i < Coefficients::stages(); ++i)
    place[i] = Coefficients::first_at_node_of(i) == i ? count++ : place[Coefficients::first_at_node_of(i)];
  return place;
}();
/// The same as a type, which a device reads without memory.
template <std::size_t I>
inline constexpr std::size_t node_of = node_of_stage[I];
inline constexpr std::size_t nodes = node_of_stage.back();
}  // namespace adaptive_parts

template <std::size_t N>
struct AdaptiveLanes {
  LaneRk<tableaux::Dop853, N> rk;
  LaneOscillators<N> oscillators;
  RmsNorm<double> norm;
  /// [node][lane]: w t, then its cosine and the force; [lane] alone where forces are steady.
  alignas(64) std::array<double, adaptive_parts::nodes * N> angles{}, forces{};
};

/// An attempt in every lane, and its error.
/// @param steady   no force changes in time, and forces[lane] is there: a constant of the type, or a bool
/// @param cosines  cosines(count, angles, out); not called where forces are steady
template <std::size_t N, class Steady, class Cosines>
[[gnu::always_inline]] HMAX_DEVICE inline void attempt(AdaptiveLanes<N>& lanes, Steady steady,
                                                       const Cosines& cosines) {
  using adaptive_parts::Coefficients, adaptive_parts::nodes;
  const std::size_t used = lanes.rk.used(), stride = steady ? 0 : used;
  if (!steady) {
    Coefficients::for_each_later_stage([&](auto i) __attribute__((always_inline)) {
      if constexpr (Coefficients::first_at_node_of(i) == i)
        for (std::size_t lane = 0; lane < used; ++lane)
          lanes.angles[adaptive_parts::node_of<i> * used + lane] =
              lanes.oscillators.angle(lane, lanes.rk.stage_time(i, lane));
    });
    cosines(nodes * used, lanes.angles, lanes.forces);
    for (std::size_t node = 0; node < nodes; ++node)
      for (std::size_t lane = 0; lane < used; ++lane)
        lanes.forces[node * used + lane] = lanes.oscillators.force(lane, lanes.forces[node * used + lane]);
  }
  lanes.rk.attempt([&](auto i, std::size_t lane, const Eigen::Vector2d& y,
                       Eigen::Vector2d& dydt) __attribute__((always_inline)) {
    lanes.oscillators.rhs_at(lane, lanes.forces[adaptive_parts::node_of<i> * stride + lane], y, dydt);
  });
  lanes.rk.weigh(lanes.norm);
}

/// Attempts of a motion that stands at the state of `rk`, until it has ended or so many were made.
/// @param is_over  as of AdaptiveMotion::judge()
/// @param attempt  attempt(): of the step that is set, and its error; false where these cannot be told
template <class IsOver, class Attempt>
HMAX_DEVICE inline void go_on(AdaptiveMotion& motion, LaneRk<tableaux::Dop853, 1>& rk, std::int64_t attempts,
                              std::int64_t most_attempts, const IsOver& is_over, const Attempt& attempt) {
  for (std::int64_t tried = 0; tried < attempts && motion.propose(most_attempts); ++tried) {
    rk.set_step(0, motion.t(), motion.h());
    if (!attempt()) return;
    if (motion.judge(rk.error_squared(0), rk.candidate(0), is_over)) rk.accept(0);
    if (motion.has_ended()) return;
  }
}

/// An attempt of formulas.
/// @param slope  slope(t, y, dydt)
template <class Method, class Slope>
HMAX_DEVICE inline void attempt(LaneRk<Method, 1>& rk, const Slope& slope) {
  rk.attempt([&](auto i, std::size_t lane, const Eigen::Vector2d& y, Eigen::Vector2d& dydt)
                 __attribute__((always_inline)) { slope(rk.stage_time(i, lane), y.data(), dydt.data()); });
}

// ---- fixed steps

/// The steps that ExplicitRk takes with FixedStep from t = 0 to t_end, one after the other.
class FixedTimes {
 public:
  /// @param t_end, h  [s], positive
  FixedTimes(double t_end, double h) : control_(h) {
    control_.start(0, Oscillator(), Span<double>{0, t_end}, Eigen::Vector2d());
  }

  /// Whether the last one has been told.
  [[nodiscard]] HMAX_DEVICE bool are_done() const { return done_; }
  /// Where the next one begins.
  [[nodiscard]] HMAX_DEVICE double t() const { return t_; }
  /// Its size.
  HMAX_DEVICE double next() {
    const Proposal<double> proposed = control_.propose(t_);
    control_.judge(0, 0, proposed, 0, 0);
    t_ = proposed.t_next;
    done_ = proposed.last;
    return proposed.h;
  }

 private:
  FixedStep<double> control_;
  double t_ = 0;
  bool done_ = false;
};

/// Steps of a motion of formulas that stands at the state of `rk`, until they are done, the state is not
/// bounded, or so many were taken.
/// @param attempt  attempt(): of the step that is set; false where it cannot be told
/// @returns whether the state is bounded
template <class Method, class Attempt>
HMAX_DEVICE inline bool go_on(FixedTimes& times, LaneRk<Method, 1>& rk, std::int64_t steps,
                              const Attempt& attempt) {
  for (std::int64_t taken = 0; taken < steps && !times.are_done(); ++taken) {
    const double t = times.t();
    rk.set_step(0, t, times.next());
    if (!attempt()) return true;
    if (!is_bounded(rk.candidate(0))) return false;
    rk.accept(0);
  }
  return true;
}

/// A step of one w, maybe of many motions: its size and cos(w t) at each stage.
template <class Method>
struct SharedStep {
  double h;
  std::array<double, Method::tableau.stages> cosine;
};

/// Those of FixedTimes with their cosines.
class CosineSteps {
 public:
  /// @param w [rad/s];  @param t_end, h [s], positive
  CosineSteps(double w, double t_end, double h) : times_(t_end, h), w_(w) {}

  /// Whether the last one has been told.
  [[nodiscard]] HMAX_DEVICE bool are_done() const { return times_.are_done(); }

  /// @param cosine  the function
  template <class Method, class Cosine>
  HMAX_DEVICE SharedStep<Method> next(const Cosine& cosine) {
    using Tableau = StaticCoefficients<Method>;
    const double t = times_.t();
    SharedStep<Method> step{times_.next(), {}};
    // The first stage takes the force from the end of the step before where a stage stands there.
    step.cosine[0] = end_known_ ? end_ : cosine(w_ * t);
    Tableau::for_each_later_stage([&](auto i) {
      constexpr std::size_t first = Tableau::first_at_node_of(i);
      constexpr auto node = static_cast<double>(Tableau::node(i));
      step.cosine[i] = first == i ? cosine(w_ * (t + node * step.h)) : step.cosine[first];
    });
    if constexpr (Tableau::first_at_end() < Tableau::stages()) {
      end_ = step.cosine[Tableau::first_at_end()];
      end_known_ = true;
    }
    return step;
  }

 private:
  FixedTimes times_;
  double w_, end_ = 0;  ///< the cosine at the end of the step before
  bool end_known_ = false;
};

/// All of them.
template <class Method>
std::vector<SharedStep<Method>> shared_steps(double w, double t_end, double h) {
  std::vector<SharedStep<Method>> steps;
  for (CosineSteps all(w, t_end, h); !all.are_done();)
    steps.push_back(all.next<Method>([](double angle) { return std::cos(angle); }));
  return steps;
}

/// Calls f(Method{}) of the method of tableaux::All that has this id, if there is one.
template <class F>
void with_explicit_method(std::string_view id, const F& f) {
  const auto try_method = [&]<class Method>(const Method& method) {
    if (Method::id == id) f(method);
  };
  std::apply([&](const auto&... each) { (try_method(each), ...); }, tableaux::All{});
}

template <class Method, std::size_t N>
struct SharedLanes {
  LaneRk<Method, N> rk;
  LaneOscillators<N> oscillators;
  alignas(64) std::array<double, N> bounded;  ///< 1 while every state has been, else 0
};

template <class Method, std::size_t N>
[[gnu::always_inline]] HMAX_DEVICE inline void advance(SharedLanes<Method, N>& lanes,
                                                       std::span<const SharedStep<Method>> steps) {
  const std::size_t used = lanes.rk.used();
  for (const SharedStep<Method>& step : steps) {
    for (std::size_t lane = 0; lane < used; ++lane) lanes.rk.set_step(lane, 0, step.h);
    lanes.rk.attempt([&](auto i, std::size_t lane, const Eigen::Vector2d& y,
                         Eigen::Vector2d& dydt) __attribute__((always_inline)) {
      lanes.oscillators.rhs_at(lane, lanes.oscillators.force(lane, step.cosine[i]), y, dydt);
    });
    for (std::size_t lane = 0; lane < used; ++lane) {
      lanes.bounded[lane] = is_bounded(lanes.rk.candidate(lane)) ? lanes.bounded[lane] : 0;
      lanes.rk.accept(lane);
    }
  }
}

}  // namespace hmax
