#include "catalogue/device/motion_runs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "catalogue/device/programs/device_program.hpp"
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

  void run(const DeviceProgram& program) { device.run({&program, 1}, 1, {}); }

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
  Room rooms_[4];
};

/// A motion at its start.
template <class S>
StoredMotion at_start(const S& system, double t0, const OscillatorRun& run) {
  Vector2d slope;
  system.rhs(t0, run.y, slope);
  return {{run.y[0], run.y[1]}, {slope[0], slope[1]}};
}

/// Ends runs of which take(i) has read what they came to; where it returns false the device could not tell,
/// and the processor runs them.
template <class Take>
void end_all(const std::vector<OscillatorRun*>& runs, const RunClient& client, const Take& take,
             const RunMotions& processor) {
  std::vector<OscillatorRun*> beyond;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (take(i))
      client.ended(*runs[i]);
    else
      beyond.push_back(runs[i]);
  const auto next = [&]() -> OscillatorRun* {
    if (beyond.empty()) return nullptr;
    OscillatorRun* const run = beyond.back();
    beyond.pop_back();
    return run;
  };
  if (!beyond.empty()) processor({next, client.ended});
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

/// One launch after the other until no motion is left, or going() is false.
template <class Motions, class Going>
void run_to_end(Lent& lent, Motions& all, const Going& going) {
  std::vector<std::int32_t> left{1};
  while (left[0] != 0 && going()) {
    left[0] = 0;
    all.left = lent.copy(3, left);
    lent.run({all});
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

/// Formulas in the memory of a device. Those that differ in numbers alone share their operations.
class FormulasThere {
 public:
  FormulasThere(std::shared_ptr<Lent> lent, const FormulaPrograms& programs) : lent_(std::move(lent)) {
    std::vector<const FormulaProgram*> distinct;
    std::vector<FormulaStep> steps;
    std::vector<std::uint32_t> results;
    std::vector<double> constants;
    struct Begin {
      std::size_t steps, results, constants;
    };
    std::vector<Begin> shared, begins;
    for (const auto& program : programs) {
      std::size_t k = distinct.size();
      while (k > 0 && !have_same_operations(*distinct[k - 1], *program)) --k;
      if (k == 0) {
        distinct.push_back(program.get());
        shared.push_back({steps.size(), results.size(), 0});
        steps.insert(steps.end(), program->steps().begin(), program->steps().end());
        results.insert(results.end(), program->results().begin(), program->results().end());
        k = distinct.size();
      }
      numbers_.emplace(program.get(), static_cast<std::int32_t>(begins.size()));
      begins.push_back({shared[k - 1].steps, shared[k - 1].results, constants.size()});
      constants.insert(constants.end(), program->constants().begin(), program->constants().end());
    }
    const std::scoped_lock lock(lent_->one_at_a_time);
    const FormulaStep* const steps_there = stored(steps);
    const std::uint32_t* const results_there = stored(results);
    const double* const constants_there = stored(constants);
    std::vector<FormulaCode> codes;
    for (std::size_t i = 0; i < programs.size(); ++i) {
      FormulaCode& code = codes.emplace_back(programs[i]->code());
      code.steps = steps_there + begins[i].steps;
      code.results = results_there + begins[i].results;
      code.constants = constants_there + begins[i].constants;
    }
    codes_ = stored(codes);
  }
  ~FormulasThere() {
    const std::scoped_lock lock(lent_->one_at_a_time);
    for (void* const each : memory_) lent_->device.release(each);
  }
  FormulasThere(const FormulasThere&) = delete;
  FormulasThere& operator=(const FormulasThere&) = delete;

  [[nodiscard]] const FormulaCode* codes() const { return codes_; }
  [[nodiscard]] OwnFormulas of(const OscillatorRun& run) const {
    const PlanarFormulas& system = run.piece->system;
    return {numbers_.at(system.program.get()), system.from, system.to};
  }

 private:
  static bool have_same_operations(const FormulaProgram& one, const FormulaProgram& other) {
    return one.constants().size() == other.constants().size() && one.results() == other.results() &&
           std::ranges::equal(one.steps(), other.steps(), [](const FormulaStep& a, const FormulaStep& b) {
             return std::tie(a.code, a.to, a.a, a.b, a.c) == std::tie(b.code, b.to, b.a, b.b, b.c);
           });
  }
  template <class T>
  const T* stored(const std::vector<T>& from) {
    const std::size_t bytes = from.size() * sizeof(T);
    void* const there = memory_.emplace_back(lent_->device.allocate(std::max<std::size_t>(bytes, 1)));
    if (bytes > 0) lent_->device.write(there, from.data(), bytes);
    return static_cast<const T*>(there);
  }

  std::shared_ptr<Lent> lent_;
  std::vector<void*> memory_;
  const FormulaCode* codes_ = nullptr;
  std::unordered_map<const FormulaProgram*, std::int32_t> numbers_;
};

/// Oscillators whose steps are chosen.
struct AdaptiveOscillators {
  const AdaptiveSteps& steps;

  [[nodiscard]] StoredOscillator store(const OscillatorRun& run) const {
    if (!steps.steady) require_near(run);
    return {{at_start(*run.system, 0, run),
             AdaptiveMotion(steps.tolerances, *run.system, {0, run.t_end}, run.t_end, run.y)},
            OscillatorRates::of(*run.system)};
  }
  [[nodiscard]] AdaptiveMotions motions(StoredOscillator* there) const { return {{}, there, steps.steady}; }
  [[nodiscard]] static RunMotions processor() { return {}; }  // no angle is too far
};

/// Formulas, likewise.
struct AdaptiveFormulas {
  const AdaptiveSteps& steps;
  const FormulasThere& formulas;

  [[nodiscard]] AdaptiveFormulaMotion store(const OscillatorRun& run) const {
    const FormulaPiece& piece = *run.piece;
    return {{at_start(piece.system, piece.span.t0, run),
             AdaptiveMotion(steps.tolerances, piece.system, piece.span, piece.whole, run.y, run.attempts)},
            formulas.of(run)};
  }
  [[nodiscard]] FormulaMotions motions(AdaptiveFormulaMotion* there) const {
    return {{}, there, formulas.codes()};
  }
  [[nodiscard]] RunMotions processor() const { return in_lanes().formulas(steps, {}); }
};

template <class Adaptive>
void run_adaptive(Lent& lent, const Adaptive& adaptive, std::size_t at_once, const RunClient& client) {
  const AdaptiveSteps& steps = adaptive.steps;
  for (;;) {
    std::vector<decltype(adaptive.store({}))> motions;
    const auto runs =
        some_of(client, at_once, [&](const OscillatorRun& run) { motions.push_back(adaptive.store(run)); });
    if (runs.empty()) return;
    std::vector<MotionEnd> ends(runs.size());
    {
      const std::scoped_lock lock(lent.one_at_a_time);
      auto all = adaptive.motions(lent.copy(0, motions));
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
      run_to_end(lent, all, [&] { return !steps.are_interrupted(); });
      if (steps.are_interrupted()) return;
      lent.read(ends, all.ends);
    }
    const auto take = [&](std::size_t i) {
      const MotionEnd& end = ends[i];
      if (end.beyond) return false;
      runs[i]->y = {end.y[0], end.y[1]};
      runs[i]->outcome = end.outcome;
      runs[i]->attempts = end.attempts;
      return true;
    };
    end_all(runs, client, take, adaptive.processor());
  }
}

/// @throws InputError  where a device would have other bits, or no room
void require_arithmetic(const FormulaProgram& formulas) {
  if (formulas.registers() > most_registers)
    throw InputError("--device gpu takes formulas of at most " + std::to_string(most_registers) +
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
/// @param store      store(run): the motion at its start
/// @param launches   launches(motions, count): all steps of motions that lie there
/// @param processor  runs what a device cannot tell
template <class Motion, class Store, class Launches>
void run_fixed(Lent& lent, std::size_t at_once, const RunClient& client, const Store& store,
               const Launches& launches, const RunMotions& processor = {}) {
  for (;;) {
    std::vector<Motion> motions;
    const auto runs =
        some_of(client, at_once, [&](const OscillatorRun& run) { motions.push_back(store(run)); });
    if (runs.empty()) return;
    {
      const std::scoped_lock lock(lent.one_at_a_time);
      Motion* const there = lent.copy(0, motions);
      launches(there, static_cast<std::int64_t>(runs.size()));
      lent.read(motions, there);
    }
    const auto take = [&](std::size_t i) {
      const Motion& end = motions[i];
      if (end.beyond) return false;
      runs[i]->y = {end.y[0], end.y[1]};
      runs[i]->outcome = end.bounded != 0 ? Outcome::reached_end : Outcome::diverged;
      return true;
    };
    end_all(runs, client, take, processor);
  }
}

FixedMotion fixed_motion(const OscillatorRun& run) {
  return {at_start(*run.system, 0, run), 1.0, OscillatorRates::of(*run.system)};
}

template <class Method>
void run_shared(Lent& lent, const std::vector<SharedStep<Method>>& steps, std::size_t at_once,
                const RunClient& client) {
  run_fixed<FixedMotion>(lent, at_once, client, fixed_motion, [&](FixedMotion* motions, std::int64_t count) {
    const SharedStep<Method>* const first = lent.copy(1, steps);
    const auto all = static_cast<std::int64_t>(steps.size());
    for (std::int64_t done = 0; done < all; done += steps_of_a_launch)
      lent.run({SharedMotions{.motions = motions,
                              .count = count,
                              .method = Method::id,
                              .steps = first + done,
                              .step_count = std::min(steps_of_a_launch, all - done)}});
  });
}

void run_own(Lent& lent, std::string_view method, std::size_t at_once, const RunClient& client) {
  run_fixed<OwnMotion>(
      lent, at_once, client,
      [](const OscillatorRun& run) {
        require_near(run);
        return OwnMotion{fixed_motion(run), CosineSteps(run.system->parameters().w, run.t_end, run.h)};
      },
      [&](OwnMotion* motions, std::int64_t count) {
        OwnMotions all{.motions = motions,
                       .count = count,
                       .method = method,
                       .most_steps = steps_of_a_launch / 10,
                       .left = nullptr};
        run_to_end(lent, all, [] { return true; });
      });
}

void run_steps_of_formulas(Lent& lent, std::string_view method, const FormulasThere& formulas,
                           std::size_t at_once, const RunClient& client) {
  run_fixed<FixedFormulaMotion>(
      lent, at_once, client,
      [&](const OscillatorRun& run) {
        return FixedFormulaMotion{at_start(run.piece->system, 0, run), 1.0, FixedTimes(run.t_end, run.h),
                                  formulas.of(run)};
      },
      [&](FixedFormulaMotion* motions, std::int64_t count) {
        FormulaSteps all{.motions = motions,
                         .count = count,
                         .method = method,
                         .most_steps = steps_of_a_launch / 10,
                         .codes = formulas.codes(),
                         .left = nullptr};
        run_to_end(lent, all, [] { return true; });
      },
      in_lanes().formula_steps(method, {}));
}

}  // namespace

MotionRunner motions_on(Device& device, std::size_t at_once) {
  const auto lent = std::make_shared<Lent>(device);
  return {
      .adaptive = [lent, at_once](const AdaptiveSteps& steps) -> RunMotions {
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
      .formulas = [lent, at_once](const AdaptiveSteps& steps, const FormulaPrograms& programs) -> RunMotions {
        for (const auto& each : programs) require_arithmetic(*each);
        return [=, there = std::make_shared<const FormulasThere>(lent, programs)](const RunClient& client) {
          run_adaptive(*lent, AdaptiveFormulas{steps, *there}, at_once, client);
        };
      },
      .formula_steps =
          [lent, at_once](std::string_view method, const FormulaPrograms& programs) {
            RunMotions found;
            with_explicit_method(method, [&]<class Method>(const Method&) {
              for (const auto& each : programs) require_arithmetic(*each);
              found = [=, there = std::make_shared<const FormulasThere>(lent, programs)](
                          const RunClient& client) {
                run_steps_of_formulas(*lent, Method::id, *there, at_once, client);
              };
            });
            return found;
          },
      .is_device = true};
}

}  // namespace hmax
