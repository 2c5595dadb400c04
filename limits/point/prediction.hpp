/// The answer to how large a step may be, and what integration showed of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/dynamics/coupled_motion.hpp"
#include "analysis/step_limits/stable_step.hpp"
#include "limits/point/operating_point.hpp"
#include "limits/steps/newton_step.hpp"
#include "limits/steps/step_defect.hpp"

namespace hmax {

/// What a step is limited by.
enum class Bound {
  stability,      ///< h_max is a number: beyond it a mode is amplified that the model damps or keeps
  accuracy,       ///< no step is unstable: what limits it is the error it makes
  newton,         ///< no step is unstable for the linearised model: Newton's method must still converge
  model,          ///< every mode of the model itself grows here, or no limit of the others is known
  every_step,     ///< every step is unstable, however small
  error_control,  ///< the method chooses its steps as it runs
  unknown,        ///< the analysis does not cover the pair; `note` says why
};

/// "stability", "accuracy", "newton", "model", "every_step", "error_control", "unknown".
std::string_view name_of(Bound bound);

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
  std::optional<Mode> limiting;  ///< the mode that sets it; for Bound::model the one that grows
  /// The mode of the model itself that grows fastest; h_max is then the limit of the decaying and the neutral
  /// modes.
  std::optional<Mode> growing = {};
  /// Where h_max is a lower bound: from here on a mode is known to be unstable [s]; infinity if none is.
  std::optional<double> unstable_from = {};
  std::vector<ModeMargin> modes;  ///< every mode; conjugates once
  std::optional<CoupledLimit> coupled =
      {};  ///< where the steps couple the modes: they have one limit together
  StateKind state_kind = StateKind::motion;
  std::string state;
  std::string note;
  std::optional<NewtonStep> newton_step = {};  ///< of bodies, where Newton's method sets the step
  std::optional<Observation> observed;
};

}  // namespace hmax
