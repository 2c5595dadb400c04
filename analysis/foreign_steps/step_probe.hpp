/// The largest stable step of an engine that is known by its steps alone: from their derivative, and from
/// running it.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "analysis/foreign_steps/foreign_stepper.hpp"
#include "analysis/foreign_steps/step_kinks.hpp"
#include "analysis/foreign_steps/step_shares.hpp"
#include "analysis/foreign_steps/step_spectrum.hpp"

namespace hmax {

struct ProbeSettings {
  double h0 = 0, h1 = 0;           ///< [s] the step sizes that are looked at, 0 < h0 <= h1
  std::optional<double> motion{};  ///< [s]: growth over the motion of this length instead of that of one step
  int rows = 12;                   ///< step sizes from h0 to h1, in equal ratios
  double resolution = 1e-4;        ///< of the limits, relative
  bool observe = true;             ///< run the engine on both sides of the limit
  double seconds_a_run = 2;        ///< CPU time of one of these runs, about
  /// What is estimated to take longer is refused.
  double most_seconds = std::numeric_limits<double>::infinity();
  StepSpectrumSettings spectrum{};
  /// Told now and then what is done; may throw.
  std::function<void(double share, std::string_view detail)> watch = {};
};

enum class ProbedState { equilibrium, initial, motion };
std::string_view name_of(ProbedState state);

struct ProbedLimit {
  std::string model;
  Eigen::Index dim = 0;
  ProbedState state = ProbedState::initial;
  /// Of a step at rest: at a kink `rows` and h_max are those of one_sided_growth(); at a jump h_max is NaN.
  StepSmoothness smoothness = StepSmoothness::smooth;
  double h1 = 0;                   ///< [s] the largest step size that was looked at
  std::vector<StepSpectrum> rows;  ///< by h, with the steps of the bisection
  double h_max = 0;  ///< [s]; infinity without growth up to h1, NaN where steps of h0 grow already
  std::optional<StepSpectrum> critical{};  ///< a step 0.2 % beyond the limit
  std::vector<Eigen::Index> moving{};      ///< numbers of the state that move most in its growing mode
  std::vector<PartShare> shares{};         ///< of each part of the engine, at `critical`; empty: not known
  double observed = 0;                     ///< [s] by runs; as h_max; NaN where nothing was run
  double gap = 0;                          ///< (observed - h_max) / h_max; NaN without a number on both sides
  std::int64_t steps = 0;                  ///< of each of the runs
  /// h_max and observed are apart by more than 5 %, along a motion by more than 20 %: one of them is wrong,
  /// or the runs are too short. `status` has a sentence. Not of an initial state, which runs leave.
  bool contradiction = false;
  /// That a step is judged by [s]: h_max, or observed at a jump, and where it contradicts h_max or is of runs
  /// that leave the state, and is smaller.
  [[nodiscard]] double limit() const {
    const bool is_apart = contradiction || state == ProbedState::initial;
    return smoothness == StepSmoothness::jump || (is_apart && observed < h_max) ? observed : h_max;
  }
  std::vector<std::string> status{};  ///< sentences: what the numbers do not tell
};

/// Numbers of the largest state that is probed: a spectrum takes some thousand steps and a basis of eighty
/// vectors.
inline constexpr Eigen::Index most_probed_numbers = 100'000;

/// About the state that the engine has now; it has this state again at the end. Slots 0 to 2 are written.
/// Step sizes from h0 to h1 in equal ratios, then bisection between the largest stable one below the first
/// that grows, and that one. Windows of instability between two of them are not seen.
/// @throws InputError  for step sizes or a start that make no sense, for more than most_probed_numbers, and
/// for
///         more than most_seconds
ProbedLimit probe_steps(ForeignStepper& engine, const ProbeSettings& settings);

/// Where steps of h0 and of h1 settle and what they make of slow motions, two `rows`, without a limit.
/// @throws InputError  as probe_steps(), and for more numbers than all eigenvalues are computed of
ProbedLimit compare_steps(ForeignStepper& engine, const ProbeSettings& settings);

}  // namespace hmax
