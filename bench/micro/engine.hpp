/// One way of one side to do one task, as the micro-benchmarks see it.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "problems/oscillator/oscillator.hpp"

namespace hmax::micro {

/// The state of both sides at the boundary, (x, v).
using Point = std::array<double, 2>;

/// What is compared. Fixed tasks are set by h, adaptive ones by rtol = atol.
enum class Task { rk4_fixed, dormand_prince_fixed, order_8_fixed, dormand_prince_adaptive, order_8_adaptive };

/// Called with t and y after every accepted step.
using Watcher = std::function<void(double, const Point&)>;

struct Engine {
  Task task;
  std::string side;  ///< "hmax" or "odeint"
  std::string name;  ///< what the side calls it

  /// Integrates the model over [0, t_end]; y is the initial state, then the last one.
  void (*run)(const Oscillator& model, double t_end, double setting, Point& y);

  /// The same under observation.
  /// @returns the number of evaluations of f
  long (*watched)(const Oscillator& model, double t_end, double setting, Point y, const Watcher& watcher);
};

/// The sides stand in sources of their own, each compiled with the flags that suit it best.
std::vector<Engine> hmax_engines();
std::vector<Engine> odeint_engines();

}  // namespace hmax::micro
