/// Motions of oscillators and of formulas, one a thread: the program of devices and, in tests, of the
/// processor.
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

/// A motion in the memory of a device, between two launches.
struct StoredMotion {
  double y[2], slope[2];
  bool beyond = false;  ///< as MotionEnd's
};

/// One of adaptive steps.
struct AdaptiveStored : StoredMotion {
  AdaptiveMotion motion;
};
struct StoredOscillator : AdaptiveStored {
  OscillatorRates rates;
};

/// Which formulas a motion has, and between which times they are told, see PlanarFormulas.
struct OwnFormulas {
  std::int32_t number;
  double from, to;
};
struct AdaptiveFormulaMotion : AdaptiveStored {
  OwnFormulas formulas;
};

/// Where a motion has ended.
struct MotionEnd {
  double y[2];
  Outcome outcome;
  std::int64_t attempts;
  bool beyond;  ///< the device cannot tell, and the processor has to run it from its start
};

/// Motions that go on by some attempts.
struct MotionsUnderWay {
  static constexpr std::int32_t threads = 128;
  MotionEnd* ends;  ///< shape (count): of those that have ended
  std::int64_t count, attempts, most_attempts;
  RmsNorm<double> norm;
  bool arrives;        ///< whether the rule ends motions
  FateRule rule;       ///< its traps lie in the memory of the device
  std::int32_t* left;  ///< becomes 1 where a motion has not ended
};

/// Those of oscillators.
struct AdaptiveMotions : MotionsUnderWay {
  StoredOscillator* motions;  ///< shape (count)
  bool steady;                ///< no force changes in time
};

/// Room of a thread for formulas.
inline constexpr std::size_t most_registers = 128;

/// Those of formulas.
struct FormulaMotions : MotionsUnderWay {
  AdaptiveFormulaMotion* motions;  ///< shape (count)
  const FormulaCode* codes;        ///< of all formulas, by their numbers
};

/// A motion of fixed steps.
struct FixedMotion : StoredMotion {
  double bounded;  ///< see SharedLanes
  OscillatorRates rates;
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

/// The same of formulas.
struct FixedFormulaMotion : StoredMotion {
  double bounded;
  FixedTimes times;
  OwnFormulas formulas;
};
struct FormulaSteps {
  static constexpr std::int32_t threads = 128;
  FixedFormulaMotion* motions;
  std::int64_t count;
  std::string_view method;
  std::int64_t most_steps;
  const FormulaCode* codes;
  std::int32_t* left;
};

HMAX_DEVICE inline std::int64_t count_of(const MotionsUnderWay& all) { return all.count; }
HMAX_DEVICE inline std::int64_t count_of(const SharedMotions& all) { return all.count; }
HMAX_DEVICE inline std::int64_t count_of(const OwnMotions& all) { return all.count; }
HMAX_DEVICE inline std::int64_t count_of(const FormulaSteps& all) { return all.count; }

/// Puts a motion into the lane, and back.
template <class Method>
HMAX_DEVICE void take(const StoredMotion& own, LaneRk<Method, 1>& rk) {
  rk.start(0, {own.y[0], own.y[1]}, {own.slope[0], own.slope[1]});
}
template <class Method>
HMAX_DEVICE void put(const LaneRk<Method, 1>& rk, StoredMotion& own) {
  const Eigen::Vector2d y = rk.state(0), slope = rk.slope(0);
  for (int i = 0; i < 2; ++i) own.y[i] = y[i], own.slope[i] = slope[i];
}

/// The attempts of motion n.
template <class Attempt>
HMAX_DEVICE void go_on(const MotionsUnderWay& all, AdaptiveStored& own, std::int64_t n,
                       LaneRk<tableaux::Dop853, 1>& rk, const Attempt& attempt) {
  AdaptiveMotion motion = own.motion;
  take(own, rk);
  const auto is_over = [&](const Eigen::Vector2d& y) { return all.arrives && all.rule.of(y) != undecided; };
  go_on(motion, rk, all.attempts, all.most_attempts, is_over, attempt);
  put(rk, own);
  own.motion = motion;
  if (motion.has_ended())
    all.ends[n] = {{own.y[0], own.y[1]}, motion.outcome(), motion.attempts(), false};
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
  go_on(all, all.motions[n], n, lanes.rk, [&] {
    attempt(lanes, std::bool_constant<steady>{}, cosines);
    return true;
  });
}

/// Formulas in a thread.
class ThreadFormulas {
 public:
  HMAX_DEVICE ThreadFormulas(const FormulaCode* codes, const OwnFormulas& own)
      : code_(codes[own.number]), from_(own.from), to_(own.to) {}

  /// f(t, y), once for all stages of all methods.
  [[gnu::noinline]] HMAX_DEVICE void rhs(double t, const double* y, double* dydt) {
    const auto circular = [&](FormulaOp op, double angle, double) {
      if (!(std::abs(angle) <= std::numeric_limits<double>::max())) return angle - angle;
      if (std::abs(angle) < cosine_parts::far_angle)
        return op == FormulaOp::sin ? sine(angle) : cosine(angle);
      beyond_ = true;
      return 0.0;
    };
    run_formulas(code_, registers_, t < from_ ? from_ : t > to_ ? to_ : t, y, dydt, circular);
  }
  /// A step of a method. @returns whether the device could tell all of its slopes
  template <class Method>
  HMAX_DEVICE bool try_step(LaneRk<Method, 1>& rk) {
    attempt(rk, [&](double t, const double* y, double* dydt) { rhs(t, y, dydt); });
    return !beyond_;
  }
  [[nodiscard]] HMAX_DEVICE bool are_beyond() const { return beyond_; }

 private:
  FormulaCode code_;
  double from_, to_;
  bool beyond_ = false;
  double registers_[most_registers];
};

HMAX_DEVICE inline void run_thread(std::true_type, const FormulaMotions& all, std::int64_t n) {
  AdaptiveFormulaMotion& own = all.motions[n];
  if (own.motion.has_ended() || own.beyond) return;
  ThreadFormulas formulas(all.codes, own.formulas);
  LaneRk<tableaux::Dop853, 1> rk;
  go_on(all, own, n, rk, [&] {
    const bool told = formulas.try_step(rk);
    rk.weigh(all.norm);
    return told;
  });
  if (formulas.are_beyond()) own.beyond = all.ends[n].beyond = true;
}

template <class Method>
HMAX_DEVICE void run_thread(std::type_identity<Method>, const FormulaSteps& all, std::int64_t n) {
  FixedFormulaMotion& own = all.motions[n];
  if (own.times.are_done() || own.beyond || own.bounded == 0) return;
  ThreadFormulas formulas(all.codes, own.formulas);
  LaneRk<Method, 1> rk;
  take(own, rk);
  FixedTimes times = own.times;
  if (!go_on(times, rk, all.most_steps, [&] { return formulas.try_step(rk); })) own.bounded = 0;
  put(rk, own);
  own.times = times;
  own.beyond = formulas.are_beyond();
  if (!times.are_done() && !own.beyond && own.bounded != 0) *all.left = 1;
}

/// What steps(lanes) makes of a motion.
template <class Method, class Steps>
HMAX_DEVICE void with_lanes(FixedMotion& own, const Steps& steps) {
  SharedLanes<Method, 1> lanes;
  take(own, lanes.rk);
  lanes.oscillators.set(0, own.rates);
  lanes.bounded[0] = own.bounded;
  steps(lanes);
  put(lanes.rk, own);
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
