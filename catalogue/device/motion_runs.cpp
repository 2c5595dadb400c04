#include "catalogue/device/motion_runs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "catalogue/device/device_program.hpp"
#include "core/errors.hpp"
#include "core/instructions/cosines.hpp"

namespace hmax {

namespace {

using Eigen::Vector2d;

// A launch takes milliseconds: displays are drawn between two of them.
constexpr std::int64_t attempts_of_a_launch = 100, steps_of_a_launch = 1000;

/// The device, lent to one thread at a time, and its memory, which is used again.
class Lent {
 public:
  explicit Lent(Device& lent) : device(lent) {}

  Device& device;
  std::mutex one_at_a_time;

  /// Room for so many, the same one in each call of the same place.
  template <class T>
  T* room(std::size_t place, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    Room& own = rooms_[place];
    if (own.bytes < count * sizeof(T)) {
      const std::size_t bytes = std::max(count * sizeof(T), 2 * own.bytes);
      void* const memory = device.allocate(bytes);
      own = {memory, bytes};  // what was there stays with the device
    }
    return static_cast<T*>(own.memory);
  }
  /// The same with a copy of numbers of the processor.
  template <class T>
  T* copy(std::size_t place, const std::vector<T>& from) {
    T* const to = room<T>(place, from.size());
    if (!from.empty()) device.write(to, from.data(), from.size() * sizeof(T));
    return to;
  }
  template <class T>
  void read(std::vector<T>& to, const T* from) {
    if (!to.empty()) device.read(to.data(), from, to.size() * sizeof(T));
  }

 private:
  struct Room {
    void* memory = nullptr;
    std::size_t bytes = 0;
  };
  Room rooms_[7];
};

/// f(0, y).
template <class S>
Vector2d slope_of(const S& system, const Vector2d& y) {
  Vector2d slope;
  system.rhs(0, y, slope);
  return slope;
}

/// As many runs of a client as a call takes; those that have no start end at once.
/// @param store  store(run): what lies on the device
template <class Store>
std::vector<OscillatorRun*> some_of(const RunClient& client, std::size_t at_once, const Store& store) {
  std::vector<OscillatorRun*> runs;
  while (runs.size() < at_once) {
    OscillatorRun* const run = client.next();
    if (!run) break;
    run->outcome = Outcome::diverged;
    if (!is_bounded(run->y)) {
      client.ended(*run);
      continue;
    }
    store(*run);
    runs.push_back(run);
  }
  return runs;
}

/// One launch after the other until no motion is left.
template <class Motions>
void run_to_end(Lent& lent, Motions& all) {
  std::vector<std::int32_t> left{1};
  while (left[0] != 0) {
    left[0] = 0;
    all.left = lent.copy(3, left);
    lent.device.run({all});
    lent.read(left, all.left);
  }
}

/// @throws InputError  where the cosines of a device have other bits
void require_own_cosines() {
  if (!cosines_are_those_of_musl())
    throw InputError(
        "--device gpu has the cosines of musl, and this hmax was built without them; install musl-dev, then "
        "configure and build again, or leave --device out");
}

/// Throws where a device would need more digits of pi.
void require_near(const OscillatorRun& run) {
  if (!(std::abs(run.system->parameters().w) * run.t_end < 0.99 * cosine_parts::far_angle))
    throw InputError("--device gpu takes forces of up to 10^6 rad in a period; leave --device out");
}

template <class S>
StoredMotion stored(const AdaptiveSteps& steps, const S& system, const OscillatorRun& run) {
  const Vector2d slope = slope_of(system, run.y);
  return {AdaptiveMotion(steps.tolerances, system, run.t_end, run.y),
          {},
          {run.y[0], run.y[1]},
          {slope[0], slope[1]}};
}

/// Oscillators whose steps are chosen.
struct AdaptiveOscillators {
  const AdaptiveSteps& steps;

  [[nodiscard]] StoredMotion store(const OscillatorRun& run) const {
    if (!steps.steady) require_near(run);
    StoredMotion motion = stored(steps, *run.system, run);
    motion.rates = OscillatorRates::of(*run.system);
    return motion;
  }
  [[nodiscard]] AdaptiveMotions motions(Lent&) const { return {{}, steps.steady}; }
  void run_on_processor(const RunClient&) const { throw std::logic_error("no angle is too far"); }
};

/// Formulas, likewise.
struct AdaptiveFormulas {
  const AdaptiveSteps& steps;
  const std::shared_ptr<const FormulaProgram>& formulas;

  [[nodiscard]] StoredMotion store(const OscillatorRun& run) const {
    return stored(steps, PlanarFormulas{*formulas}, run);
  }
  [[nodiscard]] FormulaMotions motions(Lent& lent) const {
    FormulaMotions all{};
    all.code = formulas->code();
    all.code.steps = lent.copy(4, formulas->steps());
    all.code.constants = lent.copy(5, formulas->constants());
    all.code.results = lent.copy(6, formulas->results());
    return all;
  }
  void run_on_processor(const RunClient& client) const { in_lanes().formulas(steps, formulas)(client); }
};

template <class Adaptive>
void run_adaptive(Lent& lent, const Adaptive& adaptive, std::size_t at_once, const RunClient& client) {
  const AdaptiveSteps& steps = adaptive.steps;
  for (;;) {
    std::vector<StoredMotion> motions;
    const auto runs =
        some_of(client, at_once, [&](const OscillatorRun& run) { motions.push_back(adaptive.store(run)); });
    if (runs.empty()) return;
    std::vector<MotionEnd> ends(runs.size());
    {
      const std::scoped_lock lock(lent.one_at_a_time);
      auto all = adaptive.motions(lent);
      all.motions = lent.copy(0, motions);
      all.ends = lent.room<MotionEnd>(1, ends.size());
      all.count = static_cast<std::int64_t>(runs.size());
      all.attempts = attempts_of_a_launch;
      all.most_attempts = steps.most_attempts;
      all.norm = {steps.tolerances.rtol, steps.tolerances.atol};
      all.arrives = steps.arrival.has_value();
      if (steps.arrival) {
        all.rule = steps.arrival->rule();
        all.rule.traps = lent.copy(2, steps.arrival->traps);
      }
      run_to_end(lent, all);
      lent.read(ends, all.ends);
    }
    std::vector<OscillatorRun*> beyond;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (ends[i].beyond) {
        beyond.push_back(runs[i]);
        continue;
      }
      runs[i]->y = {ends[i].y[0], ends[i].y[1]};
      runs[i]->outcome = ends[i].outcome;
      client.ended(*runs[i]);
    }
    const auto next = [&]() -> OscillatorRun* {
      if (beyond.empty()) return nullptr;
      OscillatorRun* const run = beyond.back();
      beyond.pop_back();
      return run;
    };
    if (!beyond.empty()) adaptive.run_on_processor({next, client.ended});
  }
}

/// @throws InputError  where a device would have other bits, or no room
void require_arithmetic(const FormulaProgram& formulas) {
  if (formulas.registers() > FormulaMotions::most_registers)
    throw InputError("--device gpu takes formulas of at most " +
                     std::to_string(FormulaMotions::most_registers) +
                     " operations, numbers and states together, and these have " +
                     std::to_string(formulas.registers()) + "; leave --device out");
  for (const FormulaStep& step : formulas.steps()) {
    if (step.code >= FormulaStep::jump_unless) continue;
    arithmetic_value(static_cast<FormulaOp>(step.code), 0, 0, 0, [](FormulaOp op, double, double) {
      if (op != FormulaOp::sin && op != FormulaOp::cos)
        throw InputError(
            "--device gpu takes formulas of arithmetic, comparisons, powers 2 to 4, sqrt, abs, min, max, sign, "
            "rint, sin and cos alone; leave --device out");
      require_own_cosines();
      return 0.0;
    });
  }
}

/// Fixed steps.
/// @param store     store(run, motion): what lies on the device
/// @param launches  launches(motions, count): all steps of motions that lie there
template <class Motion, class Store, class Launches>
void run_fixed(Lent& lent, std::size_t at_once, const RunClient& client, const Store& store,
               const Launches& launches) {
  for (;;) {
    std::vector<Motion> motions;
    const auto runs = some_of(client, at_once, [&](const OscillatorRun& run) {
      const Vector2d slope = slope_of(*run.system, run.y);
      motions.push_back(store(
          run,
          FixedMotion{OscillatorRates::of(*run.system), {run.y[0], run.y[1]}, {slope[0], slope[1]}, 1.0}));
    });
    if (runs.empty()) return;
    {
      const std::scoped_lock lock(lent.one_at_a_time);
      Motion* const there = lent.copy(0, motions);
      launches(there, static_cast<std::int64_t>(runs.size()));
      lent.read(motions, there);
    }
    for (std::size_t i = 0; i < runs.size(); ++i) {
      runs[i]->y = {motions[i].y[0], motions[i].y[1]};
      runs[i]->outcome = motions[i].bounded != 0 ? Outcome::reached_end : Outcome::diverged;
      client.ended(*runs[i]);
    }
  }
}

template <class Method>
void run_shared(Lent& lent, const std::vector<SharedStep<Method>>& steps, std::size_t at_once,
                const RunClient& client) {
  run_fixed<FixedMotion>(
      lent, at_once, client, [](const OscillatorRun&, const FixedMotion& motion) { return motion; },
      [&](FixedMotion* motions, std::int64_t count) {
        const SharedStep<Method>* const first = lent.copy(1, steps);
        const auto all = static_cast<std::int64_t>(steps.size());
        for (std::int64_t done = 0; done < all; done += steps_of_a_launch)
          lent.device.run({SharedMotions{.motions = motions,
                                         .count = count,
                                         .method = Method::id,
                                         .steps = first + done,
                                         .step_count = std::min(steps_of_a_launch, all - done)}});
      });
}

void run_own(Lent& lent, std::string_view method, std::size_t at_once, const RunClient& client) {
  run_fixed<OwnMotion>(
      lent, at_once, client,
      [](const OscillatorRun& run, const FixedMotion& motion) {
        require_near(run);
        return OwnMotion{motion, CosineSteps(motion.rates.w, run.t_end, run.h)};
      },
      [&](OwnMotion* motions, std::int64_t count) {
        OwnMotions all{.motions = motions,
                       .count = count,
                       .method = method,
                       .most_steps = steps_of_a_launch / 10,
                       .left = nullptr};
        run_to_end(lent, all);
      });
}

}  // namespace

MotionRunner motions_on(Device& device, std::size_t at_once) {
  const auto lent = std::make_shared<Lent>(device);
  return {.adaptive = [lent, at_once](const AdaptiveSteps& steps) -> RunMotions {
            if (!steps.steady) require_own_cosines();
            return [=](const RunClient& client) {
              run_adaptive(*lent, AdaptiveOscillators{steps}, at_once, client);
            };
          },
          .shared =
              [lent, at_once](const SharedSteps& asked) {
                RunMotions found;
                with_explicit_method(asked.method, [&]<class Method>(const Method&) {
                  found = [=, steps = shared_steps<Method>(asked.w, asked.t_end, asked.h)](
                              const RunClient& client) { run_shared<Method>(*lent, steps, at_once, client); };
                });
                return found;
              },
          .own_steps =
              [lent, at_once](std::string_view method) {
                RunMotions found;
                with_explicit_method(method, [&]<class Method>(const Method&) {
                  require_own_cosines();
                  found = [=](const RunClient& client) { run_own(*lent, Method::id, at_once, client); };
                });
                return found;
              },
          .formulas = [lent, at_once](const AdaptiveSteps& steps,
                                      const std::shared_ptr<const FormulaProgram>& formulas) -> RunMotions {
            require_arithmetic(*formulas);
            return [=](const RunClient& client) {
              run_adaptive(*lent, AdaptiveFormulas{steps, formulas}, at_once, client);
            };
          },
          .is_device = true};
}

}  // namespace hmax
