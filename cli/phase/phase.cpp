/// hmax phase: equilibria, their types, and the phase plane around them.
#include "cli/phase/phase.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "catalogue/device/motion_runs.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/planar.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/shared/work_limit.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "plots/draw.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

using Eigen::Vector2d;

/// Throws unless f is finite somewhere in the window.
void require_finite(const PhaseView& view) {
  constexpr int grid = 8;
  for (int i = 0; i <= grid; ++i)
    for (int j = 0; j <= grid; ++j) {
      const Vector2d fraction(double(i) / grid, double(j) / grid);
      if (view.field.rhs(view.window.lower + fraction.cwiseProduct(view.window.size())).allFinite()) return;
    }
  throw InputError(
      fmt::format("the derivatives of {} are not finite anywhere in the window; give another --window or "
                  "other parameters",
                  view.problem.id));
}

/// What is seen: no more than the types, since what is not linear decides where motions end.
std::string title_of_view(const PhaseView& view) {
  const std::string& id = view.problem.id;
  if (view.t) return fmt::format("{} as it is pushed at t = {} s, forever", id, short_name(*view.t));
  const auto all = view.equilibria.size();
  if (all == 0) return fmt::format("{}: no equilibrium was found here", id);
  if (all == 1) {
    std::string type(name_of(view.equilibria[0].type));
    std::ranges::replace(type, '_', ' ');
    return fmt::format("{}: one equilibrium, {}", id, type);
  }
  const auto stable = std::ranges::count_if(view.equilibria, is_stable, &Equilibrium::type);
  const auto centres = std::ranges::count(view.equilibria, EquilibriumType::centre, &Equilibrium::type);
  return fmt::format("{}: {} equilibria, {} stable{}", id, all, stable,
                     centres == 0 ? "" : fmt::format(", {} centres", centres));
}

Figure phase_portrait(const PhaseView& view) {
  Figure figure = phase_figure(title_of_view(view), {plane_of(view)});
  for (const Equilibrium& e : view.equilibria) {
    if (e.type != EquilibriumType::saddle) continue;
    for (const bool into : {false, true})
      for (Curve& way : ways_of(view, e, into)) figure.panels[0].curves.push_back(std::move(way));
  }
  figure.footer = describe_acting(view.problem);
  return figure;
}

bool is_strobed(const PhaseOptions& options) { return options.poincare || !options.bifurcation.empty(); }

/// With a stroboscopic view the method is that of its motions.
bool shows_map(const PhaseOptions& options) {
  return !is_strobed(options) && (!options.method.method.empty() || !options.method.tableau.empty());
}

/// One view at a time.
void require_one_view(const PhaseOptions& options) {
  const int views = shows_map(options) + options.poincare + options.basins + !options.bifurcation.empty();
  if (views > 1)
    throw InputError(
        "the map of --method, --basins, --poincare and --bifurcation are views of their own; ask for one of "
        "them at a time");
  const bool strobed = is_strobed(options);
  if (!strobed && (options.period || options.time_limit || !options.periods.empty() || !options.skip.empty()))
    throw InputError(
        "--period, --periods, --skip and --time-limit need --poincare or --bifurcation; add one of them");
  if (options.bifurcation.empty() &&
      (options.from || options.to || options.follow || !options.points.empty()))
    throw InputError("--from, --to, --points and --follow need --bifurcation; name a parameter with it");
  if (strobed && options.at)
    throw InputError("--at is for equilibria, and a stroboscopic view has none; leave it out");
  if (!options.bifurcation.empty() && !options.window.empty())
    throw InputError("--bifurcation has no --window; remove it");
  options.device.check({{"--poincare", options.poincare}, {"--follow", options.follow}});
  if (options.device.is_gpu() && !options.basins && options.bifurcation.empty())
    throw InputError(
        "--device gpu is for the many motions of --basins and --bifurcation; leave --device out");
}

/// The name of the figure of the view that is asked for.
std::string figure_name(const PhaseOptions& options) {
  return shows_map(options)            ? "map"
         : options.basins              ? "basins"
         : options.poincare            ? "poincare"
         : options.bifurcation.empty() ? "phase"
                                       : "bifurcation";
}

void phase(const PhaseOptions& options, Console& console) {
  require_one_view(options);
  check_figure(options.output, figure_name(options));
  if (shows_map(options)) return phase_map(options, console);
  if (!options.basins && !options.cells.empty())
    throw InputError("--cells is the grid of --basins; add --basins, or leave it out");
  if (options.basins) return phase_basins(options, console);
  if (options.poincare) return phase_poincare(options, console);
  if (!options.bifurcation.empty()) return phase_bifurcation(options, console);
  if (options.h) throw InputError("--h is a step of a method; name one with --method, or leave --h out");
  const PhaseView view = view_of(options);
  Json document = document_of(view);
  std::string text = headline(view.problem) + equilibria_table(view, console);
  if (!options.output.empty()) {
    text += fmt::format("\norbits: {}\n", in_words(tolerances_in(view.window, orbit_tolerances)));
    deliver(phase_portrait(view), options, document, text, console);
  }
  for (const std::string& remark : view.remarks) text += "\n" + remark + "\n";
  console.show(document, text);
}

/// Which view.
void add_view_options(CLI::App& command, PhaseOptions& options) {
  const HelpGroup group(command, "Views, one at a time; the field with its equilibria by default");
  options.method.add_to(command);
  add_number(command, "--h", options.h,
             "Step size of the method: the view is its step as a map of the plane [s]; with --poincare and "
             "--bifurcation at most, so that steps divide the period");
  add_flag(command, "--basins", options.basins,
           fmt::format("Show the basins of attraction of the stable equilibria, at {}",
                       in_words(basin_tolerances)));
  add_flag(command, "--poincare", options.poincare,
           fmt::format("Show the Poincare section: the state once in each period of the force, at {} or "
                       "by steps of --method",
                       in_words(stroboscope_tolerances)));
  add_text(command, "--bifurcation", options.bifurcation,
           "Show the bifurcation diagram over this parameter, from --from to --to", "NAME");
}

void add_plane_options(CLI::App& command, PhaseOptions& options) {
  const HelpGroup group(command, "Part of the plane");
  add_text(command, "--window", options.window,
           "Part of the plane, with --poincare the part searched for motions of one period; the range of "
           "the motion from y0 by default",
           "XMIN,XMAX,VMIN,VMAX");
  add_number(command, "--at", options.at,
             "Time at which the field of a driven problem is shown [s]; 0 by default");
  add_text(command, "--cells", options.cells,
           "With --basins: columns of the grid of initial states, or columns and rows, like 200,200; 120 by "
           "default",
           "NUMBER");
}

/// The state once in each period of the force, alone or over a parameter.
void add_section_options(CLI::App& command, PhaseOptions& options) {
  const HelpGroup group(command, "With --poincare and --bifurcation");
  add_text(command, "--periods", options.periods,
           "Recorded periods; 2000, with --bifurcation 64 for each value, by default", "NUMBER");
  add_text(command, "--skip", options.skip, "Discarded periods before them; 200 by default", "NUMBER");
  add_number(command, "--period", options.period,
             "Period of the force [s]; that of the oscillator by default");
  add_time_limit(command, options.time_limit);
}

void add_bifurcation_options(CLI::App& command, PhaseOptions& options) {
  const HelpGroup group(command, "With --bifurcation");
  add_number(command, "--from", options.from, "First value of the parameter");
  add_number(command, "--to", options.to, "Last value of the parameter");
  add_text(command, "--points", options.points, "Number of values of the parameter; 200 by default",
           "NUMBER");
  add_flag(command, "--follow", options.follow,
           "Start each value at the end of the previous one, instead of at y0");
}

}  // namespace

Window parse_window(const std::string& text) {
  const auto [x_min, x_max, v_min, v_max] =
      parse_window("--window", text, "xmin,xmax,vmin,vmax", "-2,2,-2,2");
  return {{x_min, v_min}, {x_max, v_max}};
}

std::string short_name(double value) { return short_number(value + 0.0, 5); }

std::string headline(const Problem& problem) {
  return fmt::format("{} with {}\n", problem.id, describe_acting(problem));
}

std::string multipliers_in_words(const Multipliers& multipliers) {
  const auto is_small = [](const std::complex<double>& mu) { return std::abs(mu) < 1e-9; };
  const auto& [first, second] = multipliers;
  if (is_small(first)) return "below 1e-9, below 1e-9";
  return is_small(second) ? short_name(first.real()) + ", below 1e-9" : eigenvalues_in_words(multipliers);
}

std::string equilibria_table(const PhaseView& view, const Console& console) {
  if (view.equilibria.empty()) return "\n" + guarantee(view) + "\n";
  constexpr std::size_t most_rows = 40;
  const std::size_t all = view.equilibria.size(), shown = all > most_rows ? most_rows / 2 : all;
  const auto names = states_with_units(view.problem);
  TextTable table({"equilibrium", names[0], names[1], "eigenvalues [1/s]"});
  for (const Equilibrium& e : std::span(view.equilibria).first(shown))
    table.add({fmt::format("{}{}", name_of(e.type), e.kink ? ", kink" : ""), short_name(e.state(0)),
               short_name(e.state(1)), eigenvalues_in_words(e.eigenvalues)});
  if (shown < all) table.add({fmt::format("{} more, all with --json", all - shown), "", "", ""});
  return "\n" + table.text(console) + guarantee(view) + "\n";
}

std::vector<Vector2d> starts_of(const PhaseView& view) {
  const auto at = [&](double u, double v) -> Vector2d {
    const Vector2d y = view.window.lower + Vector2d(u, v).cwiseProduct(view.window.size());
    // Few digits, since they stand in the key.
    return y.unaryExpr([](double x) { return to_number(short_number(x, 2)).value(); });
  };
  std::vector<Vector2d> starts;
  const Vector2d own = view.problem.y0;
  if (((own - view.window.lower).array() >= 0).all() && ((view.window.upper - own).array() >= 0).all())
    starts.push_back(own);
  for (const auto& [u, v] : {std::pair{0.1, 0.85}, {0.9, 0.15}, {0.57, 0.44}, {0.42, 0.1}})
    starts.push_back(at(u, v));
  return starts;
}

namespace {

/// "x from -2 to 2 and v from 1 to 3", in as many digits as tell the ends apart.
std::string window_in_words(const Window& w, const Problem& problem) {
  const auto range = [&](int i) {
    const double low = w.lower(i), high = w.upper(i), largest = std::max(std::abs(low), std::abs(high));
    const int digits = std::clamp(static_cast<int>(std::ceil(std::log10(largest / (high - low)))) + 3, 5, 17);
    return fmt::format("{} from {} to {}", problem.states[static_cast<std::size_t>(i)],
                       short_number(low + 0.0, digits), short_number(high + 0.0, digits));
  };
  return fmt::format("{} and {}", range(0), range(1));
}

}  // namespace

std::string guarantee(const Problem& problem, const Window& w, const DegreeCheck& check, std::size_t count,
                      const Searched& searched) {
  const std::string where = "with " + window_in_words(w, problem);
  const std::string text = fmt::format("{} {} {}", count == 0 ? "no" : std::to_string(count),
                                       count == 1 ? searched.one : searched.many, where);
  if (!check.whole)
    return text +
           ", but the search was cut short and may have missed some; unless they make a line, narrow --window";
  if (!check.index_sum)
    return fmt::format("{}, one of them {}, so that their indices do not tell whether all are found", text,
                       searched.without);
  const std::string sum = fmt::format("{}, whose indices sum to {}", text, *check.index_sum);
  if (!check.degree)
    return fmt::format(
        "{}; the degree of the {} around the border, which would check them, is not defined: {}", sum,
        searched.of, searched.border);
  if (check.accounts())
    return fmt::format(
        "{}, as the degree of the {} around the border: {} can have been missed only in groups whose indices cancel",
        sum, searched.of, searched.many);
  return fmt::format(
      "{}, but the degree of the {} around the border is {}: {} have been missed, or the {} jumps or is not finite "
      "inside; search parts of it with --window",
      sum, searched.of, *check.degree, searched.many, searched.of);
}

std::string guarantee(const PhaseView& view) {
  return guarantee(
      view.problem, view.window, view.check, view.equilibria.size(),
      {.one = "equilibrium",
       .many = "equilibria",
       .of = "field",
       .without = "without an index",
       .border = "an equilibrium lies on it, or the field is not finite or turns round at a jump there"});
}

Json search_document(const Window& w, const DegreeCheck& check, const std::string& status) {
  return {{"window", {w.lower(0), w.upper(0), w.lower(1), w.upper(1)}},
          {"index_sum", json_or_null(check.index_sum)},
          {"degree", json_or_null(check.degree)},
          {"cut_short", !check.whole},
          {"status", status}};
}

PhaseView view_of(const PhaseOptions& options) {
  const Problem problem = options.problem.make();
  require_planar(problem);
  const bool driven = is_driven(problem);
  if (options.at && !std::isfinite(*options.at))
    throw InputError("--at is not a finite number; give the instant in seconds, like 0");
  if (options.at && !driven)
    throw InputError(
        fmt::format("--at freezes a driven problem, and {} does not depend on time; leave --at "
                    "out",
                    problem.id));
  const double t = options.at.value_or(0);
  const Problem still = frozen(problem, t);
  const Window window = options.window.empty() ? default_window(still) : parse_window(options.window);
  PhaseView view{.problem = problem,
                 .t = driven ? std::optional(t) : std::nullopt,
                 .still = still,
                 .field = planar_field(problem, t, window.size()),
                 .window = window};
  require_finite(view);
  EquilibriumSet found = search_equilibria(view.field, window);
  view.equilibria = std::move(found.points);
  view.check = found;
  if (driven)
    view.remarks.push_back(
        fmt::format("A driven problem has no equilibria: these are of the field frozen at t = {} s (--at); "
                    "what the motion settles to is shown by --poincare.",
                    short_name(t)));
  if (std::ranges::any_of(view.equilibria, [](const Equilibrium& e) { return e.kink.has_value(); }))
    view.remarks.push_back(
        "At a kink the field has no Jacobian: two real eigenvalues are the rates along the rays that motions "
        "follow, a pair of complex ones is rate and angular frequency of a turn.");
  if (view.equilibria.empty())
    view.remarks.push_back(
        fmt::format("{} with {}; look elsewhere with --window xmin,xmax,vmin,vmax.",
                    found.accounts() ? "There is no equilibrium" : "No equilibrium was found",
                    window_in_words(window, problem)));
  return view;
}

Json document_of(const Problem& problem) {
  Json parameters = Json::object();
  for (const auto& [name, value] : problem.parameters) parameters[name] = value;
  return {{"problem", problem.id},
          {"material", json_or_null(problem.material)},
          {"parameters", parameters},
          {"states", problem.states}};
}

Json document_of(const PhaseView& view) {
  Json document = document_of(view.problem);
  const Window& w = view.window;
  document["t"] = json_or_null(view.t);
  document["window"] = {w.lower(0), w.upper(0), w.lower(1), w.upper(1)};
  document["remarks"] = view.remarks;
  document["equilibria"] = to_json(view.equilibria);
  document["search"] = search_document(view.window, view.check, guarantee(view));
  document["tolerances"] = to_json(tolerances_in(view.window, orbit_tolerances));
  return document;
}

Json eigenvalues_document(const std::array<std::complex<double>, 2>& eigenvalues) {
  Json pairs = Json::array();
  for (const auto& lambda : eigenvalues) pairs.push_back({lambda.real(), lambda.imag()});
  return pairs;
}

Json to_json(const std::vector<Equilibrium>& equilibria) {
  Json list = Json::array();
  for (const Equilibrium& e : equilibria)
    list.push_back({{"x", e.state(0)},
                    {"v", e.state(1)},
                    {"type", name_of(e.type)},
                    {"kink", e.kink.has_value()},
                    {"eigenvalues", eigenvalues_document(e.eigenvalues)}});
  return list;
}

std::string eigenvalues_in_words(const std::array<std::complex<double>, 2>& eigenvalues) {
  const auto& [first, second] = eigenvalues;
  if (!are_conjugate(eigenvalues))
    return fmt::format("{}, {}", short_name(first.real()), short_name(second.real()));
  return fmt::format("{}±{}i", first.real() == 0 ? "" : short_name(first.real()) + " ",
                     (first.real() == 0 ? "" : " ") + short_name(std::abs(first.imag())));
}

namespace {

/// The rays from a saddle along which motions leave it, or arrive.
std::vector<Kink::Ray> rays_of(const PhaseView& view, const Equilibrium& saddle, bool into) {
  if (!saddle.kink) {
    const double rate = saddle.eigenvalues[into ? 1 : 0].real();
    const Vector2d direction = eigenvector(view.field.jacobian(saddle.state), rate);
    return {{direction, rate}, {-direction, rate}};
  }
  std::vector<Kink::Ray> rays;
  for (const Kink::Ray& ray : saddle.kink->rays)
    if ((ray.rate < 0) == into) rays.push_back(ray);
  return rays;
}

/// How long orbits are followed: to the end of the problem, or ten times as long as the fastest of them takes
/// to cross the window at its first speed.
double time_of_orbits(const PhaseView& view, const std::vector<Vector2d>& starts) {
  double fastest = 0;
  for (const Vector2d& start : starts)
    if (const Vector2d f = view.field.rhs(start).cwiseQuotient(view.window.size()); f.allFinite())
      fastest = std::max(fastest, f.norm());
  const double crossings = 10 / fastest;
  return std::isfinite(crossings) ? std::max(view.problem.t_end, crossings) : view.problem.t_end;
}

}  // namespace

std::vector<Curve> ways_of(const PhaseView& view, const Equilibrium& saddle, bool into) {
  const double small = 1e-4 * view.window.size().minCoeff();
  const Problem problem = into ? reversed(view.still) : view.still;
  std::vector<Curve> ways;
  for (const auto& [direction, rate] : rays_of(view, saddle, into)) {
    const double until_seen = std::log(view.window.size().maxCoeff() / small);
    const double t_end = std::max(problem.t_end, (10 + until_seen) / std::abs(rate));
    const Table way = orbit(problem, saddle.state + small * direction, t_end, view.window, 6);
    ways.push_back({.label = into ? "into the saddle" : "out of the saddle",
                    .x = way.values[0],
                    .y = way.values[1],
                    .style = {.colour = 6, .dash = into ? 1 : 0, .marker = 0, .width = 1.4}});
  }
  return ways;
}

PhasePlane plane_of(const PhaseView& view) {
  PhasePlane plane = plane_of(view.field, view.window, states_with_units(view.problem), view.equilibria);
  const std::vector<Vector2d> starts = starts_of(view);
  const double t_end = time_of_orbits(view, starts);
  for (const Vector2d& start : starts)
    plane.orbits.push_back({fmt::format("from ({}, {})", short_name(start(0)), short_name(start(1))),
                            orbit(view.still, start, t_end, view.window, 12)});
  return plane;
}

MotionRunner runner_on(Device* device, std::size_t at_once) {
  MotionRunner runner = device ? motions_on(*device, at_once) : in_lanes();
  runner.interrupted = &interrupt_flag();
  return runner;
}

void add_time(Device* device, Json& document, std::string& text) {
  if (!device) return;
  const DeviceTime time{.facts = device->facts(), .seconds = device->seconds()};
  time.add_to(document);
  text += time.words() + "\n";
}

void deliver(const Figure& figure, const PhaseOptions& options, Json& document, std::string& text,
             Console& console) {
  const std::string svg = drawn_svg(figure, options.output, figure_name(options), console);
  document["figure"] = json_or_null(svg);
  if (!svg.empty()) text += fmt::format("\nThe figure: {}\n", svg);
}

void add_phase(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "phase", "Show the phase plane of a problem of two states, and that of a method on it",
      {"hmax phase --problem liver_cubic --set c=-0.2",
       ("hmax phase --problem liver_cubic --set k1=-1 --set c=0.3 --window -2,2,-2,2 "
        "--output results/runs/phase"),
       ("hmax phase --problem liver_cubic --set c=0.3 --method rk4 --h 2 --window -4,4,-4,4 "
        "--output results/runs/phase"),
       "hmax phase --problem liver_cubic --set k1=-1 --set c=0.2 --basins --cells 60 --window -3,3,-3,3",
       ("hmax phase --problem liver_forced --poincare --set c=0.05 --set P=7.5 --set k1=0 --set k3=1 --set m=1 "
        "--set w=1 --periods 500"),
       ("hmax phase --problem liver_forced --bifurcation P --from 5 --to 8 --points 60 --set c=0.05 --set k1=0 "
        "--set k3=1 --set m=1 --set w=1 --output results/runs/phase"),
       ("hmax phase --problem liver_forced --bifurcation P --from 5 --to 8 --points 400 --set c=0.05 --set k1=0 "
        "--set k3=1 --set m=1 --set w=1 --method rk4 --h 0.02"),
       "hmax phase --problem liver_forced --at 3 --json"},
      phase);
  options.problem.add_without_meshes_to(command);
  add_view_options(command, options);
  add_plane_options(command, options);
  add_section_options(command, options);
  add_bifurcation_options(command, options);
  add_text(command, "--output", options.output,
           fmt::format("Draw the figure into this folder, as SVG, PNG and PDF; orbits have {}",
                       in_words(orbit_tolerances)),
           "FOLDER");
  options.device.add_to(command, "the motions of --basins and --bifurcation");
  add_force(command);
  add_jobs(command);
  add_figure_style(command);
}

}  // namespace hmax
