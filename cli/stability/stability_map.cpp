/// hmax stability map
#include "studies/stability_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "analysis/dynamics/phase_plane.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/models/model.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/shared/work_limit.hpp"
#include "cli/stability/limit_words.hpp"
#include "cli/stability/stability.hpp"
#include "core/errors.hpp"
#include "core/parallel_for.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "plots/curves.hpp"
#include "plots/draw.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

using Eigen::Vector2d;

struct MapOptions {
  ProblemChoice problem;
  MethodsChoice methods;
  std::string x, y, output;
  bool log_x = false, log_y = false, rayleigh = false;
  std::optional<double> time_limit;
};

Json to_json(const MapAxis& axis) { return {HMAX_KEYS(axis, name, values, logarithmic)}; }

Json to_json(const StabilityMap& map) {
  Json rows = Json::array();
  for (std::size_t row = 0; row < map.y.values.size(); ++row) {
    Json cells = Json::array();
    for (std::size_t column = 0; column < map.x.values.size(); ++column)
      cells.push_back(number_or_word(map.at(column, row)));
    rows.push_back(std::move(cells));
  }
  Json document{{"method", map.method},
                {"x", to_json(map.x)},
                {"y", to_json(map.y)},
                {"h_max", std::move(rows)},
                {"falling_share_x", map.falling_share_x()},
                {"falling_share_y", map.falling_share_y()}};
  if (!map.note.empty()) document["status"] = map.note;
  return document;
}

// ---- the picture

/// Where a value of an axis stands on paper.
double on_paper(const MapAxis& axis, double value) { return axis.logarithmic ? std::log(value) : value; }
double from_paper(const MapAxis& axis, double place) { return axis.logarithmic ? std::exp(place) : place; }

/// The index of the interval of an axis in which a place lies, and how far in it.
std::pair<std::size_t, double> interval_of(const MapAxis& axis, double place) {
  const double low = on_paper(axis, axis.values.front()), high = on_paper(axis, axis.values.back());
  const auto last = axis.values.size() - 1;
  const double at = std::clamp((place - low) / (high - low), 0.0, 1.0) * static_cast<double>(last);
  const std::size_t i = std::min(static_cast<std::size_t>(at), last - 1);
  return {i, at - static_cast<double>(i)};
}

/// h_max between the points of the map, bilinear on paper; not finite beside points that are not.
double between(const StabilityMap& map, const Vector2d& place) {
  const auto [i, u] = interval_of(map.x, place(0));
  const auto [j, v] = interval_of(map.y, place(1));
  return (1 - v) * ((1 - u) * map.at(i, j) + u * map.at(i + 1, j)) +
         v * ((1 - u) * map.at(i, j + 1) + u * map.at(i + 1, j + 1));
}

/// A handful of round numbers between the smallest and the largest step of all maps.
std::vector<double> levels_of(const std::vector<StabilityMap>& maps) {
  std::vector<double> finite;
  for (const StabilityMap& map : maps)
    for (const double h : map.h_max)
      if (std::isfinite(h) && h > 0) finite.push_back(h);
  if (finite.empty()) return {};
  std::ranges::sort(finite);
  const double low = finite[finite.size() / 50], high = finite[finite.size() - 1 - finite.size() / 50];
  std::vector<double> levels;
  for (int power = static_cast<int>(std::floor(std::log10(low))); std::pow(10, power) < high; ++power)
    for (const double digit : {1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0})
      if (const double level = digit * std::pow(10, power); low < level && level < high)
        levels.push_back(level);
  std::vector<double> few;
  const std::size_t stride = levels.size() / 8 + 1;
  for (std::size_t i = stride / 2; i < levels.size(); i += stride) few.push_back(levels[i]);
  return few;
}

/// Cells between neighbouring points that have a property, those of a row that belong together as one
/// rectangle.
template <class Has>
Area cells_with(const StabilityMap& map, const std::string& label, int colour, const Has& has) {
  Area area{.label = label, .colour = colour};
  const std::vector<double>&x = map.x.values, &y = map.y.values;
  for (std::size_t row = 0; row + 1 < y.size(); ++row)
    for (std::size_t column = 0; column + 1 < x.size();) {
      if (!has(column, row)) {
        ++column;
        continue;
      }
      std::size_t end = column + 1;
      while (end + 1 < x.size() && has(end, row)) ++end;
      area.x.push_back((x[column] + x[end]) / 2);
      area.w.push_back(x[end] - x[column]);
      area.y.push_back((y[row] + y[row + 1]) / 2);
      area.h.push_back(1.04 * (y[row + 1] - y[row]));
      column = end;
    }
  return area;
}

Panel panel_of(const StabilityMap& map, const std::vector<double>& levels,
               const std::array<std::string, 2>& labels) {
  Panel panel{.title = map.method,
              .x = {.label = labels[0],
                    .logarithmic = map.x.logarithmic,
                    .range = Range{map.x.values.front(), map.x.values.back()}},
              .y = {.label = labels[1],
                    .logarithmic = map.y.logarithmic,
                    .range = Range{map.y.values.front(), map.y.values.back()}}};
  constexpr int orange = 4, sky = 5, grey = 7;
  for (Area area : {cells_with(map, "more " + map.x.name + " shrinks the step", orange,
                               [&](std::size_t i, std::size_t j) { return map.falls_along_x(i, j); }),
                    cells_with(map, "every step is stable", sky,
                               [&](std::size_t i, std::size_t j) { return std::isinf(map.at(i, j)); }),
                    cells_with(map, "no step is stable, or the model has no rest", grey,
                               [&](std::size_t i, std::size_t j) {
                                 // Between such a point and the next nothing is known either.
                                 return !(map.at(i, j) > 0) || !(map.at(i + 1, j) > 0) ||
                                        !(map.at(i, j + 1) > 0) || !(map.at(i + 1, j + 1) > 0);
                               })})
    if (!area.x.empty()) panel.areas.push_back(std::move(area));

  const Window window{{on_paper(map.x, map.x.values.front()), on_paper(map.y, map.y.values.front())},
                      {on_paper(map.x, map.x.values.back()), on_paper(map.y, map.y.values.back())}};
  int k = 0;
  for (const double level : levels) {
    const PlanarField field{[&](const Vector2d& place) { return Vector2d(between(map, place) - level, 0); },
                            {}};
    for (const Polyline& line : nullcline(field, 0, window)) {
      Curve curve{.label = "h = " + short_number(level, 3) + " s", .style = family_style(k)};
      for (const Vector2d& place : line) {
        curve.x.push_back(from_paper(map.x, place(0)));
        curve.y.push_back(from_paper(map.y, place(1)));
      }
      panel.curves.push_back(std::move(curve));
    }
    ++k;
  }
  panel.notes = {fmt::format("h falls along {}: {:.1f} %, along {}: {:.1f} %", map.x.name,
                             100 * map.falling_share_x(), map.y.name, 100 * map.falling_share_y())};
  return panel;
}

Figure picture(const std::vector<StabilityMap>& maps, const MapOptions& options, const Problem& problem,
               const std::string& footer) {
  const bool shrinks =
      std::ranges::any_of(maps, [](const StabilityMap& m) { return m.falling_share_x() > 0; });
  Figure figure{.title = shrinks ? fmt::format("In the shaded parts more {} shrinks the largest stable step",
                                               maps.front().x.name)
                                 : "The largest stable step over two parameters",
                .columns = maps.size() > 1 ? 2 : 1,
                .footer = footer,
                .panel_height = maps.size() > 1 ? 360 : 420};
  const std::array<std::string, 2> labels =
      options.rayleigh ? std::array<std::string, 2>{"alpha [1/s]", "beta [s]"}
                       : std::array<std::string, 2>{with_unit(problem, maps.front().x.name),
                                                    with_unit(problem, maps.front().y.name)};
  const std::vector<double> levels = levels_of(maps);
  for (const StabilityMap& map : maps) figure.panels.push_back(panel_of(map, levels, labels));
  return figure;
}

// ---- the subcommand

/// Maps of some methods over the same axes.
struct MapStudy {
  MapAxis x, y;
  Problem bare;  ///< where the axes vary nothing
  std::vector<StabilityMap> maps{};
  std::optional<std::string> figure{};
};

/// The axes, which have to be given and to fit together.
std::pair<MapAxis, MapAxis> axes_of(const MapOptions& options) {
  for (const auto& [name, text, example] :
       {std::tuple{"--x", &options.x, options.rayleigh ? "alpha=0:2:41" : "c=0:10:81"},
        {"--y", &options.y, options.rayleigh ? "beta=0:0.5:41" : "k1=0.1:10:61"}})
    if (text->empty())
      throw InputError(
          fmt::format("{} is missing; give its values, for instance {} {}", name, name, example));
  MapAxis x = map_axis("--x", options.x, options.log_x), y = map_axis("--y", options.y, options.log_y);
  if (options.rayleigh && (x.name != "alpha" || y.name != "beta"))
    throw InputError(
        fmt::format("with --rayleigh x is alpha and y is beta, but they are called {} and {}; write --x "
                    "alpha=0:2:41 --y beta=0:0.5:41",
                    x.name, y.name));
  return {std::move(x), std::move(y)};
}

/// The first point says what each of them takes. Ctrl-C ends the program at once here.
void check_length(const MapOptions& options, const MapStudy& study, const ProblemAt& problem_at,
                  const std::vector<Method>& methods) {
  const double limit = time_limit_of(options.time_limit);
  constexpr std::size_t few = 10'000;  // that take a second
  const std::size_t points = study.x.values.size() * study.y.values.size();
  if (!study.bare.body && points * methods.size() <= few) return;
  const double seconds = seconds_of([&] {
    const Linearised near = linearised(problem_at(study.x.values.front(), study.y.values.front()));
    for (const Method& method : methods) predict(method, near);
  });
  refuse_endless(
      {.asked = fmt::format("a map of {} x {} points", study.x.values.size(), study.y.values.size()),
       .count = static_cast<double>(points),
       .of = "linearisations",
       .seconds_each = seconds / static_cast<double>(jobs()),
       .most_seconds = limit,
       .remedy = "take fewer values of --x and --y, or raise --time-limit"});
}

MapStudy study_of(const MapOptions& options, Console& console) {
  auto [x, y] = axes_of(options);
  MapStudy study{.x = std::move(x), .y = std::move(y), .bare = options.problem.make()};
  options.problem.refuse_varied(study.x.name, "--x");
  options.problem.refuse_varied(study.y.name, "--y");
  const ProblemSettings settings = options.problem.settings();
  const ProblemAt problem_at = options.rayleigh
                                   ? over_rayleigh(options.problem.id(), settings)
                                   : over_parameters(options.problem.id(), settings, study.x, study.y);
  const std::vector<Method> methods = options.methods.methods({study.bare}, console);
  check_length(options, study, problem_at, methods);
  Progress progress(console, "map");
  study.maps = stability_maps(methods, problem_at, study.x, study.y, progress.watcher());
  return study;
}

std::string drawn(const MapStudy& study, const MapOptions& options, Console& console) {
  // What the axes vary is no constant.
  Parameters fixed = study.bare.parameters;
  std::erase_if(fixed, [&](const auto& entry) {
    return entry.first == study.x.name || entry.first == study.y.name ||
           (options.rayleigh && entry.first == "c");
  });
  return drawn_svg(
      picture(study.maps, options, study.bare, fmt::format("{}: {}", study.bare.id, describe(fixed))),
      options.output, "map", console);
}

Json to_json(const MapStudy& study) {
  Json documents = Json::array();
  for (const StabilityMap& each : study.maps) {
    Json document = to_json(each);
    if (study.figure) document["figure"] = json_or_null(*study.figure);
    documents.push_back(std::move(document));
  }
  return documents.size() == 1 ? documents.front() : documents;
}

std::string in_words(const MapStudy& study, const Console& console) {
  TextTable table({"method", "smallest h [s]", "largest h [s]", "falls along " + study.x.name,
                   "falls along " + study.y.name});
  std::string remarks;
  for (const StabilityMap& each : study.maps) {
    double least = std::numeric_limits<double>::quiet_NaN(), most = least;
    for (const double h : each.h_max) {
      least = std::fmin(least, h);
      most = std::fmax(most, h);
    }
    table.add({each.method, step_words(least), step_words(most),
               fmt::format("{:.1f} %", 100 * each.falling_share_x()),
               fmt::format("{:.1f} %", 100 * each.falling_share_y())});
    if (!each.note.empty()) remarks += fmt::format("{}: at some points: {}\n", each.method, each.note);
  }
  std::string text = table.text(console) +
                     fmt::format(
                         "\n{} x {} points of {}. falls: between that share of neighbours the largest "
                         "stable step gets smaller.\n",
                         study.x.values.size(), study.y.values.size(), study.bare.id) +
                     remarks;
  if (study.figure && !study.figure->empty()) text += fmt::format("The figure: {}\n", *study.figure);
  return text;
}

void map(const MapOptions& options, Console& console) {
  check_figure(options.output, "map");
  MapStudy study = study_of(options, console);
  remark_unusual(console, study.bare);
  options.problem.remark_idle(console, study.bare);
  if (!options.output.empty()) study.figure = drawn(study, options, console);
  console.show(to_json(study), in_words(study, console));
}

}  // namespace

void add_stability_map(CLI::App& stability, Console& console) {
  const auto [command, options] = add_command(
      stability, console, "map", "Map the largest stable step over two parameters, or over Rayleigh damping",
      {"hmax stability map --problem liver_linear --method rk4,newmark --x c=0:10:41 --y k1=0.1:10:31",
       "hmax stability map --problem liver_linear --method rk4 --rayleigh --x alpha=0.01:10:21 --y "
       "beta=0.01:10:21 --log-x --log-y --output results/runs/map"},
      map);
  options.problem.add_to(command);
  options.methods.add_to(command);
  add_text(command, "--x", options.x, "Parameter of the horizontal axis and its values, like c=0:10:81",
           "NAME=FROM:TO:COUNT");
  add_text(command, "--y", options.y, "Parameter of the vertical axis and its values, like k1=0.1:10:61",
           "NAME=FROM:TO:COUNT");
  add_flag(command, "--log-x", options.log_x, "Logarithmic x axis");
  add_flag(command, "--log-y", options.log_y, "Logarithmic y axis");
  add_flag(command, "--rayleigh", options.rayleigh,
           "Rayleigh damping c = alpha m + beta k1: x is alpha in 1/s, y is beta in s");
  add_time_limit(command, options.time_limit);
  add_text(command, "--output", options.output, "Draw map.svg, map.png and map.pdf into this folder",
           "FOLDER");
  add_force(command);
  add_jobs(command);
  add_figure_style(command);
}

}  // namespace hmax
