#include "studies/stability_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>

#include <fmt/format.h>

#include "catalogue/models/model.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/parallel_for.hpp"
#include "core/process/memory_share.hpp"
#include "limits/predict.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// Whether a step shrinks from one point to the next: no step of any size is the largest of all.
bool falls(double from, double to) { return to < from * (1 - 1e-9); }

double falling_share(const StabilityMap& map, std::size_t right, std::size_t up) {
  std::size_t pairs = 0, falling = 0;
  for (std::size_t row = 0; row + up < map.y.values.size(); ++row)
    for (std::size_t column = 0; column + right < map.x.values.size(); ++column) {
      const double here = map.at(column, row), there = map.at(column + right, row + up);
      if (std::isnan(here) || std::isnan(there)) continue;
      ++pairs;
      falling += falls(here, there);
    }
  return pairs > 0 ? static_cast<double>(falling) / static_cast<double>(pairs) : 0;
}

double value_of(const Problem& problem, std::string_view name) {
  const auto it = std::ranges::find(problem.parameters, name, [](const auto& entry) { return entry.first; });
  if (problem.body)
    throw InputError(
        fmt::format("alpha and beta of {} are parameters of its own; leave --rayleigh out", problem.id));
  if (it == problem.parameters.end())
    throw InputError(
        fmt::format("{} has no {}, so no plane of Rayleigh's damping c = alpha m + beta k1; take a liver "
                    "oscillator, like liver_linear",
                    problem.id, name));
  return it->second;
}

}  // namespace

MapAxis map_axis(std::string_view option, std::string_view text, bool logarithmic) {
  const std::size_t equals = text.find('=');
  std::array<std::optional<double>, 3> numbers;
  if (equals != std::string_view::npos) {
    std::string_view rest = text.substr(equals + 1);
    for (std::optional<double>& number : numbers) {
      const std::size_t colon = std::min(rest.find(':'), rest.size());
      number = to_number(rest.substr(0, colon));
      rest.remove_prefix(std::min(colon + 1, rest.size()));
    }
    if (!rest.empty()) numbers.back().reset();
  }
  const auto& [first, last, count] = numbers;
  if (equals == 0 || !first || !last || !count || !std::isfinite(*first) || !std::isfinite(*last) ||
      !(*first < *last) || !(*count >= 2 && *count <= 2000) || *count != std::floor(*count))
    throw InputError(
        fmt::format("{} {} is no axis; write name=from:to:count with from below to and a count from 2 to "
                    "2000, like c=0:10:81",
                    option, text));
  if (logarithmic && !(*first > 0))
    throw InputError(
        fmt::format("{} {} begins at {}, which has no place on a logarithmic axis; begin above 0", option,
                    text, to_text(*first)));
  MapAxis axis{std::string(text.substr(0, equals)), {}, logarithmic};
  const auto n = static_cast<std::size_t>(*count);
  for (std::size_t i = 0; i < n; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(n - 1);
    axis.values.push_back(i + 1 == n    ? *last
                          : logarithmic ? *first * std::pow(*last / *first, share)
                                        : *first + share * (*last - *first));
  }
  return axis;
}

bool StabilityMap::falls_along_x(std::size_t column, std::size_t row) const {
  return falls(at(column, row), at(column + 1, row));
}
double StabilityMap::falling_share_x() const { return falling_share(*this, 1, 0); }
double StabilityMap::falling_share_y() const { return falling_share(*this, 0, 1); }

std::vector<StabilityMap> stability_maps(const std::vector<Method>& methods, const ProblemAt& problem_at,
                                         const MapAxis& x, const MapAxis& y,
                                         const std::function<void(double share)>& progress) {
  const std::size_t columns = x.values.size(), points = columns * y.values.size();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<StabilityMap> maps;
  for (const Method& method : methods)
    maps.push_back({.method = method.id, .x = x, .y = y, .h_max = std::vector<double>(points, nan)});
  std::vector<std::size_t> noted(methods.size(), points);  // the point that the note is of
  std::mutex notes;
  const auto note = [&](std::size_t method, std::size_t point, const std::string& text) {
    if (text.empty()) return;
    const std::scoped_lock lock(notes);
    if (point >= noted[method]) return;
    noted[method] = point;
    maps[method].note = text;
  };
  const auto predict_at = [&](std::size_t point, std::size_t) {
    const Problem problem = problem_at(x.values[point % columns], y.values[point / columns]);
    // It may be factored for its equilibrium.
    const MemoryShare memory(bytes_of_factor(static_cast<double>(unknowns_of(problem))));
    const Linearised near = linearised(problem);
    // Without an equilibrium the limit would be that of another state than at the other points.
    const bool lost = near.point.is_body && !near.point.at_equilibrium;
    for (std::size_t i = 0; i < methods.size(); ++i) {
      const Prediction prediction = lost ? Prediction{} : predict(methods[i], near);
      maps[i].h_max[point] = prediction.h_max.value_or(nan);
      if (!prediction.h_max || prediction.growing) note(i, point, lost ? near.point.state : prediction.note);
      note(i, point, near.point.missing);
    }
  };
  const auto tell = [&](std::size_t done) {
    if (progress) progress(static_cast<double>(done) / static_cast<double>(points));
  };
  tell(0);
  parallel_for(points, predict_at, tell, [] { return false; });
  return maps;
}

ProblemAt over_parameters(std::string problem, ProblemSettings settings, const MapAxis& x, const MapAxis& y) {
  if (x.name == y.name) throw InputError(fmt::format("--x and --y are both {}; give two parameters", x.name));
  for (const MapAxis* axis : {&x, &y}) settings.parameters.emplace_back(axis->name, axis->values.front());
  return [problem = std::move(problem), settings = std::move(settings)](double at_x, double at_y) {
    ProblemSettings here = settings;
    const std::size_t n = here.parameters.size();
    here.parameters[n - 2].second = at_x;
    here.parameters[n - 1].second = at_y;
    return make_problem(problem, here);
  };
}

ProblemAt over_rayleigh(std::string problem, ProblemSettings settings) {
  const Problem bare = make_problem(problem, settings);
  const double m = value_of(bare, "m"), k1 = value_of(bare, "k1");
  value_of(bare, "c");
  settings.parameters.emplace_back("c", 0);
  return [problem = std::move(problem), settings = std::move(settings), m, k1](double alpha, double beta) {
    ProblemSettings here = settings;
    here.parameters.back().second = alpha * m + beta * k1;
    return make_problem(problem, here);
  };
}

}  // namespace hmax
