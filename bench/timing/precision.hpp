/// Work-precision: what an error costs, over tolerances or steps.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/timing/reference.hpp"
#include "bench/timing/sweep.hpp"

namespace hmax {

/// What is compared; the numbers that are absent are filled in by precision_sweep().
struct PrecisionSpec {
  SweepProblem problem;
  std::vector<std::string> methods;  ///< as of choose_methods
  std::vector<double> rtol;          ///< of methods with an error estimate; empty: 1e-3, 1e-4 ... 1e-12
  std::vector<double> h;             ///< of methods without one [s]; empty: t_end / 2^5, 2^7 ... 2^17
  double atol_over_rtol = 1;
  std::optional<double> t_end;  ///< [s]; absent: the problem's own
  Controllers control = Controllers::deadband;
  int repeats = 9;
  double budget_s = 0.5;  ///< as of SweepSpec
};

/// Which error of a run is looked at.
enum class ErrorOf {
  end,
  largest,          ///< at any accepted step
  root_mean_square  ///< over time
};

/// The sweep that measures it: adaptive runs over the tolerances, fixed steps of the methods that know no
/// other.
SweepSpec precision_sweep(const PrecisionSpec& spec);

/// "largest error of any state, x [m] or v [m/s], at the end": what the errors of sweeps are of.
std::string error_in_words(const Problem& problem, ErrorOf which);

/// The largest step at which `method` is stable on `problem` as its stability function and the spectrum of
/// the Jacobian say, [s]: the smallest over times along the reference. Empty where one of them is not known;
/// infinity where no step is unstable.
std::optional<double> predicted_step_limit(const Method& method, const Problem& problem,
                                           const Reference& reference, double t_end);

}  // namespace hmax
