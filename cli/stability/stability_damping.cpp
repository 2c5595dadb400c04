/// hmax stability numerical-damping: of one mode by formula, of a body by steps
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/amplification/numerical_damping.hpp"
#include "catalogue/models/model.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/options.hpp"
#include "cli/stability/stability.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "limits/documents/fidelity_json.hpp"
#include "limits/fidelity/fidelity.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

struct DampingOptions {
  MethodsChoice methods;
  ProblemChoice problem;
  std::optional<double> h, frequency, zeta;
};

/// A difference that is rounding is none.
double without_rounding(double difference) {
  constexpr double rounding = 1e-14;
  return std::abs(difference) <= rounding ? 0 : difference;
}

/// "7.92 %"; without a sign what rounds to nothing.
std::string signed_percent(double share) {
  const std::string text = fmt::format("{:.2f} %", 100 * share);
  return text == "-0.00 %" ? text.substr(1) : text;
}

/// What steps of h seconds show where the Nyquist frequency is passed.
/// @param damped  frequency of the mode [Hz]
std::string words_of_aliased(const std::vector<std::string>& methods, double damped, double h) {
  const double nyquist = 1 / (2 * h);
  if (damped > nyquist)
    return fmt::format(
        "The mode oscillates at {} Hz, above the Nyquist frequency 1/(2 h) = {} Hz: the frequencies seen are aliased; "
        "take h below {} s.\n",
        short_number(damped, 4), short_number(nyquist, 4), short_number(1 / (2 * damped), 3));
  return fmt::format(
      "Of {} a step turns the mode by more than half a period: the frequency seen is aliased; take a "
      "smaller h.\n",
      fmt::join(methods, ", "));
}

/// @throws InputError  for what is missing or no positive finite number
double positive(const std::optional<double>& value, std::string_view what, std::string_view example) {
  if (!value) throw InputError(fmt::format("{} is missing; give it, for instance {}", what, example));
  if (!(*value > 0) || !std::isfinite(*value))
    throw InputError(fmt::format("{} is {} but must be a positive finite number, for instance {}", what,
                                 to_text(*value), example));
  return *value;
}

void damping_of_mode(const DampingOptions& options, double h, Console& console) {
  const double frequency = positive(options.frequency, "the frequency --frequency [Hz]", "--frequency 8");
  const double zeta = options.zeta.value_or(0);
  if (!(zeta >= 0 && zeta < 1))
    throw InputError(fmt::format(
        "the damping ratio --zeta is {} but must lie between 0 and 1: a mode that does not oscillate shows no "
        "damping; give for instance --zeta 0.1",
        to_text(zeta)));
  const double omega = 2 * std::numbers::pi * frequency;
  Json documents = Json::array();
  TextTable table({"method", "damping ratio", "added", "seen at [Hz]", "period error", "growth a step"});
  const std::vector<Formula> formulas = options.methods.formulas(console);
  std::vector<std::string> aliased;
  for (const Formula& formula : formulas) {
    const ShownOscillation shown = shown_oscillation(*formula.amplification, omega, zeta, h);
    const auto finite = [](double value) { return std::isfinite(value) ? Json(value) : Json(); };
    const double added = without_rounding(shown.zeta - zeta);
    if (shown.aliased) aliased.push_back(formula.id);
    documents.push_back({{"method", formula.id},
                         {"h", h},
                         {"frequency", frequency},
                         {"zeta", zeta},
                         {"zeta_shown", finite(shown.zeta)},
                         {"zeta_added", finite(added)},
                         {"frequency_shown", finite(shown.frequency_damped)},
                         {"period_error", finite(shown.period_error)},
                         {"nyquist_frequency", 1 / (2 * h)},
                         {"aliased", shown.aliased},
                         {"spectral_radius", finite(shown.spectral_radius)},
                         {"stable", shown.spectral_radius <= 1 + 1e-12}});
    table.add({formula.id, short_number(shown.zeta, 4), short_number(added, 4),
               short_number(shown.frequency_damped, 4),
               std::isfinite(shown.period_error) ? signed_percent(shown.period_error) : "-",
               short_number(shown.spectral_radius, 6)});
  }
  if (console.json) return console.print_json(formulas.size() == 1 ? documents.front() : documents);
  console.print(table.text(console));
  console.print(fmt::format("\nA mode of {} Hz with {} of critical damping, integrated with h = {} s.\n",
                            short_number(frequency), short_number(zeta), short_number(h)));
  if (!aliased.empty()) console.print(words_of_aliased(aliased, frequency * std::sqrt(1 - zeta * zeta), h));
}

std::string table_of(const std::vector<ShownDamping>& rows, const Console& console) {
  TextTable table({"method", "mode [rad/s]", "shown [rad/s]", "damping ratio", "shown", "likeness"});
  for (const ShownDamping& row : rows) {
    for (const ShownMode& mode : row.modes)
      table.add({row.method.id, short_number(mode.omega, 4),
                 std::isnan(mode.omega_shown) ? "-" : short_number(mode.omega_shown, 4),
                 damping_in_words(mode.zeta), damping_in_words(mode.zeta_shown),
                 short_number(mode.likeness, 3)});
    if (row.modes.empty()) table.add({row.method.id, "-", "-", "-", "-", "-"});
  }
  std::string text = table.text(console);
  for (const ShownDamping& row : rows)
    if (!row.status.empty()) text += fmt::format("\n{}: {}", row.method.id, row.status);
  return text + "\n";
}

void damping_of_body(const DampingOptions& options, double h, Console& console) {
  const Problem problem = options.problem.make();
  require_body(
      problem,
      "and has no shapes of modes; leave it out and give the frequency of its mode with --frequency");
  if (options.frequency || options.zeta)
    throw InputError("a body has modes of its own; remove --frequency and --zeta");
  options.problem.remark_idle(console, problem);
  const std::vector<Method> methods = options.methods.methods({problem}, console);
  std::vector<ShownDamping> rows;
  const FidelityModel model = [&] {
    Progress progress(console, "numerical damping");
    const auto watch = [&, tell = progress.watcher()] {
      tell(static_cast<double>(rows.size()) / static_cast<double>(methods.size()));
    };
    FidelityModel found = settled_model(problem, watch);
    for (const Method& method : methods) rows.push_back(shown_damping(method, found, h, watch));
    return found;
  }();
  const bool loaded = !model.equilibrium.isZero(0);
  if (console.json) {
    Json list = Json::array();
    for (const ShownDamping& row : rows) list.push_back(to_json(row));
    return console.print_json(
        {{"model", problem.id}, {"state", loaded ? "equilibrium" : "rest"}, {"rows", list}});
  }
  console.print(fmt::format("{}{}, {}\n{}\nsteps of {} s\n\n{}", problem.id,
                            loaded ? " with " + describe_acting(problem) : "",
                            loaded ? "about the state in which the steps come to rest" : "at rest",
                            body_in_words(problem), short_number(h, 4), table_of(rows, console)));
}

void show_damping(const DampingOptions& options, Console& console) {
  const double h = positive(options.h, "the step --h [s]", "--h 0.01");
  if (options.problem.empty())
    damping_of_mode(options, h, console);
  else
    damping_of_body(options, h, console);
}

}  // namespace

void add_stability_damping(CLI::App& stability, Console& console) {
  const auto [command, options] = add_command(
      stability, console, "numerical-damping", "Show the numerical damping and the period error of a method",
      {"hmax stability numerical-damping --method implicit_euler --h 0.01 --frequency 8",
       "hmax stability numerical-damping --method vbd,implicit_euler --h 0.01 --mesh cube:n=2 --load press"},
      show_damping);
  options.methods.add_to(command);
  add_number(command, "--h", options.h, "Step size [s]");
  add_number(command, "--frequency", options.frequency, "Undamped frequency of the mode [Hz]");
  add_number(command, "--zeta", options.zeta, "Damping ratio of the mode; 0 by default");
  options.problem.add_to(command);
}

}  // namespace hmax
