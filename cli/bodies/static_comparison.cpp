#include "cli/bodies/static_comparison.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "core/numbers.hpp"
#include "core/parallel_for.hpp"

namespace hmax {

std::vector<StaticWay> all_ways(const StaticModel& model, StaticSettings settings) {
  const OneThread alone;
  std::vector<StaticWay> ways;
  for (const StaticMethod method : {StaticMethod::newton, StaticMethod::modified_newton})
    for (const InnerSolver inner :
         {InnerSolver::direct, InnerSolver::conjugate_gradients, InnerSolver::sor}) {
      settings.method = method;
      settings.inner = inner;
      ways.push_back({method, inner, solve_static(model, settings, thread_cpu_seconds)});
    }
  return ways;
}

std::string iterations_in_words(const StaticSettings& settings) {
  return fmt::format("cg and sor solve linear systems to {}; relaxation of sor {}",
                     settings.inner_tolerance ? to_text(*settings.inner_tolerance)
                                              : "1e-4, in Newton's method as far as it needs",
                     to_text(settings.relaxation));
}

Figure residual_figure(const std::vector<StaticWay>& ways, const std::string& title,
                       const std::string& footer) {
  constexpr std::array markers{7, 9, 5};  // of the inner solvers
  Panel iterations{.title = "against iterations",
                   .x = {.label = "iteration [1]"},
                   .y = {.label = "|F| / |load| [1]", .logarithmic = true}};
  Panel times{.title = "against time",
              .x = {.label = "CPU time [s]", .logarithmic = true},
              .y = {.label = "|F| / |load| [1]", .logarithmic = true}};
  std::size_t longest = 0;
  for (const StaticWay& way : ways) longest = std::max(longest, way.solution.history.size());
  // Newton's ten iterations beside the hundreds of the modified method.
  if (longest > 60) iterations.x = {.label = "iteration, the start as 1 [1]", .logarithmic = true};
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const StaticWay& way = ways[k];
    const bool modified = way.method == StaticMethod::modified_newton;
    const auto inner = static_cast<std::size_t>(k % markers.size());
    Curve curve{.label = fmt::format("{}, {}{}", modified ? "modified Newton" : "Newton", name_of(way.inner),
                                     way.solution.converged ? "" : ": no equilibrium"),
                .style = {.colour = static_cast<int>(inner),
                          .dash = modified ? 1 : 0,
                          .marker = markers[inner] - (modified ? 1 : 0),
                          .size = 0.7}};
    Curve over_time = curve;
    for (std::size_t i = 0; i < way.solution.history.size(); ++i) {
      const StaticIterate& iterate = way.solution.history[i];
      curve.x.push_back(iterate.iteration + (longest > 60 ? 1 : 0));
      curve.y.push_back(iterate.residual);
      if (i == 0) continue;  // nothing has been solved yet
      over_time.x.push_back(iterate.seconds);
      over_time.y.push_back(iterate.residual);
    }
    if (curve.x.size() > 30) curve.style.marker = over_time.style.marker = 0;
    iterations.curves.push_back(std::move(curve));
    times.curves.push_back(std::move(over_time));
  }
  return {.title = title,
          .panels = {std::move(iterations), std::move(times)},
          .columns = 2,
          .footer = footer,
          .panel_height = 320};
}

}  // namespace hmax
