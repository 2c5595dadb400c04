/// Motions of many oscillators at a time: what is run, and its running side by side in the lanes of the
/// vector registers. Each motion is what it is alone, to the last bit.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/phase_plane.hpp"
#include "analysis/dynamics/trap.hpp"
#include "core/instructions/instruction_set.hpp"
#include "integrators/control.hpp"
#include "integrators/stepper.hpp"
#include "integrators/tolerances.hpp"
#include "problems/formula_program.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// Formulas as a System of the plane.
struct PlanarFormulas {
  using State = Eigen::Vector2d;
  static constexpr double forever = std::numeric_limits<double>::infinity();

  std::shared_ptr<const FormulaProgram> program;
  bool autonomous;                       ///< whether they do not know the time
  double from = -forever, to = forever;  ///< see confine()

  [[nodiscard]] Eigen::Index dim() const { return 2; }
  [[nodiscard]] bool is_autonomous() const { return autonomous; }
  void rhs(double t, const State& y, State& dydt) const {
    program->run(std::clamp(t, from, to), y.data(), dydt.data());
  }
  /// As AnySystem.
  void confine(double first, double last) {
    from = first;
    to = last;
  }
};

/// A motion of formulas, or what of it lies between two of their breakpoints (integrators/breakpoints.hpp).
struct FormulaPiece {
  PlanarFormulas system;  ///< confined to the piece
  Span<double> span;      ///< of the piece; fixed steps begin at 0
  double whole;           ///< [s] length of the motion, which bounds adaptive steps
};

/// A motion from t = 0 on, or a piece of one.
struct OscillatorRun {
  const Oscillator* system;                ///< null of formulas
  double t_end;                            ///< [s], positive
  Eigen::Vector2d y;                       ///< its start, then its end
  Outcome outcome = Outcome::reached_end;  ///< how it has ended
  double h = 0;                            ///< [s], positive: of fixed steps of its own
  const FormulaPiece* piece = nullptr;     ///< of formulas; it ends at t_end
  std::int64_t attempts = 0;  ///< of adaptive steps; formulas begin with those of the pieces before
};

/// Where runs come from and where they go.
struct RunClient {
  /// The next run, which stays in its place until it has ended; null where there is none, maybe until another
  /// one has ended.
  std::function<OscillatorRun*()> next;
  /// A run has its end and its outcome.
  std::function<void(OscillatorRun& run)> ended;
};

/// Runs all that a client has. Called by several threads at once, each with a client of its own.
using RunMotions = std::function<void(const RunClient& client)>;

/// Where runs end as `stopped`.
struct Arrival {
  std::vector<NumberedTrap> traps;
  Window window;

  [[nodiscard]] FateRule rule() const {
    const Eigen::Vector2d size = window.size();
    return {
        traps.data(), static_cast<int>(traps.size()), {window.lower[0], window.lower[1]}, {size[0], size[1]}};
  }
};

/// Runs as integrate() does with dop_853 and a DeadbandController, each with a step control and a time of its
/// own.
struct AdaptiveSteps {
  Tolerances<double> tolerances;
  std::int64_t most_attempts;  ///< of a run, after which it ends as too_many_steps
  bool steady;                 ///< no force of any run changes in time: no cosine is computed
  std::optional<Arrival> arrival = {};
  const std::atomic<bool>* interrupted =
      nullptr;  ///< ends all runs once it is true: where they end is open then

  [[nodiscard]] bool are_interrupted() const {
    return interrupted && interrupted->load(std::memory_order_relaxed);
  }
};

/// Steps of one size by a method of tableaux::All. All motions stand at the same time, so the cosines of the
/// force are computed once, beforehand.
struct SharedSteps {
  std::string_view method;  ///< its id
  double w;                 ///< of the forces of all runs [rad/s]
  double t_end, h;          ///< [s], positive; of all runs
};

/// Those that runs have.
using FormulaPrograms = std::vector<std::shared_ptr<const FormulaProgram>>;

/// What runs motions: the lanes of the processor, or a device. The motions are the same, to the last bit.
struct MotionRunner {
  std::function<RunMotions(const AdaptiveSteps&)> adaptive;
  std::function<RunMotions(const SharedSteps&)> shared;  ///< empty where it is no such method
  /// Fixed steps of each run's own size and w by such a method; no function where runs go one by one.
  std::function<RunMotions(std::string_view method)> own_steps = {};
  /// Adaptive steps of formulas.
  std::function<RunMotions(const AdaptiveSteps&, const FormulaPrograms&)> formulas = {};
  /// Fixed steps of each run's own size; empty where it is no such method.
  std::function<RunMotions(std::string_view method, const FormulaPrograms&)> formula_steps = {};
  const std::atomic<bool>* interrupted = nullptr;  ///< of AdaptiveSteps of basins
  bool is_device = false;
};

/// Runs in the lanes of the processor. A lane whose adaptive run has ended takes the next one; where there is
/// none it takes that of the last lane, so that those that are left stand side by side.
/// @param set  of the vector operations; it changes times, not motions
MotionRunner in_lanes(InstructionSet set = instruction_sets().front());

}  // namespace hmax
