/// Motions of oscillators, one a thread: the program of devices and, in tests, of the processor.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

#include "analysis/dynamics/oscillator_steps.hpp"
#include "analysis/dynamics/trap.hpp"
#include "core/instructions/cosine.hpp"
#include "core/instructions/device_code.hpp"
#include "problems/formula_code.hpp"

namespace hmax {

/// A motion of adaptive steps in the memory of a device, between two launches.
struct StoredMotion {
  AdaptiveMotion motion;
  OscillatorRates rates;
  double y[2], slope[2];
  bool beyond = false;  ///< as MotionEnd's
};

/// Where a motion has ended.
struct MotionEnd {
  double y[2];
  Outcome outcome;
  bool beyond;  ///< the device cannot tell, and the processor has to run it from its start
};

/// Motions that go on by some attempts.
struct MotionsUnderWay {
  static constexpr std::int32_t threads = 128;
  StoredMotion* motions;  ///< shape (count)
  MotionEnd* ends;        ///< of those that have ended
  std::int64_t count, attempts, most_attempts;
  RmsNorm<double> norm;
  bool arrives;        ///< whether the rule ends motions
  FateRule rule;       ///< its traps lie in the memory of the device
  std::int32_t* left;  ///< becomes 1 where a motion has not ended
};

/// Those of oscillators.
struct AdaptiveMotions : MotionsUnderWay {
  bool steady;  ///< no force changes in time
};

/// Those of formulas that do not know the time.
struct FormulaMotions : MotionsUnderWay {
  /// Room of a thread.
  static constexpr std::size_t most_registers = 128;
  FormulaCode code;
};

/// A motion of fixed steps.
struct FixedMotion {
  OscillatorRates rates;
  double y[2], slope[2];
  double bounded;  ///< see SharedLanes
};

/// Motions that go on by steps of the same size and w.
struct SharedMotions {
  static constexpr std::int32_t threads = 128;
  FixedMotion* motions;  ///< shape (count)
  std::int64_t count;
  std::string_view method;  ///< an id of tableaux::All
  const void* steps;        ///< of SharedStep<Method>
  std::int64_t step_count;
};

/// The same of steps of their own.
struct OwnMotion : FixedMotion {
  CosineSteps steps;
};
struct OwnMotions {
  static constexpr std::int32_t threads = 128;
  OwnMotion* motions;
  std::int64_t count;
  std::string_view method;
  std::int64_t most_steps;
  std::int32_t* left;  ///< becomes 1 where a motion has further steps
};

HMAX_DEVICE inline std::int64_t count_of(const MotionsUnderWay& all) { return all.count; }
HMAX_DEVICE inline std::int64_t count_of(const SharedMotions& all) { return all.count; }
HMAX_DEVICE inline std::int64_t count_of(const OwnMotions& all) { return all.count; }

/// The attempts of motion n.
template <class Attempt>
HMAX_DEVICE void go_on(const MotionsUnderWay& all, std::int64_t n, LaneRk<tableaux::Dop853, 1>& rk,
                       const Attempt& attempt) {
  StoredMotion& own = all.motions[n];
  AdaptiveMotion motion = own.motion;
  rk.start(0, {own.y[0], own.y[1]}, {own.slope[0], own.slope[1]});
  const auto is_over = [&](const Eigen::Vector2d& y) { return all.arrives && all.rule.of(y) != undecided; };
  go_on(motion, rk, all.attempts, all.most_attempts, is_over, attempt);
  const Eigen::Vector2d y = rk.state(0), slope = rk.slope(0);
  for (int i = 0; i < 2; ++i) own.y[i] = y[i], own.slope[i] = slope[i];
  own.motion = motion;
  if (motion.has_ended())
    all.ends[n] = {{y[0], y[1]}, motion.outcome(), false};
  else
    *all.left = 1;
}

template <bool steady>
HMAX_DEVICE void run_thread(std::bool_constant<steady>, const AdaptiveMotions& all, std::int64_t n) {
  if (all.motions[n].motion.has_ended()) return;
  AdaptiveLanes<1> lanes;
  lanes.norm = all.norm;
  lanes.oscillators.set(0, all.motions[n].rates);
  if constexpr (steady) lanes.forces[0] = lanes.oscillators.force(0, 1);
  const auto cosines = [](std::size_t count, const auto& angles, auto& out) {
    for (std::size_t i = 0; i < count; ++i) out[i] = cosine(angles[i]);
  };
  go_on(all, n, lanes.rk, [&] {
    attempt(lanes, std::bool_constant<steady>{}, cosines);
    return true;
  });
}

HMAX_DEVICE inline void run_thread(std::true_type, const FormulaMotions& all, std::int64_t n) {
  StoredMotion& own = all.motions[n];
  if (own.motion.has_ended() || own.beyond) return;
  bool beyond = false;
  const auto circular = [&](FormulaOp op, double angle, double) {
    if (!(std::abs(angle) <= std::numeric_limits<double>::max())) return angle - angle;
    if (std::abs(angle) < cosine_parts::far_angle) return op == FormulaOp::sin ? sine(angle) : cosine(angle);
    beyond = true;
    return 0.0;
  };
  double registers[FormulaMotions::most_registers];
  LaneRk<tableaux::Dop853, 1> rk;
  go_on(all, n, rk, [&] {
    attempt(rk, all.norm,
            [&](const double* y, double* dydt) { run_formulas(all.code, registers, 0, y, dydt, circular); });
    return !beyond;
  });
  if (beyond) own.beyond = all.ends[n].beyond = true;
}

/// What steps(lanes) makes of a motion.
template <class Method, class Steps>
HMAX_DEVICE void with_lanes(FixedMotion& own, const Steps& steps) {
  SharedLanes<Method, 1> lanes;
  lanes.rk.start(0, {own.y[0], own.y[1]}, {own.slope[0], own.slope[1]});
  lanes.oscillators.set(0, own.rates);
  lanes.bounded[0] = own.bounded;
  steps(lanes);
  const Eigen::Vector2d y = lanes.rk.state(0), slope = lanes.rk.slope(0);
  for (int i = 0; i < 2; ++i) own.y[i] = y[i], own.slope[i] = slope[i];
  own.bounded = lanes.bounded[0];
}

/// The steps of motion n.
template <class Method>
HMAX_DEVICE void run_thread(std::type_identity<Method>, const SharedMotions& all, std::int64_t n) {
  with_lanes<Method>(all.motions[n], [&](auto& lanes) {
    const auto* const steps = static_cast<const SharedStep<Method>*>(all.steps);
    advance(lanes, std::span(steps, static_cast<std::size_t>(all.step_count)));
  });
}
template <class Method>
HMAX_DEVICE void run_thread(std::type_identity<Method>, const OwnMotions& all, std::int64_t n) {
  OwnMotion& own = all.motions[n];
  CosineSteps steps = own.steps;
  with_lanes<Method>(own, [&](auto& lanes) {
    for (std::int64_t done = 0; done < all.most_steps && !steps.are_done(); ++done) {
      const auto step = steps.template next<Method>([](double angle) { return cosine(angle); });
      advance(lanes, std::span(&step, 1));
    }
  });
  own.steps = steps;
  if (!steps.are_done()) *all.left = 1;
}

}  // namespace hmax
