/// The largest stable step of a method on a problem, predicted from spectrum and amplification.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/coupled_motion.hpp"
#include "analysis/curve_limit.hpp"
#include "analysis/linear_model.hpp"
#include "analysis/spectrum.hpp"
#include "analysis/stable_step.hpp"
#include "bench/catalogue.hpp"
#include "bench/newton_step.hpp"
#include "bench/step_defect.hpp"

namespace hmax {

/// What a step is limited by.
enum class Bound {
  stability,      ///< h_max is a number: beyond it a mode is amplified that the model damps or keeps
  accuracy,       ///< no step is unstable: what limits it is the error it makes
  newton,         ///< no step is unstable for the linearised model: Newton's method must still converge
  model,          ///< the model itself grows here: no step makes it stable
  every_step,     ///< every step is unstable, however small
  error_control,  ///< the method chooses its steps as it runs
  unknown,        ///< the analysis does not cover the pair; `note` says why
};

/// "stability", "accuracy", "newton", "model", "every_step", "error_control", "unknown".
std::string_view name_of(Bound bound);

/// Degrees of freedom up to which all modes are computed, where their motion decouples.
inline constexpr Eigen::Index most_dense_modes = 1500;

class SlowEnd;
struct ModeRange;

/// Which state of a body its linear model is asked for.
enum class OperatingPoint { equilibrium, rest };

/// Called with |F| / |F(0)| of each iterate while a static equilibrium is searched for.
using EquilibriumWatcher = std::function<void(double residual)>;

/// The model whose limits are asked for: a problem near a state.
struct Linearised {
  LinearModel model;
  Spectrum spectrum;  ///< all of it, or with `curve` the modes at its ends
  /// Of proportionally damped models of more than most_dense_modes degrees of freedom.
  std::optional<DampingCurve> curve = {};
  /// Where the slow end of the curve is only bounded by 0, what finds it.
  std::shared_ptr<SlowEnd> slow_end = {};
  /// Of the fastest mode of a body at rest with a curve, of length 1 in the norm of M, shape (dofs); else
  /// empty.
  Eigen::VectorXd fastest_shape = {};
  /// Of models whose damping couples more degrees of freedom than most_dense_coupled; `spectrum` then lists
  /// the largest eigenvalues.
  std::shared_ptr<ModeRange> range = {};
  bool at_equilibrium = false;
  std::string_view state_kind = "motion";  ///< or "equilibrium", "rest" of a body, "initial"
  std::string state;                       ///< in words: which state, whose Jacobian
  std::string status;                      ///< why it is not the state that was asked for
  std::string missing = {};                ///< says that a tool does not touch the body in this state
};

/// Whether nothing loads a body at rest: its forces are nothing beside those that rounding of its points
/// makes.
bool is_at_rest(const TissueBody& body);

/// A problem near its equilibrium, found by Newton's method from its initial state with time standing still
/// at 0, or for a body at equilibrium_time() (bench/body_balance.hpp); near the initial state itself where
/// there is none, which `status` then says. Above most_cheaply_factored degrees of freedom the equations of a
/// body are solved by conjugate gradients.
/// @param at  rest: a body without displacement, whatever loads it
/// @throws InputError  as linearise()
Linearised linearised(const Problem& problem, OperatingPoint at = OperatingPoint::equilibrium,
                      const EquilibriumWatcher& watcher = {});
/// The same without its spectrum.
Linearised without_spectrum(const Problem& problem, OperatingPoint at = OperatingPoint::equilibrium,
                            const EquilibriumWatcher& watcher = {});
LinearModel linear_model(const Problem& problem, double t, const Eigen::VectorXd& y);
/// Whether the Jacobian depends on the state, so that limits are those of small motions; bodies are not
/// asked, as all but those of small strains are.
bool is_nonlinear(const Problem& problem);
/// Near a state of its own.
Linearised linearised(const Problem& problem, double t, const Eigen::VectorXd& y);

/// The margin of one mode.
struct ModeMargin {
  Mode mode;
  double h_max = 0;            ///< of this mode alone [s]; NaN where the steps couple it with others
  Eigenmode told{Complex(0)};  ///< as the method is told of it: its stiff part, the spectral radius
};

/// What integration showed.
struct Observation {
  double h_max = 0;        ///< [s]; infinity where even a step far beyond every time scale does not grow
  double gap = 0;          ///< (observed - predicted) / predicted; NaN without a number on both sides
  std::int64_t steps = 0;  ///< of each run
  bool agrees = false;     ///< bounded below the prediction, growing above it
  /// Does not agree for a reason that the note of the row says, and that is no mistake of the prediction.
  bool excused = false;
  double step_defect = 0;  ///< how far steps of the code are from what is analysed, as of step_defect.hpp

  /// Whether both confirm the prediction: the limit, and steps that show errors too small to move it.
  [[nodiscard]] bool confirms() const { return agrees && has_steps_of_analysis(); }
  /// Whether they show that something is wrong.
  [[nodiscard]] bool contradicts() const { return !has_steps_of_analysis() || (!agrees && !excused); }
  [[nodiscard]] bool has_steps_of_analysis() const { return step_defect <= rounding_of_steps; }
};

/// One row of the answer.
struct Prediction {
  std::string problem, material, method;
  std::vector<std::pair<std::string, double>> parameters;
  Bound bound = Bound::unknown;
  std::optional<double> h_max;   ///< [s]; infinity for accuracy and newton; nothing where there is no answer
  std::optional<Mode> limiting;  ///< the mode that sets it, or that grows
  /// Where h_max is a lower bound: from here on a mode is known to be unstable [s]; infinity if none is.
  std::optional<double> unstable_from = {};
  std::vector<ModeMargin> modes;  ///< every mode; conjugates once
  std::optional<CoupledLimit> coupled =
      {};                       ///< where the steps couple the modes: they have one limit together
  std::string_view state_kind;  ///< as of Linearised
  std::string state;
  std::string note;
  std::optional<NewtonStep> newton_step = {};  ///< of bodies, where Newton's method sets the step
  std::optional<Observation> observed;
};

/// Degrees of freedom of a mesh up to which a factor of K takes less than a second.
inline constexpr Eigen::Index most_cheaply_factored = 20'000;

/// Predicts for one method.
/// @param near  the problem linearised, as by linearised(problem)
Prediction predict(const Method& method, const Problem& problem, const Linearised& near);

}  // namespace hmax
