/// hmax phase --poincare and --bifurcation: driven problems, seen once in each period of the force.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/discrete_map.hpp"
#include "analysis/poincare.hpp"
#include "bench/planar.hpp"
#include "cli/phase.hpp"
#include "plots/dynamics.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr std::int64_t most_periods = 10'000'000;

/// How many periods are seen, and how many pass before.
struct Looks {
  int count, skip;
};

Looks looks_of(const PhaseOptions& options, int count) {
  const auto number = [](const char* what, const std::string& text, int otherwise, std::int64_t least) {
    const std::int64_t value = text.empty() ? otherwise : parse_count(what, text, least);
    if (value > most_periods)
      throw InputError(
          fmt::format("{} is {}, more than the limit of {}; take fewer", what, value, most_periods));
    return static_cast<int>(value);
  };
  return {number("--periods", options.periods, count, 1), number("--skip", options.skip, 200, 0)};
}

/// A window that holds the points and the motion through the first of them over one period.
Window around(const Problem& problem, const std::vector<VectorXd>& points, double period) {
  constexpr double everywhere = 1e300;
  const auto names = axis_names(problem);
  const Window plane{Vector2d::Constant(-everywhere), Vector2d::Constant(everywhere)};
  Window window = window_around({orbit(problem, points[0], period, plane, everywhere)}, names[0], names[1],
                                std::vector<Vector2d>(points.begin(), points.end()), 0.3);
  for (Eigen::Index i = 0; i < 2; ++i)  // at rest to rounding
    if (window.size()(i) < 1e-6) {
      window.lower(i) -= 0.5;
      window.upper(i) += 0.5;
    }
  return window;
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

struct Section {
  double drive_period;
  Looks looks;
  std::vector<VectorXd> points;
  std::optional<int> period;  ///< in periods of the force
  double lyapunov;            ///< [1/s], NaN when the motion diverges
  std::vector<FixedPoint> periodic;
};

Section section_of(const Problem& problem, const PhaseOptions& options) {
  Section section{.drive_period = drive_period(problem, options.period),
                  .looks = looks_of(options, 2000),
                  .points = {},
                  .period = {},
                  .lyapunov = std::nan(""),
                  .periodic = {}};
  const VectorFunction map = stroboscope(problem, section.drive_period);
  section.points = looks(map, problem.y0, section.looks.skip, section.looks.count);
  if (static_cast<int>(section.points.size()) < section.looks.count) return section;
  section.period = period_of(section.points);
  const Window window = around(problem, section.points, section.drive_period);
  const int measured = std::min(section.looks.count, 2000);
  section.lyapunov = largest_lyapunov(map, section.points[0], window.size(), measured) / section.drive_period;
  section.periodic = find_fixed_points(map, {window.lower, window.upper}, 7);
  return section;
}

/// What the section says, as a sentence.
std::string verdict(const Section& section) {
  if (static_cast<int>(section.points.size()) < section.looks.count)
    return fmt::format(
        "the motion diverges within {} periods of the force; take other parameters or another y0",
        section.looks.skip + section.looks.count);
  if (section.period == 1) return "the motion has the period of the force";
  if (section.period) return fmt::format("the motion repeats after {} periods of the force", *section.period);
  if (section.lyapunov > 0)
    return fmt::format(
        "the motion does not repeat within {} periods, and neighbours part as exp({} t): it is chaotic",
        section.looks.count / 4, short_name(section.lyapunov));
  return "the motion has not settled, or takes many periods to repeat; raise --skip";
}

Figure picture(const Problem& problem, const Section& section) {
  const auto names = axis_names(problem);
  Panel panel{.title = "", .x = {names[0]}, .y = {names[1]}};
  std::vector<double> x, v;
  for (const VectorXd& y : section.points) {
    x.push_back(y(0));
    v.push_back(y(1));
  }
  const int shown = section.period.value_or(0);
  if (shown > 0 && shown <= 12) {
    x.resize(static_cast<std::size_t>(shown));
    v.resize(static_cast<std::size_t>(shown));
    const Table way = orbit(problem, section.points[0], shown * section.drive_period,
                            around(problem, section.points, section.drive_period), 1e9);
    panel.curves.push_back(
        {.label = "motion", .x = way.values[0], .y = way.values[1], .style = {.colour = 7, .width = 1.2}});
  }
  panel.curves.push_back(cloud("once in each period of the force", x, v));
  for (const FixedPoint& point : section.periodic)
    panel.marks.push_back({point.state(0),
                           point.state(1),
                           {.colour = 1, .marker = marker_of(std::string(name_of(point.type)))},
                           "repeats after one period, " + in_words(std::string(name_of(point.type)))});
  std::string title = verdict(section);
  title = title.substr(0, title.find(','));
  title[0] = 'T';
  return {.title = title,
          .panels = {panel},
          .footer = fmt::format("{}: {}; {} looks after {} periods of {} s", problem.id,
                                describe(problem.parameters), section.looks.count, section.looks.skip,
                                short_name(section.drive_period)),
          .panel_height = 440};
}

/// The values of --from ... --to.
std::vector<double> values_of(const PhaseOptions& options) {
  if (!options.from || !options.to)
    throw InputError("a bifurcation diagram needs --from and --to, the ends of the parameter");
  const auto count = static_cast<int>(
      options.points.empty() ? 200
                             : std::min<std::int64_t>(parse_count("--points", options.points, 2), 100'000));
  if (!std::isfinite(*options.from) || !std::isfinite(*options.to) || *options.from == *options.to)
    throw InputError(
        fmt::format("the parameter goes from {} to {}, which is no range; give --from and --to two "
                    "different finite numbers",
                    to_text(*options.from), to_text(*options.to)));
  std::vector<double> values;
  for (int i = 0; i < count; ++i)
    values.push_back(std::lerp(*options.from, *options.to, double(i) / (count - 1)));
  return values;
}

/// The problem with another value of a parameter.
Problem with_value(ProblemChoice choice, const std::string& parameter, double value) {
  choice.set.push_back(parameter + "=" + to_text(value));
  return choice.make();
}

/// The stretches of the parameter over which the motion repeats after the same number of periods.
struct Stretch {
  double from, to;
  std::string what;
};

std::vector<Stretch> stretches(const std::vector<BifurcationColumn>& columns, int count) {
  std::vector<Stretch> found;
  for (const BifurcationColumn& column : columns) {
    const std::string what = static_cast<int>(column.looks.size()) < count ? "diverges"
                             : column.period                               ? std::to_string(*column.period)
                                                                           : "does not repeat";
    if (found.empty() || found.back().what != what)
      found.push_back({column.value, column.value, what});
    else
      found.back().to = column.value;
  }
  return found;
}

}  // namespace

void phase_poincare(const PhaseOptions& options, Console& console) {
  const Problem problem = options.problem.make();
  const Section section = section_of(problem, options);
  const std::string words = verdict(section);
  Json document = document_of(problem);
  Json points = Json::array(), periodic = Json::array();
  for (const VectorXd& y : section.points) points.push_back({y(0), y(1)});
  for (const FixedPoint& point : section.periodic)
    periodic.push_back({{"x", point.state(0)},
                        {"v", point.state(1)},
                        {"multipliers", to_json({point.multipliers[0], point.multipliers[1]})},
                        {"type", name_of(point.type)}});
  document["drive_period"] = section.drive_period;
  document["skip"] = section.looks.skip;
  document["section"] = points;
  document["period"] = section.period ? Json(*section.period) : Json();
  document["lyapunov"] = number_or_null(section.lyapunov);
  document["periodic"] = periodic;
  document["status"] = words;

  std::string text = headline(problem);
  text += fmt::format("seen every {} s, {} times after {} periods\n\n{}\n", short_name(section.drive_period),
                      section.points.size(), section.looks.skip, console.strong(words));
  const auto names = axis_names(problem);
  if (section.period && *section.period <= 12) {
    TextTable table({"look", names[0], names[1]});
    for (int i = 0; i < *section.period; ++i)
      table.add({std::to_string(i + 1), short_number(section.points[static_cast<std::size_t>(i)](0), 10),
                 short_number(section.points[static_cast<std::size_t>(i)](1), 10)});
    text += "\n" + table.text(console);
  }
  if (!section.periodic.empty()) {
    TextTable table({"repeats after one period", names[0], names[1], "multipliers"});
    for (const FixedPoint& point : section.periodic)
      table.add({std::string(name_of(point.type)), short_name(point.state(0)), short_name(point.state(1)),
                 in_words({point.multipliers[0], point.multipliers[1]})});
    text += "\n" + table.text(console);
  }
  if (std::isfinite(section.lyapunov))
    text += fmt::format("\nlargest Lyapunov exponent {} 1/s\n", short_name(section.lyapunov));
  if (!options.output.empty() && !section.points.empty())
    deliver(picture(problem, section), options, "poincare", document, text, console);
  if (static_cast<int>(section.points.size()) < section.looks.count) console.exit_code = Exit::failed;
  if (console.json) return console.print_json(document);
  console.print(text);
}

void phase_bifurcation(const PhaseOptions& options, Console& console) {
  const std::vector<double> values = values_of(options);
  const std::string& name = options.bifurcation;
  const Problem first = with_value(options.problem, name, values.front());
  const Looks seen = looks_of(options, 64);
  // Where the parameter takes the force away, the looks keep the period that it has beside.
  const auto period_of_force = [&](const Problem& problem) {
    if (!options.period && !is_driven(problem))
      for (const double value : values)
        if (const Problem other = with_value(options.problem, name, value); is_driven(other))
          return drive_period(other, {});
    return drive_period(problem, options.period);
  };
  const auto map_at = [&](double value) {
    const Problem problem = with_value(options.problem, name, value);
    return stroboscope(problem, period_of_force(problem));
  };
  Progress progress(console, "bifurcation");
  const auto& interrupted = interrupt_flag();
  const auto columns =
      bifurcation(map_at, values, first.y0, seen.skip, seen.count, options.follow, [&](double share) {
        progress.update(share);
        return !interrupted;
      });
  if (interrupted) throw Interrupted{};

  Json document = document_of(first);
  document["parameters"].erase(name);
  Json list = Json::array();
  std::vector<double> at, x;
  std::vector<double> once_at, once_x;
  for (const BifurcationColumn& column : columns) {
    Json xs = Json::array();
    for (const VectorXd& y : column.looks) xs.push_back(y(0));
    const bool repeats = column.period.has_value();
    const std::size_t shown = repeats ? static_cast<std::size_t>(*column.period) : column.looks.size();
    for (std::size_t i = 0; i < shown; ++i) {
      (repeats ? once_at : at).push_back(column.value);
      (repeats ? once_x : x).push_back(column.looks[i](0));
    }
    list.push_back({{"value", column.value},
                    {"x", xs},
                    {"period", repeats ? Json(*column.period) : Json()},
                    {"diverged", static_cast<int>(column.looks.size()) < seen.count}});
  }
  document["parameter"] = name;
  document["skip"] = seen.skip;
  document["follow"] = options.follow;
  document["columns"] = list;

  std::string text = headline(first) + "\n";
  TextTable table({"repeats after", name + " from", "to"});
  for (const Stretch& stretch : stretches(columns, seen.count))
    table.add({stretch.what, short_name(stretch.from), short_name(stretch.to)});
  text += table.text(console);
  if (!options.output.empty()) {
    const auto names = axis_names(first);
    Panel panel{.title = "", .x = {name}, .y = {names[0] + " once in each period of the force"}};
    if (!x.empty()) panel.curves.push_back(cloud("does not repeat", at, x, 1));
    if (!once_x.empty()) panel.curves.push_back(cloud("repeats", once_at, once_x, 0));
    for (Curve& curve : panel.curves) curve.style.size = 0.3;
    std::string parameters;
    for (const auto& [parameter, value] : first.parameters)
      if (parameter != name) parameters += fmt::format(" {}={}", parameter, to_text(value));
    deliver({.title = fmt::format("{}: what the motion settles to, over {}", first.id, name),
             .panels = {panel},
             .footer = fmt::format(
                 "{}{}; {} looks after {} periods, {}", first.id, parameters, seen.count, seen.skip,
                 options.follow ? "each value from where the one before has ended"
                                : fmt::format("each value from y0 = {}", describe(first.y0))),
             .panel_height = 440},
            options, "bifurcation", document, text, console);
  }
  if (console.json) return console.print_json(document);
  console.print(text);
}

}  // namespace hmax
