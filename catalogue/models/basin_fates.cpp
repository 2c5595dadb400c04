/// The fates of starts in the plane, one by one or many side by side.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/planar.hpp"
#include "integrators/control.hpp"
#include "integrators/ensemble/lane_rk.hpp"
#include "integrators/ensemble/lane_runs.hpp"
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
using Lanes = LaneRk<tableaux::Dop853, Vector2d, 32>;
using Norm = RmsNorm<double>;
using Attempt = void (*)(Lanes&, const Oscillator&);

constexpr Norm norm{basin_tolerances.rtol, basin_tolerances.atol};

[[gnu::always_inline]] inline void attempt(Lanes& lanes, const Oscillator& system) {
  const double force = system.at(0);
  lanes.attempt([&](auto, std::size_t, const Vector2d& y, Vector2d& dydt)
                    __attribute__((always_inline)) { system.rhs_at(force, y, dydt); });
  lanes.weigh(norm);
}

// The attribute compiles these bodies alone, with all they call, for their instruction set: inline functions
// that other code shares keep the instructions that every processor has.
[[gnu::flatten]] void attempt_portable(Lanes& lanes, const Oscillator& system) { attempt(lanes, system); }
#ifdef __x86_64__
[[gnu::flatten, gnu::target("avx2")]] void attempt_avx2(Lanes& lanes, const Oscillator& system) {
  attempt(lanes, system);
}
[[gnu::flatten, gnu::target("avx512f,avx512vl")]] void attempt_avx512(Lanes& lanes,
                                                                      const Oscillator& system) {
  attempt(lanes, system);
}
#endif

Attempt attempt_of([[maybe_unused]] InstructionSet set) {
#ifdef __x86_64__
  if (set == InstructionSet::avx512) return attempt_avx512;
  if (set == InstructionSet::avx2) return attempt_avx2;
#endif
  return attempt_portable;
}

/// Runs of many starts, as LaneRuns asks for them.
class FateRuns {
 public:
  using Control = Adaptive<double, DeadbandController>;

  FateRuns(const Oscillator& system, const Destiny& destiny, InstructionSet set)
      : system_(system), destiny_(destiny), attempt_(attempt_of(set)) {}

  void operator()(std::span<const Vector2d> starts, std::span<int> fates) {
    starts_ = starts;
    fates_ = fates;
    next_ = 0;
    LaneRuns<Lanes, Control> runs(adaptive_attempts);
    runs(*this, lanes_, system_);
  }

  /// The next start whose fate takes steps.
  std::optional<Control> begin(std::size_t lane) {
    for (; next_ < starts_.size(); ++next_) {
      const Vector2d& y = starts_[next_];
      fates_[next_] = is_bounded(y) ? destiny_.of(y) : unbounded;
      if (fates_[next_] != undecided) continue;
      Vector2d slope;
      system_.rhs(0, y, slope);
      lanes_.start(lane, y, slope);
      number_[lane] = next_++;
      Control control(basin_tolerances, tableaux::Dop853::error_order);
      control.start(lanes_, system_, {0, destiny_.longest}, y);
      return control;
    }
    return std::nullopt;
  }
  void attempt() { attempt_(lanes_, system_); }
  void move(std::size_t from, std::size_t to) { number_[to] = number_[from]; }
  bool is_over(std::size_t lane, const Vector2d& y) {
    return (fates_[number_[lane]] = destiny_.of(y)) != undecided;
  }
  void end(std::size_t lane, Outcome outcome, const Vector2d& /*y*/) {
    if (outcome == Outcome::diverged || outcome == Outcome::step_too_small) fates_[number_[lane]] = unbounded;
  }

 private:
  Oscillator system_;
  Destiny destiny_;
  Attempt attempt_;
  Lanes lanes_;
  std::array<std::size_t, Lanes::lanes> number_{};  ///< of the start in each lane
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
    return [runs = std::make_shared<FateRuns>(*oscillator, Destiny(problem, window, equilibria), set)](
               std::span<const Vector2d> starts, std::span<int> fates) { (*runs)(starts, fates); };
  return [fate_of = fate_of_starts(problem, window, equilibria)](std::span<const Vector2d> starts,
                                                                 std::span<int> fates) {
    std::ranges::transform(starts, fates.begin(), fate_of);
  };
}

}  // namespace hmax
