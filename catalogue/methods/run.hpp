/// One run as the catalogue sees it: what is asked, what came out. No types of systems or methods appear
/// here.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "integrators/implicit/jacobian.hpp"
#include "integrators/implicit/newton_settings.hpp"
#include "integrators/linear/linear_solve.hpp"
#include "integrators/stats.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// How the step of an adaptive run is steered.
enum class Controllers { i, pi, deadband, matlab };

/// Their words on the command line and in stored rows, in the order of the enumerators.
inline constexpr std::array<std::string_view, 4> controller_names{"i", "pi", "deadband", "matlab"};

std::string_view to_string(Controllers control);
/// @throws InputError with a suggestion when the word is none of controller_names
Controllers controllers_from(std::string_view word);

/// The Jacobian policy as users write it: auto, exact, every:K or frozen.
std::string to_string(JacobianUpdate update);
/// @throws InputError with a suggestion when the word is none of these
JacobianUpdate jacobian_update_from(std::string_view word);

/// How symmetric sparse equations are solved, as users write it: auto, direct, cg, cg:TOLERANCE or
/// cg:TOLERANCE,ITERATIONS.
std::string to_string(LinearSolve choice);
/// @throws InputError with a suggestion when the word is none of these
LinearSolve linear_solve_from(std::string_view word);

/// What is asked of one run.
struct RunSpec {
  double t_end = 0;  ///< from t = 0 [s]
  bool adaptive = false;
  double h = 0;               ///< fixed step [s]; not read when adaptive
  double rtol = 0, atol = 0;  ///< not read when fixed
  double h_first = 0;         ///< of an adaptive run [s]; 0: chosen from the right-hand side
  double h_max =
      std::numeric_limits<double>::infinity();  ///< of an adaptive run [s]; infinity: a tenth of the span
  Controllers control = Controllers::deadband;
  JacobianUpdate jacobian{};   ///< read by methods that linearise
  NewtonSettings newton{};     ///< read by methods that iterate
  LinearSolve linear_solve{};  ///< of symmetric sparse equations, which second-order systems lead to
  double every = 0;            ///< output interval [s]; 0: none, the sink then sees every accepted step
  /// Of runs on a device, whose states must be read: every so many-th step is seen, and the last one.
  std::int64_t seen_every = 1;
  ImplicitWork* work = nullptr;  ///< where a run leaves, before each call of its sink, what was done so far
  std::int64_t max_steps = 1'000'000'000;
};

/// Sees points of the solution in order of time, the initial one first; y has shape (dim).
using Sink = std::function<void(double t, const Eigen::Ref<const Eigen::VectorXd>& y)>;

/// What came out of one run.
struct RunRecord {
  Outcome outcome = Outcome::reached_end;
  double t = 0;        ///< of the last accepted state, or where it diverged [s]
  Eigen::VectorXd y;   ///< last accepted state, shape (dim)
  double t_state = t;  ///< when that was: before t where the run diverged [s]
  Stats stats;
  std::string_view note{};  ///< why equations were not solved; a foreign engine's own words for a failure
};

/// One method bound to one problem: three erased calls, each a whole integration in the typed world.
struct Runner {
  /// Runs once, counting evaluations; the sink may be empty.
  std::function<RunRecord(const RunSpec&, const Sink&)> run;

  /// Runs `runs` >= 1 times from the initial state with nobody counting. With `every`, output points are
  /// written to memory that is kept between calls. For timing: nothing is allocated in a call that repeats an
  /// earlier one, but for the stages of states of dynamic size.
  /// @returns the last accepted state of the last run, shape (dim); valid until the next call
  std::function<const Eigen::VectorXd&(const RunSpec&, std::int64_t runs)> repeat;

  /// The time that runs have taken so far by the clock of their device [s]; null: they take CPU time.
  std::function<double()> seconds{};

  /// End state of a fixed-step run in long double, shape (dim); null where that does not exist.
  std::function<Eigen::Vector<long double, Eigen::Dynamic>(double h, double t_end)> end_state_extended;
};

}  // namespace hmax
