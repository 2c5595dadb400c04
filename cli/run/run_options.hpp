/// What the options of `hmax run` ask for.
#pragma once

#include <optional>
#include <string>

#include "catalogue/methods/method.hpp"
#include "catalogue/methods/run.hpp"
#include "cli/bodies/body_picture.hpp"
#include "cli/run/checkpoint_option.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/device_option.hpp"

namespace hmax {

/// The options as they are given; times and steps in seconds.
struct RunOptions {
  ProblemChoice problem;
  MethodChoice method;
  std::optional<double> h, rtol, atol, h0, h_max, t_start, t_end, every, newton_tolerance;
  std::string newton_iterations;
  std::string control, jacobian, linear, output, max_steps;
  bool full = false;
  PictureChoice picture;
  CheckpointChoice checkpoint;
  DeviceChoice device;
  const CLI::Option* jobs = nullptr;
};

/// A file of formulas may start at any time and end before it; of others the end is checked with the run.
/// @throws InputError  as make_problem(), and for times that are not finite
Problem problem_of(const RunOptions& options);

/// The step, the tolerances and the solver of a run of `problem`.
/// @throws InputError  for options that are missing, contradict each other or are out of range
RunSpec spec_of(const RunOptions& options, const Problem& problem);

}  // namespace hmax
