/// Predicted against observed step limits of every method on every model of the liver study.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/limits/predict.hpp"
#include "bench/limits/trajectory_limit.hpp"

namespace hmax {

/// A model of the study.
struct LimitCase {
  std::string label;  ///< "male_slim:light", "c = 0.3 N s/m"
  std::string family;
  Problem problem;
  bool linear = true;
};

/// The six material sets at both ends of their masses, then every curve of the study's figures 2 to 7 with
/// numbers of its own.
std::vector<LimitCase> limit_cases();

struct LimitRow {
  std::size_t which;  ///< case
  Prediction prediction;
};

/// Every method on every linear case, verified, on all cores.
/// @param progress  told the share that is done; from the calling thread
/// @param interrupted  asked between rows; what is finished is returned
std::vector<LimitRow> predicted_and_observed(const std::vector<LimitCase>& cases,
                                             const std::vector<Method>& methods,
                                             const std::function<void(double)>& progress,
                                             const std::function<bool()>& interrupted);

/// A nonlinear or driven case: three predictions and two observations of one method.
struct NonlinearRow {
  std::size_t which;
  std::string method;
  Prediction at_rest;                    ///< and what small motions about rest show
  std::optional<TrajectoryLimit> along;  ///< of the tangent along the motion from the published start
  std::optional<double> from_start;      ///< observed from there
};

std::vector<NonlinearRow> nonlinear_limits(const std::vector<LimitCase>& cases,
                                           const std::vector<Method>& methods,
                                           const std::function<void(double)>& progress,
                                           const std::function<bool()>& interrupted);

}  // namespace hmax
