/// hmax phase --method M --h H: what steps of a method make of the plane.
#include <algorithm>

#include <fmt/format.h>

#include "analysis/dynamics/fixed_point_search.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/planar.hpp"
#include "cli/phase/phase.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "limits/by_steps/one_step_map.hpp"
#include "plots/dynamics.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

using Eigen::Vector2d;

constexpr int shown_steps = 80;

/// One step of a method in the part of the plane that is looked at.
struct MapView {
  std::string method;
  double h;
  PlanarMap map;
  FixedPointSearch fixed;
  std::vector<bool> spurious{};  ///< of each fixed point
  std::vector<PeriodTwo> period_two;
};

MapView map_of(const PhaseView& view, const PhaseOptions& options) {
  if (!options.h) throw InputError("no step size is given; add --h in seconds");
  const Method method = options.method.make();
  const PlanarMap map = one_step_map(method, view.still, *options.h);
  std::vector<Vector2d> at_rest;
  for (const Equilibrium& e : view.equilibria) at_rest.push_back(e.state);
  MapView seen{.method = method.id,
               .h = *options.h,
               .map = map,
               .fixed = search_fixed_points(map, view.window, at_rest),
               .period_two = find_period_two(map, view.window)};
  for (const FixedPoint& point : seen.fixed.points)
    seen.spurious.push_back(is_spurious(view.field.rhs, seen.h, point.state, view.window));
  return seen;
}

/// What the search for fixed points is worth. Of orbits of period two nothing is guaranteed.
std::string guarantee(const PhaseView& view, const MapView& seen) {
  return guarantee(view.problem, view.window, seen.fixed, seen.fixed.points.size(),
                   {.one = "fixed point",
                    .many = "fixed points",
                    .of = "map",
                    .without = "with a multiplier of 1",
                    .border = "a fixed point lies on it, or a step from it diverges"});
}

/// The document's part that is about the map.
void add_map(const PhaseView& view, const MapView& seen, Json& document) {
  document["method"] = seen.method;
  document["h"] = seen.h;
  Json points = Json::array(), pairs = Json::array(), types = Json::array(), multipliers = Json::array();
  for (std::size_t i = 0; i < seen.fixed.points.size(); ++i) {
    const FixedPoint& point = seen.fixed.points[i];
    points.push_back({{"x", point.state(0)},
                      {"v", point.state(1)},
                      {"multipliers", eigenvalues_document(point.multipliers)},
                      {"type", name_of(point.type)},
                      {"spurious", bool(seen.spurious[i])}});
  }
  for (const PeriodTwo& orbit : seen.period_two) {
    Json both = Json::array();
    for (const Vector2d& y : orbit.states) both.push_back({y(0), y(1)});
    pairs.push_back(both);
    types.push_back(name_of(orbit.type));
    multipliers.push_back(eigenvalues_document(orbit.multipliers));
  }
  document["fixed_points"] = points;
  document["fixed_point_search"] = search_document(view.window, seen.fixed, guarantee(view, seen));
  document["period_two"] = pairs;
  document["period_two_types"] = types;
  document["period_two_multipliers"] = multipliers;
}

std::string table_of(const PhaseView& view, const MapView& seen, const Console& console) {
  std::string text = fmt::format("\none step of {}, h = {} s\n", seen.method, to_text(seen.h));
  const auto names = states_with_units(view.problem);
  TextTable table({"fixed point", "of the equation", names[0], names[1], "multipliers"});
  for (std::size_t i = 0; i < seen.fixed.points.size(); ++i) {
    const FixedPoint& point = seen.fixed.points[i];
    table.add({std::string(name_of(point.type)), seen.spurious[i] ? "no: spurious" : "yes",
               short_name(point.state(0)), short_name(point.state(1)),
               multipliers_in_words(point.multipliers)});
  }
  text += seen.fixed.points.empty() ? "" : table.text(console);
  text += guarantee(view, seen) + "\n";
  if (seen.period_two.empty()) return text + "\nno orbit of period two in the window\n";
  TextTable pairs({"period two", "between", "and", "multipliers of two steps"});
  const auto in_brackets = [](const Vector2d& y) {
    return fmt::format("({}, {})", short_name(y(0)), short_name(y(1)));
  };
  for (const PeriodTwo& orbit : seen.period_two)
    pairs.add({std::string(name_of(orbit.type)), in_brackets(orbit.states[0]), in_brackets(orbit.states[1]),
               multipliers_in_words(orbit.multipliers)});
  return text + "\n" + pairs.text(console);
}

/// The equation on the left, the method on the right, from the same starts.
Figure picture(const PhaseView& view, const MapView& seen) {
  PhasePlane plane = plane_of(view);
  plane.title = "the equation";
  const auto names = states_with_units(view.problem);
  PlaneMap map{.title = fmt::format("{}, h = {} s", seen.method, short_name(seen.h)),
               .x = names[0],
               .v = names[1],
               .x_range = plane.x_range,
               .v_range = plane.v_range};
  const Vector2d margin = view.window.size();
  for (const Vector2d& start : starts_of(view)) {
    PlaneCurve steps;
    Vector2d y = start;
    for (int step = 0; step <= shown_steps && y.allFinite(); ++step) {
      steps.push_back({y(0), y(1)});
      if (((y - view.window.lower + margin).array() < 0).any() ||
          ((view.window.upper + margin - y).array() < 0).any())
        break;
      y = seen.map(y);
    }
    map.iterates.push_back(std::move(steps));
  }
  std::size_t spurious = 0;
  for (std::size_t i = 0; i < seen.fixed.points.size(); ++i) {
    const FixedPoint& point = seen.fixed.points[i];
    map.fixed_points.push_back(
        {point.state(0), point.state(1), std::string(name_of(point.type)), seen.spurious[i]});
    spurious += seen.spurious[i];
  }
  for (const PeriodTwo& orbit : seen.period_two)
    map.period_two.push_back({{orbit.states[0](0), orbit.states[0](1)},
                              {orbit.states[1](0), orbit.states[1](1)},
                              std::string(name_of(orbit.type))});
  const auto counted = [](std::size_t count, const char* what) {
    return fmt::format("{} {}{}", count == 0 ? "no" : std::to_string(count), what, count == 1 ? "" : "s");
  };
  Panel right = map_panel(map);
  right.notes = {counted(spurious, "fixed point") + " made by the method",
                 counted(seen.period_two.size(), "orbit") + " of period two"};
  const bool places = spurious > 0, cycles = !seen.period_two.empty();
  return {.title = !places && !cycles ? "The method has the equilibria of the equation"
                                      : fmt::format("The method adds {} that the equation does not have",
                                                    !cycles   ? "places of rest"
                                                    : !places ? "cycles"
                                                              : "places of rest and cycles"),
          .panels = {phase_panel(plane), right},
          .columns = 2,
          .footer = fmt::format("{}: {}; {} steps from each start", view.problem.id,
                                describe_acting(view.problem), shown_steps),
          .panel_height = 330};
}

}  // namespace

void phase_map(const PhaseOptions& options, Console& console) {
  const PhaseView view = view_of(options);
  const MapView seen = map_of(view, options);
  Json document = document_of(view);
  add_map(view, seen, document);
  std::string text = headline(view.problem) + equilibria_table(view, console) + table_of(view, seen, console);
  if (!options.output.empty()) deliver(picture(view, seen), options, document, text, console);
  for (const std::string& remark : view.remarks) text += "\n" + remark + "\n";
  console.show(document, text);
}

}  // namespace hmax
