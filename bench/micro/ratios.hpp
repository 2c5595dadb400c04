/// From the times of all engines to a table of ratios.
#pragma once

#include <string>
#include <vector>

#include "bench/micro/engine.hpp"

namespace hmax::micro {

/// One engine at one setting.
struct Measurement {
  Engine engine;
  double setting;    ///< h or rtol
  double error = 0;  ///< global error: largest |x|, |v| error over all accepted steps
  double steps = 0, evaluations = 0;
  std::vector<double> seconds = {};  ///< CPU time of one run, one entry per repetition
};

/// A Markdown table: the fastest engine of hmax over the fastest one of Odeint, per step for fixed tasks, at
/// equal global error for adaptive ones, each with its goal.
std::string ratio_table(const std::vector<Measurement>& measurements);

}  // namespace hmax::micro
