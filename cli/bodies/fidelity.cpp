/// hmax fidelity: what the steps of a method show of a material.
#include "limits/fidelity/fidelity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/methods/catalogue.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/process/leaving.hpp"
#include "core/text/counted.hpp"
#include "limits/by_steps/one_step_map.hpp"
#include "limits/documents/fidelity_json.hpp"
#include "plots/curves.hpp"
#include "problems/tissue/body.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

struct FidelityOptions {
  ProblemChoice problem;
  std::optional<double> rate;
  std::vector<std::string> methods;
  bool verify = false, ceiling = false;
  std::string enter, map, output;
};

/// The methods of --map: settings of one, for each number of substeps in the order of their work.
/// @throws InputError  for another map, another number of methods, and a method without both parameters
std::vector<Method> methods_of_map(const FidelityOptions& options) {
  if (options.map != "iterations,substeps")
    throw InputError(fmt::format("--map is '{}', but there is one: iterations,substeps", options.map));
  if (options.methods.size() != 1)
    throw InputError(
        fmt::format("--map is of one method, and {} are named; name one with --method, for instance vbd",
                    options.methods.size()));
  const auto has_both = [](const Method& method) {
    return method.parameter("iterations") && method.parameter("substeps");
  };
  const std::string& name = options.methods.front();
  const Method method = find_method(name);
  for (const char* mapped : {"iterations", "substeps"})
    for (const char* before : {":", ","})
      if (name.find(fmt::format("{}{}=", before, mapped)) != std::string::npos)
        throw InputError(fmt::format("--map chooses {} itself; leave it out of {}", mapped, name));
  if (!has_both(method)) {
    std::vector<std::string> ids;
    for (const Method& each : methods())
      if (has_both(each)) ids.push_back(each.id);
    throw InputError(fmt::format("{} has no numbers of iterations and substeps to map; take one of {}",
                                 method.id, fmt::join(ids, ", ")));
  }
  constexpr double most = 200;  // iterations of a frame
  std::vector<Method> settings;
  for (const double substeps : {1, 2, 5, 10, 20})
    for (const double iterations : {1, 2, 5, 10, 20, 50})
      if (substeps * iterations <= most)
        settings.push_back(with_values(method, {{"iterations", iterations}, {"substeps", substeps}}));
  return settings;
}

/// The figure of --map.
Figure figure_of(const std::vector<Fidelity>& rows, const Problem& problem, const FidelityOptions& options) {
  std::vector<WorkCurve> curves;
  double substeps_before = 0;
  for (const Fidelity& row : rows) {
    const double iterations = *row.method.parameter("iterations"),
                 substeps = *row.method.parameter("substeps");
    if (substeps != std::exchange(substeps_before, substeps))
      curves.emplace_back().label = counted(substeps, "substep");
    curves.back().work.push_back(iterations * substeps);
    curves.back().stiffness.push_back(row.stiffness_shown);
    curves.back().damping.push_back(
        row.modes.empty() ? Fidelity::none : row.modes.front().zeta_shown - row.modes.front().zeta);
  }
  return work_figure(fmt::format("What {} shows of {} at {} Hz", options.methods.front(),
                                 title_of(problem.id), short_number(*options.rate)),
                     curves, describe_acting(problem));
}

/// @throws InputError  for a picture that nothing is drawn of, or whose name is that of something else
void check_output(const FidelityOptions& options) {
  if (options.output.empty()) return;
  if (options.map.empty())
    throw InputError("--output draws the map; add --map iterations,substeps, or leave it out");
  (void)form_of(options.output, {{".svg", "a figure"}});
  check_writable(options.output);
}

std::vector<Method> methods_of(const FidelityOptions& options, const Problem& problem) {
  if (!options.map.empty()) return methods_of_map(options);
  std::vector<Method> methods;
  for (const std::string& name : options.methods) methods.push_back(find_method(name));
  return methods.empty() ? methods_of_simulators(problem) : methods;
}

/// "5000", "5kPa", "0.2 MPa" [Pa]. @throws InputError  for what is none, or not positive
std::optional<double> modulus_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  constexpr std::array<std::pair<std::string_view, double>, 4> units{
      {{"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}, {"Pa", 1}}};
  std::string number = text;
  double factor = 1;
  for (const auto& [unit, pascals] : units)
    if (number.ends_with(unit)) {
      number.resize(number.size() - unit.size());
      factor = pascals;
      break;
    }
  while (number.ends_with(' ')) number.pop_back();
  const std::optional<double> value = to_number(number);
  constexpr double least = 1e-3, most = 1e15;
  if (!value || !(*value * factor >= least && *value * factor <= most))
    throw InputError(
        fmt::format("--enter {} is no modulus; give from 1e-3 to 1e15 Pa, for instance 5000 or 5kPa", text));
  return *value * factor;
}

std::string in_percent(double share) { return std::isnan(share) ? "-" : short_number(100 * share, 3) + " %"; }
std::string in_pascals(double value) {
  return std::isnan(value) ? "-" : std::isinf(value) ? "none" : short_number(value, 4) + " Pa";
}

std::string words_of(const std::vector<Fidelity>& rows, const FidelityOptions& options,
                     const Console& console) {
  const bool ceiling = options.ceiling || !options.enter.empty();
  std::vector<std::string> head{"method", "stiffness shown"};
  if (ceiling) head.emplace_back("at most");
  if (!options.enter.empty()) head.emplace_back("enter");
  head.insert(head.end(), {"slowest mode", "damping ratio"});
  if (options.verify) head.insert(head.end(), {"observed", "gap"});
  TextTable table(head);
  for (const Fidelity& row : rows) {
    std::vector<std::string> line{row.method.id, in_percent(row.stiffness_shown)};
    if (ceiling) line.push_back(in_pascals(row.stiffness_ceiling));
    if (!options.enter.empty()) line.push_back(in_pascals(row.modulus_to_enter));
    if (row.modes.empty()) {
      line.insert(line.end(), {"-", "-"});
    } else {
      const ShownMode& mode = row.modes.front();
      line.push_back(std::isnan(mode.omega_shown)
                         ? "-"
                         : fmt::format("{} for {} rad/s", short_number(mode.omega_shown, 3),
                                       short_number(mode.omega, 3)));
      line.push_back(std::isnan(mode.zeta_shown) ? "-"
                                                 : fmt::format("{} for {}", damping_in_words(mode.zeta_shown),
                                                               damping_in_words(mode.zeta)));
    }
    if (options.verify) {
      line.push_back(row.observed ? in_percent(row.observed->stiffness_shown) : "-");
      line.push_back(in_percent(row.gap));
    }
    table.add(line);
  }
  std::string text = table.text(console);
  for (const Fidelity& row : rows)
    if (!row.status.empty()) text += fmt::format("\n{}: {}", row.method.id, row.status);
  return text + "\n";
}

void print_rows(const std::vector<Fidelity>& rows, const Problem& problem, const FidelityOptions& options,
                const FidelityQuestion& question, Console& console) {
  if (console.json) return console.print_json(fidelity_json(problem, *options.rate, rows));
  std::string what = fmt::format("{} with {}\n", problem.id, describe_acting(problem));
  if (const std::string words = body_in_words(problem); !words.empty()) what += words + "\n";
  if (!problem.body) what += "the load is the force on it at rest in its initial state\n";
  console.print(fmt::format("{}frames of {} s\n\n{}", what, short_number(question.h, 4),
                            words_of(rows, options, console)));
}

void show_fidelity(const FidelityOptions& options, Console& console) {
  if (!options.rate || !(*options.rate > 0) || !std::isfinite(*options.rate))
    throw InputError("--rate must be a positive number of frames a second; give for instance --rate 100");
  const Problem problem = options.problem.make();
  remark_unusual(console, problem);
  options.problem.remark_idle(console, problem);
  FidelityQuestion question{.h = 1 / *options.rate, .verify = options.verify, .ceiling = options.ceiling};
  question.wanted = modulus_of(options.enter);
  const std::vector<Method> methods = methods_of(options, problem);
  check_output(options);
  for (const Method& method : methods) one_step_map(method, problem, question.h);  // before any is looked at
  std::vector<Fidelity> rows;
  std::optional<Interrupted> interrupted;
  try {
    Progress progress(console, "fidelity");
    const LeavesIterations leaves(interrupt_flag(), [] { throw Interrupted{"no method was finished"}; });
    question.watch = [&] {
      if (interrupt_flag()) throw Interrupted{"no method was finished"};
      progress.update(static_cast<double>(rows.size()) / static_cast<double>(methods.size()),
                      methods[std::min(rows.size(), methods.size() - 1)].id);
    };
    const FidelityModel model = fidelity_model(problem, question.watch);
    for (const Method& method : methods) rows.push_back(fidelity(method, model, question));
  } catch (const Interrupted&) {
    if (rows.empty()) throw;
    interrupted.emplace("the methods that were finished are shown");
  }
  if (std::ranges::any_of(rows, &Fidelity::contradiction)) console.exit_code = Exit::failed;
  print_rows(rows, problem, options, question, console);
  if (!options.output.empty())
    write_svg(options.output, figure_of(rows, problem, options), "fidelity", "figure", console);
  if (interrupted) throw *interrupted;
}

}  // namespace

void add_fidelity(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "fidelity", "Show what the steps of a method make of stiffness and damping",
      {"hmax fidelity --mesh cube:n=2 --model mass_spring --load press --rate 100",
       "hmax fidelity --mesh cube:n=2 --model fem_neo_hookean --load gravity --rate 60 --method vbd:iterations=5 --verify",
       "hmax fidelity --problem liver_cubic --rate 10 --method implicit_euler --method newmark",
       "hmax fidelity --mesh phantom --load press --rate 60 --method vbd --map iterations,substeps --output vbd.svg"},
      show_fidelity);
  options.problem.add_to(command);
  add_number(command, "--rate", options.rate, "frames a second, each one step of the method [1/s]");
  add_repeated(command, "--method", options.methods,
               "a method with its parameters, like vbd:iterations=5,substeps=2; may be repeated; those that "
               "simulators use by default",
               "NAME");
  add_flag(command, "--verify", options.verify, "observe runs as well: from rest, and from each mode");
  add_flag(command, "--ceiling", options.ceiling, "the largest modulus that the steps can show [Pa]");
  add_text(command, "--enter", options.enter,
           "a modulus that is to be shown, like 5kPa: which one to enter for it", "E");
  add_text(command, "--map", options.map,
           "one method over iterations,substeps, from 1 to 200 iterations a frame: what more work shows",
           "iterations,substeps");
  add_text(command, "--output", options.output, "a figure of the map", "FILE.svg");
  add_force(command);
}

}  // namespace hmax
