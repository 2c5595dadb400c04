/// hmax phase --poincare and --bifurcation: driven problems, seen once in each period of the force.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/dynamics/fixed_point_search.hpp"
#include "analysis/dynamics/poincare.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/planar.hpp"
#include "cli/phase/phase.hpp"
#include "cli/shared/work_limit.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/parallel_for.hpp"
#include "limits/by_steps/period_maps.hpp"
#include "plots/dynamics.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double most_periods = 1e7, most_values = 1e5;

/// How many periods are seen, and how many pass before.
struct Looks {
  int count, skip;
};

Looks looks_of(const PhaseOptions& options, int count) {
  const auto number = [](const char* what, const std::string& text, int otherwise, std::int64_t least) {
    const std::int64_t value = text.empty() ? otherwise : parse_count(what, text, least);
    refuse_endless({.asked = fmt::format("{} {}", what, text),
                    .count = static_cast<double>(value),
                    .of = "periods",
                    .most_count = most_periods,
                    .remedy = "take fewer"});
    return static_cast<int>(value);
  };
  return {number("--periods", options.periods, count, 1), number("--skip", options.skip, 200, 0)};
}

/// Those of --method and --h; nothing where motions are adaptive.
std::optional<FixedSteps> fixed_steps_of(const PhaseOptions& options) {
  const bool named = !options.method.method.empty() || !options.method.tableau.empty();
  if (!named && options.h)
    throw InputError("--h is a step of a method; name one with --method, or leave --h out");
  if (!named) return std::nullopt;
  if (!options.h) throw InputError("no step size is given; add --h in seconds");
  if (!(*options.h > 0 && std::isfinite(*options.h)))
    throw InputError(fmt::format("--h is {} but must be a positive number of seconds", to_text(*options.h)));
  return FixedSteps{options.method.make(), *options.h};
}

/// Adds tolerances, or method and h, of the motions: null where they have none.
void add_motions(Json& document, const std::optional<FixedSteps>& steps, const Tolerances<double>& used) {
  document["tolerances"] = steps ? Json() : to_json(used);
  document["method"] = steps ? Json(steps->method.id) : Json();
  document["h"] = steps ? Json(steps->h) : Json();
}

/// "rtol 1e-11, atol 1e-11" or "rk4, steps of at most 0.02 s"
std::string motions_in_words(const std::optional<FixedSteps>& steps, const Tolerances<double>& used) {
  return steps ? fmt::format("{}, steps of at most {} s", steps->method.id, to_text(steps->h))
               : in_words(used);
}

/// A motion, with what its size asks for.
struct Motion {
  VectorFunction map;
  std::vector<VectorXd> points;  ///< its looks; fewer than asked for where it diverges
  double size;  ///< of the last of them, or of its start where it has come to rest; 0 unknown
  Tolerances<double> tolerances;  ///< of adaptive periods
  Resolution resolution;
};

/// Looks again at finer tolerances, as long as the motion is too small for those that it was seen at.
Motion motion_of(const Problem& problem, double period, const std::optional<FixedSteps>& steps,
                 const Looks& seen) {
  Motion motion{{}, {}, 0, stroboscope_tolerances, {}};
  for (double atol = infinity; motion.tolerances.atol < atol;) {
    atol = motion.tolerances.atol;
    motion.map = stroboscope(problem, period, steps, most_period_steps, motion.tolerances);
    motion.points = looks(motion.map, problem.y0, seen.skip, seen.count);
    if (motion.points.empty()) return motion;
    const double start =
        std::max(largest_of(std::vector{problem.y0, motion.map(problem.y0)}), largest_of(motion.points));
    motion.resolution = {tolerances_at({0, Resolution().rest}, start).atol, steps ? 0 : atol};
    const std::size_t last = motion.points.size() / 2;
    motion.size = largest_of(
        std::vector(motion.points.begin() + static_cast<std::ptrdiff_t>(last), motion.points.end()));
    if (motion.size <= motion.resolution.rest) motion.size = start;
    if (!steps)
      motion.tolerances.atol = std::min(atol, tolerances_at(stroboscope_tolerances, motion.size).atol);
  }
  return motion;
}

/// A window that holds the points and the motion through the first of them over one period.
Window around(const Problem& problem, const std::vector<VectorXd>& points, double period,
              const Motion& motion) {
  const auto names = states_with_units(problem);
  Window window = window_around({way_of_motion(problem, points, period)}, names[0], names[1],
                                std::vector<Vector2d>(points.begin(), points.end()), 0.3);
  const Vector2d size = window.size(), largest = window.lower.cwiseAbs().cwiseMax(window.upper.cwiseAbs());
  const double rounding = std::numeric_limits<double>::epsilon(), atol = motion.tolerances.atol;
  const double unit = motion.size > 0 && motion.size < ordinary_size ? motion.size : 1;
  const double other = size.maxCoeff() > 1e3 * atol ? size.maxCoeff() : unit;
  for (Eigen::Index i = 0; i < 2; ++i)  // at rest to rounding
    if (size(i) < 1e3 * std::max(atol, rounding * largest(i))) {
      window.lower(i) -= other / 2;
      window.upper(i) += other / 2;
    }
  return window;
}

/// About what a period takes [s]: the first of the motion, or what its fixed steps take.
double seconds_of_period(const Problem& problem, double period, const std::optional<FixedSteps>& steps) {
  constexpr double stage = 15e-9;
  if (steps) return period / steps->h * std::max(1, steps->method.stages) * stage;
  return seconds_of([&] { stroboscope(problem, period, steps)(problem.y0); });
}

/// @param periods  that are certain: motions that do not repeat are followed further
/// @throws InputError  where they would take too long
void check_length(const PhaseOptions& options, const std::string& asked, double periods, double seconds) {
  refuse_endless(
      {.asked = asked,
       .count = periods,
       .of = "periods of the force",
       .seconds_each = seconds,
       .most_seconds = time_limit_of(options.time_limit),
       .remedy = "take fewer --periods or --points, a larger --h or smaller forces, or raise --time-limit"});
}

struct Section {
  double drive_period;
  std::optional<FixedSteps> steps;
  Tolerances<double> tolerances;  ///< of adaptive periods
  Looks looks;
  std::vector<VectorXd> points;
  Settled motion;
  std::optional<Exponent> exponent;  ///< per period of the force; nothing when the motion diverges
  Window searched;                   ///< for motions of one period
  FixedPointSearch periodic{};

  /// [1/s]
  [[nodiscard]] double lyapunov() const { return exponent->value / drive_period; }
  [[nodiscard]] double lyapunov_error() const { return exponent->error / drive_period; }
  /// The exponent is known to be below a bound.
  [[nodiscard]] bool is_bound() const { return exponent && exponent->at_most; }
  [[nodiscard]] bool diverges() const { return motion.settling == Settling::diverges; }
};

/// What diverges takes any number of steps: a search follows a period no further.
constexpr std::int64_t most_searched_steps = 5'000;

/// @param map     of periods of any length
/// @param search  of those that a search follows; the motion that is seen is found by `map` where that misses
/// it
FixedPointSearch motions_of_one_period(const VectorFunction& map, const VectorFunction& search,
                                       const Section& section) {
  const Window& window = section.searched;
  FixedPointSearch found = search_fixed_points(search, window);
  if (section.motion.period != 1) return found;
  const Vector2d seen = section.motion.looks.back();
  const auto distance = [&](const Vector2d& y) -> double {
    return (y - seen).cwiseQuotient(window.size()).cwiseAbs().maxCoeff();
  };
  const bool outside = distance((window.lower + window.upper) / 2) > 0.5;
  if (outside || std::ranges::any_of(found.points,
                                     [&](const FixedPoint& point) { return distance(point.state) < 1e-6; }))
    return found;
  return search_fixed_points(
      [&](const Vector2d& y) -> Vector2d { return distance(y) < 0.01 ? map(y) : search(y); }, window, {seen});
}

Section section_of(const Problem& problem, const PhaseOptions& options) {
  const double period = drive_period(problem, options.period);
  const Looks seen = looks_of(options, 2000);
  const auto steps = fixed_steps_of(options);
  check_length(options, "this section", static_cast<double>(seen.skip) + seen.count,
               seconds_of_period(problem, period, steps));
  const Motion shown = motion_of(problem, period, steps, seen);
  const Settled motion = settle(shown.map, shown.points, seen.count, {}, shown.resolution);
  const bool whole = static_cast<int>(shown.points.size()) == seen.count;
  Section section{
      .drive_period = period,
      .steps = steps,
      .tolerances = shown.tolerances,
      .looks = seen,
      .points = shown.points,
      .motion = motion,
      .exponent = motion.exponent,
      .searched = options.window.empty()
                      ? window_of_motions(problem, whole ? shown.points : std::vector<VectorXd>{}, period)
                      : parse_window(options.window)};
  if (motion.settling == Settling::periodic)
    section.exponent =
        largest_lyapunov(shown.map, motion.looks.back(),
                         around(problem, motion.looks, period, shown).size().cwiseMax(1e-3 * shown.size));
  section.periodic = motions_of_one_period(
      shown.map, stroboscope(problem, period, steps, most_searched_steps, shown.tolerances), section);
  return section;
}

/// "0.1035 ± 0.0021" or "below -0.27"
std::string with_error(const Section& section) {
  if (section.is_bound()) return "below " + short_number(section.lyapunov(), 2);
  return fmt::format("{} ± {}", short_name(section.lyapunov()), short_number(section.lyapunov_error(), 2));
}

/// What the section says, as a sentence.
std::string verdict(const Section& section) {
  const Settled& motion = section.motion;
  const int all = section.looks.skip + section.looks.count + motion.followed;
  if (section.diverges())
    return fmt::format(
        "the motion diverges within {} periods of the force; take other parameters or another y0", all);
  if (motion.settling == Settling::chaotic)
    return fmt::format(
        "the motion does not repeat within {} periods, and neighbours part as exp({} t): it is chaotic", all,
        short_name(section.lyapunov()));
  if (motion.settling == Settling::unsettled)
    return fmt::format(
        "the motion has not settled within {} periods, and neighbours do not part beyond the error of the "
        "exponent; raise --skip",
        all);
  const std::string repeats = motion.period == 1
                                  ? "has the period of the force"
                                  : fmt::format("repeats after {} periods of the force", *motion.period);
  if (motion.followed == 0) return "the motion " + repeats;
  return fmt::format("the motion {}, but settles only after the looks, within {} periods; raise --skip",
                     repeats, all);
}

/// What the search for motions of one period is worth, as a sentence.
std::string guarantee(const Problem& problem, const Section& section) {
  return guarantee(
      problem, section.searched, section.periodic, section.periodic.points.size(),
      {.one = "motion of one period",
       .many = "motions of one period",
       .of = "map",
       .without = "with a multiplier of 1",
       .border = fmt::format("a motion lies on it, diverges from it or takes more than {} steps a period",
                             most_searched_steps)});
}

Figure picture(const Problem& problem, const Section& section) {
  const auto names = states_with_units(problem);
  Panel panel{.title = "", .x = {names[0]}, .y = {names[1]}};
  std::vector<double> x, v;
  for (const VectorXd& y : section.points) {
    x.push_back(y(0));
    v.push_back(y(1));
  }
  const int shown = section.motion.followed == 0 ? section.motion.period.value_or(0) : 0;
  if (shown > 0 && shown <= 12) {
    x.resize(static_cast<std::size_t>(shown));
    v.resize(static_cast<std::size_t>(shown));
    const Table way = way_of_motion(problem, section.points, shown * section.drive_period);
    panel.curves.push_back(
        {.label = "motion", .x = way.values[0], .y = way.values[1], .style = {.colour = 7, .width = 1.2}});
  }
  panel.curves.push_back(cloud("once in each period of the force", x, v));
  for (const FixedPoint& point : section.periodic.points)
    panel.marks.push_back({point.state(0),
                           point.state(1),
                           {.colour = 1, .marker = marker_of(std::string(name_of(point.type)))},
                           "repeats after one period, " + type_in_words(std::string(name_of(point.type)))});
  std::string title = verdict(section);
  title = title.substr(0, title.find(','));
  title[0] = 'T';
  return {.title = title,
          .panels = {panel},
          .footer =
              fmt::format("{}: {}; {} looks after {} periods of {} s{}", problem.id, describe_acting(problem),
                          section.looks.count, section.looks.skip, short_name(section.drive_period),
                          section.steps ? "; " + motions_in_words(section.steps, section.tolerances) : ""),
          .panel_height = 440};
}

/// The values of --from ... --to.
std::vector<double> values_of(const PhaseOptions& options) {
  if (!options.from || !options.to)
    throw InputError("a bifurcation diagram needs --from and --to, the ends of the parameter");
  const std::int64_t asked = options.points.empty() ? 200 : parse_count("--points", options.points, 2);
  refuse_endless({.asked = "--points " + options.points,
                  .count = static_cast<double>(asked),
                  .of = "values of the parameter",
                  .most_count = most_values,
                  .remedy = "take fewer"});
  const auto count = static_cast<int>(asked);
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

/// The period of the force at each value. Where the parameter takes the force away, the looks keep the period
/// that it has beside.
std::vector<double> periods_of_force(const PhaseOptions& options, const std::vector<double>& values) {
  const auto at = [&](double value) { return with_value(options.problem, options.bifurcation, value); };
  std::optional<double> beside;  // of the first value with a force
  std::vector<double> periods;
  for (const double value : values) {
    const Problem problem = at(value);
    if (options.period || is_driven(problem)) {
      periods.push_back(drive_period(problem, options.period));
      continue;
    }
    for (std::size_t i = 0; i < values.size() && !beside; ++i)
      if (const Problem other = at(values[i]); is_driven(other)) beside = drive_period(other, {});
    periods.push_back(beside ? *beside : drive_period(problem, {}));
  }
  return periods;
}

/// Both ends of the parameter and its middle stand for all values.
std::array<std::size_t, 3> some_of(std::size_t values) { return {0, (values - 1) / 2, values - 1}; }

/// The same of a diagram: both ends and the middle of the parameter say what a period takes.
template <class ProblemAt>
void check_length(const PhaseOptions& options, const ProblemAt& problem_at,
                  const std::vector<double>& periods, const std::optional<FixedSteps>& steps,
                  const Looks& seen) {
  double seconds = 0;
  for (const std::size_t i : some_of(periods.size()))
    seconds += seconds_of_period(problem_at(i), periods[i], steps) / 3;
  const double applications =
      static_cast<double>(periods.size()) * (static_cast<double>(seen.skip) + seen.count);
  check_length(options, "this diagram", applications,
               seconds / static_cast<double>(options.follow ? 1 : jobs()));
}

/// What motions of all values are computed and judged at, for the smallest of some. Without a force a motion
/// dies out, and has no size.
struct DiagramScale {
  Tolerances<double> tolerances = stroboscope_tolerances;
  Resolution resolution{};
};

template <class ProblemAt>
DiagramScale scale_of(const ProblemAt& problem_at, const std::vector<double>& periods,
                      const std::optional<FixedSteps>& steps, const Looks& seen) {
  constexpr int few = 8;
  DiagramScale scale;
  for (const std::size_t i : some_of(periods.size())) {
    const Problem problem = problem_at(i);
    if (!is_driven(problem)) continue;
    const Motion motion = motion_of(problem, periods[i], steps, {few, steps ? 0 : seen.skip});
    scale.tolerances.atol = std::min(scale.tolerances.atol, motion.tolerances.atol);
    scale.resolution.rest = std::min(scale.resolution.rest, motion.resolution.rest);
  }
  scale.resolution.error = steps ? 0 : scale.tolerances.atol;
  return scale;
}

/// Of motions each of which begins where the one before has ended.
MapEnsemble one_after_another(const std::function<Problem(std::size_t i)>& problem_at,
                              const std::vector<double>& periods, const std::optional<FixedSteps>& steps,
                              const DiagramScale& scale) {
  return one_by_one([=](std::size_t i) {
    return stroboscope(problem_at(i), periods[i], steps, most_period_steps, scale.tolerances);
  });
}

/// "4", "chaotic", "not settled" or "diverges"
std::string in_a_word(const Settled& motion) {
  return motion.period ? std::to_string(*motion.period)
                       : type_in_words(std::string(name_of(motion.settling)));
}

/// The stretches of the parameter over which the motion comes to the same.
struct Stretch {
  double from, to;
  std::string what;
};

std::vector<Stretch> stretches(const std::vector<BifurcationColumn>& columns) {
  std::vector<Stretch> found;
  for (const BifurcationColumn& column : columns) {
    const std::string what = in_a_word(column.motion);
    if (found.empty() || found.back().what != what)
      found.push_back({column.value, column.value, what});
    else
      found.back().to = column.value;
  }
  return found;
}

/// The looks of every column, a colour for each of the three things that a motion comes to.
Panel diagram(const std::vector<BifurcationColumn>& columns, const std::string& parameter,
              const std::string& x) {
  struct Kind {
    Settling settling;
    std::string label;
    int colour;
  };
  Panel panel{.title = "", .x = {parameter}, .y = {x + " once in each period of the force"}};
  for (const Kind& kind : {Kind{Settling::chaotic, "chaotic", 1},
                           {Settling::unsettled, "not settled", 7},
                           {Settling::periodic, "periodic", 0}}) {
    std::vector<double> at, seen;
    for (const BifurcationColumn& column : columns) {
      const Settled& motion = column.motion;
      if (motion.settling != kind.settling) continue;
      const auto shown = motion.period ? static_cast<std::size_t>(*motion.period) : motion.looks.size();
      for (std::size_t i = 0; i < std::min(shown, motion.looks.size()); ++i) {
        at.push_back(column.value);
        seen.push_back(motion.looks[i](0));
      }
    }
    if (at.empty()) continue;
    panel.curves.push_back(cloud(kind.label, at, seen, kind.colour));
    panel.curves.back().style.size = 0.3;
  }
  return panel;
}

Json column_document(const BifurcationColumn& column, double period) {
  const Settled& motion = column.motion;
  Json xs = Json::array();
  for (const VectorXd& y : motion.looks) xs.push_back(y(0));
  const auto exponent = [&](double Exponent::*part) {
    return motion.exponent && !motion.exponent->at_most ? Json((*motion.exponent).*part / period) : Json();
  };
  return {{"value", column.value},
          {"x", xs},
          {"status", name_of(motion.settling)},
          {"period", json_or_null(motion.period)},
          {"lyapunov", exponent(&Exponent::value)},
          {"lyapunov_error", exponent(&Exponent::error)},
          {"followed", motion.followed}};
}

Json fixed_point_document(const FixedPoint& point) {
  const auto index = index_of(point);
  return {{"x", point.state(0)},
          {"v", point.state(1)},
          {"multipliers", eigenvalues_document(point.multipliers)},
          {"type", name_of(point.type)},
          {"index", json_or_null(index)}};
}

Json section_document(const Problem& problem, const Section& section) {
  Json points = Json::array(), periodic = Json::array();
  for (const VectorXd& y : section.points) points.push_back({y(0), y(1)});
  for (const FixedPoint& point : section.periodic.points) periodic.push_back(fixed_point_document(point));
  const Settled& motion = section.motion;
  const bool exponent = section.exponent && !section.is_bound();
  return {{"drive_period", section.drive_period},
          {"tolerances", Json()},
          {"skip", section.looks.skip},
          {"section", points},
          {"settling", name_of(motion.settling)},
          {"period", json_or_null(motion.period)},
          {"followed", motion.followed},
          {"lyapunov", exponent ? Json(section.lyapunov()) : Json()},
          {"lyapunov_error", exponent ? Json(section.lyapunov_error()) : Json()},
          {"lyapunov_below", section.is_bound() ? Json(section.lyapunov()) : Json()},
          {"lyapunov_periods", section.exponent ? Json(section.exponent->count) : Json()},
          {"periodic", periodic},
          {"search", search_document(section.searched, section.periodic, guarantee(problem, section))},
          {"status", verdict(section)}};
}

std::string report_of(const Problem& problem, const Section& section, const Console& console) {
  std::string text =
      fmt::format("seen every {} s, {} times after {} periods\n\n{}\n", short_name(section.drive_period),
                  section.points.size(), section.looks.skip, console.strong(verdict(section)));
  const auto names = states_with_units(problem);
  const Settled& motion = section.motion;
  if (motion.period && *motion.period <= 12) {
    TextTable table({"look", names[0], names[1]});
    for (std::size_t i = 0; i < static_cast<std::size_t>(*motion.period); ++i)
      table.add({std::to_string(i + 1), short_number(motion.looks[i](0), 10),
                 short_number(motion.looks[i](1), 10)});
    text += "\n" + table.text(console);
  }
  if (!section.periodic.points.empty()) {
    TextTable table({"repeats after one period", names[0], names[1], "multipliers"});
    for (const FixedPoint& point : section.periodic.points)
      table.add({std::string(name_of(point.type)), short_name(point.state(0)), short_name(point.state(1)),
                 multipliers_in_words(point.multipliers)});
    text += "\n" + table.text(console);
  }
  text += fmt::format("\n{}\n", guarantee(problem, section));
  if (section.exponent && std::isfinite(section.exponent->value))
    text += fmt::format("\nlargest Lyapunov exponent {} 1/s ({}{} periods)\n", with_error(section),
                        section.is_bound() ? "" : "95 %, ", section.exponent->count);
  return text + fmt::format("\nmotions: {}\n", motions_in_words(section.steps, section.tolerances));
}

}  // namespace

void phase_poincare(const PhaseOptions& options, Console& console) {
  const Problem problem = options.problem.make();
  const Section section = section_of(problem, options);
  Json document = document_of(problem);
  document.update(section_document(problem, section));
  add_motions(document, section.steps, section.tolerances);
  std::string text = headline(problem) + report_of(problem, section, console);
  if (!options.output.empty() && !section.points.empty())
    deliver(picture(problem, section), options, document, text, console);
  if (section.diverges()) console.exit_code = Exit::failed;
  console.show(document, text);
}

void phase_bifurcation(const PhaseOptions& options, Console& console) {
  const std::vector<double> values = values_of(options);
  const std::string& name = options.bifurcation;
  options.problem.refuse_varied(name, "--bifurcation");
  const Problem first = with_value(options.problem, name, values.front());
  const Looks seen = looks_of(options, 64);
  const auto steps = fixed_steps_of(options);
  const auto problem_at = [&](std::size_t i) { return with_value(options.problem, name, values[i]); };
  const std::vector<double> periods = periods_of_force(options, values);
  check_length(options, problem_at, periods, steps, seen);
  const DiagramScale scale = scale_of(problem_at, periods, steps, seen);
  const std::unique_ptr<Device> device = options.device.open();
  const MapEnsemble maps =
      options.follow ? one_after_another(problem_at, periods, steps, scale)
                     : period_maps(problem_at, periods, steps,
                                   runner_on(device.get(), values.size() / jobs() + 1), scale.tolerances);
  Progress progress(console, "bifurcation");
  const auto& interrupted = interrupt_flag();
  const auto going = [&](double share) {
    progress.update(share);
    return !interrupted;
  };
  const auto columns =
      bifurcation(maps, values, first.y0, seen.skip, seen.count, options.follow, going, scale.resolution);
  if (interrupted) throw Interrupted{};

  Problem held = first;
  std::erase_if(held.parameters, [&](const auto& parameter) { return parameter.first == name; });
  Json document = document_of(held);
  Json list = Json::array();
  for (std::size_t i = 0; i < columns.size(); ++i) list.push_back(column_document(columns[i], periods[i]));
  add_motions(document, steps, scale.tolerances);
  document["parameter"] = name;
  document["skip"] = seen.skip;
  document["follow"] = options.follow;
  document["columns"] = list;

  std::string text = headline(held) + "\n";
  TextTable table({"settles to", name + " from", "to"});
  for (const Stretch& stretch : stretches(columns))
    table.add({stretch.what, short_name(stretch.from), short_name(stretch.to)});
  text += table.text(console) + fmt::format("motions: {}\n", motions_in_words(steps, scale.tolerances));
  add_time(device.get(), document, text);
  if (!options.output.empty()) {
    const auto names = states_with_units(first);
    std::string parameters;
    for (const auto& [parameter, value] : held.parameters)
      parameters += fmt::format(" {}={}", parameter, to_text(value));
    deliver({.title = fmt::format("{}: what the motion settles to, over {}", first.id, name),
             .panels = {diagram(columns, with_unit(first, name), names[0])},
             .footer = fmt::format(
                 "{}{}; {} looks after {} periods, {}{}", first.id, parameters, seen.count, seen.skip,
                 options.follow ? "each value from where the one before has ended"
                                : fmt::format("each value from y0 = {}", describe(first.y0)),
                 steps ? "; " + motions_in_words(steps, scale.tolerances) : ""),
             .panel_height = 440},
            options, document, text, console);
  }
  console.show(document, text);
}

}  // namespace hmax
