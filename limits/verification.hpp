/// Predicted limits beside what integration with the code itself shows.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/dynamics/growth.hpp"
#include "catalogue/methods/method.hpp"
#include "limits/modes/mode_start.hpp"
#include "limits/point/operating_point.hpp"
#include "limits/point/prediction.hpp"

namespace hmax {

/// Integrates the problem with the code of the method on both sides of the prediction, from the limiting mode
/// plus a seeded perturbation, and puts what it shows into the row; `bound` becomes `newton` where the
/// equations of steps without limit are not solved. Nothing where there is no number to verify (methods that
/// choose their steps, growing models, models without a mode that moves); a `note` where runs would take too
/// much: driven models of many states, dense factors of large Jacobians.
/// @param watch  called at every step; may throw, which ends the runs and leaves the row as it was; may be
/// empty
void verify(Prediction& row, const Method& method, const Problem& problem, const Linearised& near,
            const std::function<void()>& watch = {});

/// Steps of a method without a limit that are run.
struct FarSteps {
  std::vector<double> h;  ///< [s], rising
  std::int64_t most = 0;  ///< steps of the last h; 100 of the others
  std::string note{};     ///< what is left out; may be empty
};
/// Of a structure whose steps take long.
/// @param fastest  |lambda| of the fastest mode [1/s]
FarSteps short_far_steps(double fastest);

/// About what the runs of a verification, or from a start, take [bytes]: states, the factors of an implicit
/// method, and where a force drives the problem its motion, state by state.
double memory_of_runs(const Method& method, const Problem& problem);

/// Whether a force moves a model that is not linear away from its state.
/// @param free  the problem after its ramps
bool driven_away(const Linearised& near, const Problem& free);

/// What runs have shown.
struct Finding {
  Observation seen{};
  std::string why{};      ///< it does not agree
  std::string note{};     ///< what was left out
  bool unsolved = false;  ///< the equations of steps without limit were not solved

  /// Gives a reason for which runs do not agree, and that is no mistake of the prediction.
  void excuse(std::string reason);
  /// The same where the runs are of other states than the prediction: there is no gap.
  void excuse_states(std::string reason);
  /// That of driven_away().
  void excuse_drive();
};

/// Whether runs of fixed steps can show what a row says.
bool has_claim(const Prediction& row, const Method& method);

/// Puts into a row with a claim what runs from `start` show of it.
/// @param far  where the row has no limit
void verify_from(const ModeStart& start, const ShowSteps& run, Prediction& row, const Method& method,
                 const Linearised& near, const FarSteps& far);

/// Runs of the real code from rest + displacement, shown step by step. Where time drives the problem a run
/// from rest is taken off: what is left moves as the free model does.
/// @param outcome  of the last run
/// @param spec     what runs are asked for besides h and their length
ShowSteps steps_of(const Method& method, const Problem& problem, const Eigen::VectorXd& rest,
                   const Eigen::VectorXd& displacement, const std::shared_ptr<Outcome>& outcome,
                   const RunSpec& spec = {});

/// The steps at which a method without a limit is run: far beyond every time scale, and before them, of
/// bodies, those that simulators take.
std::vector<double> steps_without_limit(const Problem& problem, double farthest);

/// Why runs are not worth their time, or would show something else; empty where they are.
/// @param free  the problem after its ramps
std::string why_not_verified(const Method& method, const Problem& free, const Linearised& near);

}  // namespace hmax
