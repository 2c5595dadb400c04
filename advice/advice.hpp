/// A question for an integrator and a step size, and the answer to it.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "advice/load_margin.hpp"
#include "advice/motion/candidate.hpp"
#include "advice/motion/motion_limits.hpp"
#include "advice/motion/motion_run.hpp"
#include "advice/motion/uncertainty.hpp"
#include "advice/motion/user_motion.hpp"
#include "advice/proof.hpp"
#include "catalogue/device/device.hpp"
#include "catalogue/models/equilibria/support_advice.hpp"
#include "results/advice_record.hpp"

namespace hmax {

struct AdviceQuestion {
  double rate = 0;                 ///< frames a second [Hz]
  double tolerance = 0.01;         ///< error of the motion, relative to its largest displacement
  std::optional<double> budget{};  ///< CPU time of a frame [s]; the whole frame where there is none
  bool least_error = false;        ///< rank by error within the budget, not by cost within the tolerance
  std::size_t frames = 1000;       ///< that the best methods are timed for
  double within = std::numeric_limits<double>::infinity();  ///< elapsed time of the answer [s]
  bool material = true;  ///< also what the steps of rows show of the material of a body
  double proof = 60;  ///< simulated seconds that the recommended row must hold for; fewer of slow models [s]
  std::vector<Method> methods{};       ///< to choose from
  std::optional<UserMotion> motion{};  ///< in place of the probing motion
  /// That runs all motions of methods that it can, in times of its own; null: the processor. The methods to
  /// choose from are on it.
  std::shared_ptr<Device> device{};

  [[nodiscard]] double frame() const { return 1 / rate; }
  [[nodiscard]] double frame_budget() const { return budget.value_or(frame()); }
};

/// What keeps the step of a row from being longer: the words of `hmax advise --json`.
enum class AdviceBound {
  stability,  ///< the next longer step is unstable
  accuracy,   ///< it misses the tolerance; where errors are ranked: one of half its length is no better
  newton,     ///< its equations are not solved
  budget,     ///< even this one takes more than the budget; where errors are ranked: one of half its length
              ///< would, or was not tried in time
  rate        ///< the step is a whole frame
};
enum class AdviceVerdict {
  recommended,
  tie,
  suitable,
  unstable,
  inaccurate,
  too_slow,
  predicted  ///< the motion was not run
};
std::string_view name_of(AdviceBound bound);
std::string_view name_of(AdviceVerdict verdict);

/// What errors are relative to, in words.
std::string error_scale(const Problem& problem);

/// A candidate at the longest of its steps that holds and meets the tolerance; at the last one that was tried
/// where none does.
struct AdviceRow : StepFindings {
  Candidate candidate;
  std::int64_t steps_per_frame = 0;  ///< a frame is a whole number of steps
  std::int64_t least_steps = 0;      ///< the fewest of them that were seen to suffice
  bool h_max_of_start = false;       ///< that of the start alone: none is known along the motion
  bool limit_pending = false;        ///< it was not sought along the motion; h_max may be that of the start
  std::string unobserved;            ///< why runs beside a predicted limit show none
  double expected_frame = none;      ///< CPU time of a frame as first_answer() (first_answer.hpp) has it [s]
  AdviceBound bound = AdviceBound::rate;
  FrameTimes frame;                     ///< CPU time of a frame on one thread [s]
  std::size_t frames = 0, missed = 0;   ///< frames that were timed, and those over the budget
  std::size_t disturbed = 0;            ///< frames over it in one run of three alone, as MotionRun::disturbed
  std::optional<std::int64_t> memory;   ///< peak of the process while the row was tried [bytes]
  std::vector<double> damping_added;    ///< to the damping ratio of each of Advice::modes
  std::vector<double> frequency_shift;  ///< relative, of each of them
  double stiffness_shown = none;        ///< as Fidelity has it, at h; of bodies that settle
  double stiffness_ceiling = none;      ///< as Fidelity has it [Pa], where less is shown than entered
  AdviceVerdict verdict = AdviceVerdict::unstable;

  /// CPU time of a frame [s]: the median, or what is expected of a row that was not run.
  [[nodiscard]] double frame_time() const { return std::isnan(frame.p50) ? expected_frame : frame.p50; }
  /// Simulated time per CPU time.
  [[nodiscard]] double realtime_factor(double rate) const { return 1 / (rate * frame.p50); }
};

/// How many times as many steps a frame are to be tried for a tolerance, by the order of the method; twice as
/// many where the error is larger than the motion: no order tells how it falls there.
double steps_to_meet(const AdviceRow& row, double tolerance);

/// About what a frame takes with so many [s].
double time_to_meet(const AdviceRow& row, double tolerance);

/// A change of the model or the question under which a row becomes suitable; it was run.
struct Remedy {
  std::string change;  ///< "budget_ms", "rate", "mend", "tetrahedra", or a parameter such as "rho"
  double from = 0, to = 0;
  std::string cost = {};    ///< what it brings about besides, in words; may be empty
  std::string method = {};  ///< as Candidate::words()
  double h = 0;             ///< [s]
};

/// How far a search is; each stage has what those before it find.
enum class AdviceStage {
  predicting,  ///< limits near the initial state, and the time of single steps
  searching,   ///< the steps of the candidates
  timing,      ///< frames of the best rows
  proving,     ///< long runs of the best row
  observing,   ///< runs beside the limits of the rows that suit, and with larger loads
  remedies,    ///< changes under which something would suit, where nothing does
  done
};
/// "predicting", ...
std::string_view name_of(AdviceStage stage);

/// The body of a question with the first model whose elements resist inversion, on the same motion.
struct OtherModel {
  std::string_view id;
  double load_share = 1, gravity_share = 1;  ///< as Advice has them
  double scale = 0;                          ///< the largest displacement of the motion [m]
  std::optional<Inversion> inversion{};      ///< the first element that the motion inverts
};

struct Advice {
  AdviceStage stage = AdviceStage::predicting;
  bool out_of_time = false;                  ///< AdviceQuestion::within was over before the search was done
  double seconds = 0;                        ///< that it took
  std::string motion;                        ///< in words: what the probing motion is
  double load_share = 1, gravity_share = 1;  ///< that the probing motion has, as ProbingMotion
  double scale = 0;                          ///< its largest displacement [m], or largest |y_i|
  double reference_error = 0;                ///< bound, relative to the scale
  std::optional<Inversion> inversion;        ///< the first element that the motion itself inverts
  /// Sought where the motion inverts elements, or has only a part of the loads.
  std::optional<OtherModel> other_model;
  std::optional<SuggestedSupport> suggested_support;  ///< of a body whose support is the default
  double t_end = 0;                                   ///< of the motion [s]
  double stiffened = 1;          ///< how many times stiffer than at its start the motion makes the body
  std::vector<double> modes;     ///< the slowest oscillations at the start, at most 3 [rad/s]
  std::vector<AdviceRow> rows;   ///< best first
  std::vector<ProofRun> proof;   ///< long runs of the recommended row
  std::vector<LimitBand> bands;  ///< of its limit
  LoadMargin load_margin;        ///< of the recommended row
  std::vector<Remedy> remedies;  ///< where nothing is recommended
  bool all_tried = true;         ///< false: the search for them ended before the last change
  std::shared_ptr<const AnalysedModel> model;  ///< its motion and limits; null before they are known

  /// The first row, if it is recommended.
  [[nodiscard]] const AdviceRow* recommended() const {
    return !rows.empty() && rows.front().verdict == AdviceVerdict::recommended ? &rows.front() : nullptr;
  }
};

/// What identifies a question about a problem. The motion is the one that was found for it.
AdviceKey advice_key(const Problem& problem, const AdviceQuestion& question, const Advice& advice);

/// Every row, best first; AdviceRecord::key is left.
std::vector<AdviceRecord> advice_records(const Advice& advice);

}  // namespace hmax
