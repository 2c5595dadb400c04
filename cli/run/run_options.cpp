#include "cli/run/run_options.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "catalogue/models/problems.hpp"
#include "cli/shared/options.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {
/// The first and the longest step of an adaptive run.
void set_step_bounds(const RunOptions& options, RunSpec& spec) {
  if (!options.h0 && !options.h_max) return;
  if (!spec.adaptive)
    throw InputError(
        "--h0 and --h-max are for adaptive runs; remove them, or give --rtol and --atol instead of --h");
  for (const auto& [name, value] : {std::pair{"--h0", options.h0}, std::pair{"--h-max", options.h_max}})
    if (value && !(*value > 0 && std::isfinite(*value)))
      throw InputError(
          fmt::format("{} is {} but must be a number of seconds above 0", name, to_text(*value)));
  if (options.h0 && options.h_max && *options.h0 > *options.h_max)
    throw InputError(fmt::format("--h0 is {}, above --h-max {}; give a first step of at most --h-max",
                                 to_text(*options.h0), to_text(*options.h_max)));
  if (options.h0 && *options.h0 > spec.t_end)
    throw InputError(fmt::format("--h0 is {}, above the length of the run, {}; give a shorter first step",
                                 to_text(*options.h0), to_text(spec.t_end)));
  spec.h_first = options.h0.value_or(spec.h_first);
  spec.h_max = options.h_max.value_or(spec.h_max);
}

}  // namespace

Problem problem_of(const RunOptions& options) {
  const std::string id = options.problem.id();
  ProblemSettings settings = options.problem.settings();
  for (const auto& [name, value] :
       {std::pair{"--t-start", options.t_start}, std::pair{"--t-end", options.t_end}})
    if (value && !std::isfinite(*value))
      throw InputError(fmt::format("{} is {} but must be a finite number of seconds", name, to_text(*value)));
  settings.t0 = options.t_start;
  if (problem_kind(id) == ProblemKind::formulas) settings.t_end = options.t_end;
  return make_problem(id, settings);
}

RunSpec spec_of(const RunOptions& options, const Problem& problem) {
  if (options.h && (options.rtol || options.atol))
    throw InputError("--h and tolerances are both given; take --h for fixed steps, or --rtol and --atol");
  if (!options.h && !options.rtol && !options.atol)
    throw InputError(
        "no step is given; take --h for fixed steps, see `hmax stability predict`, or --rtol and --atol for adaptive "
        "ones");
  if (!options.h && !(options.rtol && options.atol))
    throw InputError(fmt::format("{} is missing; an adaptive run needs both --rtol and --atol",
                                 options.rtol ? "--atol" : "--rtol"));
  if (options.h && !options.control.empty())
    throw InputError("--control is for adaptive runs; remove it, or give --rtol and --atol instead of --h");
  RunSpec spec{.t_end = options.t_end ? problem.shown.own_time(*options.t_end) : problem.t_end,
               .adaptive = !options.h,
               .h = options.h.value_or(0),
               .rtol = options.rtol.value_or(0),
               .atol = options.atol.value_or(0)};
  set_step_bounds(options, spec);
  if (!options.control.empty()) spec.control = controllers_from(options.control);
  if (!options.jacobian.empty()) spec.jacobian = jacobian_update_from(options.jacobian);
  if (!options.linear.empty()) spec.linear_solve = linear_solve_from(options.linear);
  if (options.newton_tolerance) {
    if (!(*options.newton_tolerance > 0 && *options.newton_tolerance < 1))
      throw InputError(fmt::format("--newton-tolerance is {} but must lie between 0 and 1, such as 1e-6",
                                   to_text(*options.newton_tolerance)));
    if (spec.adaptive)
      throw InputError(
          "--newton-tolerance is for fixed steps; adaptive runs solve to a share of --rtol and --atol");
    spec.newton.tolerance = *options.newton_tolerance;
  }
  if (!options.newton_iterations.empty())
    spec.newton.iterations = static_cast<int>(
        std::min<std::int64_t>(parse_count("--newton-iterations", options.newton_iterations, 1), 1'000'000));
  if (spec.adaptive) spec.max_steps = adaptive_attempts;
  if (!options.max_steps.empty()) spec.max_steps = parse_count("--max-steps", options.max_steps, 1);
  return spec;
}

}  // namespace hmax
