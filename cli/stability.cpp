/// hmax stability limits | region | numerical-damping | predict | map
#include "cli/stability.hpp"

#include <cmath>
#include <fstream>
#include <numbers>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/limits.hpp"
#include "analysis/numerical_damping.hpp"
#include "analysis/region.hpp"
#include "bench/formulas.hpp"
#include "cli/choices.hpp"
#include "cli/commands.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

std::string number_or_unbounded(double value, int digits = 10) {
  return std::isinf(value) ? "unbounded" : short_number(value, digits);
}

std::vector<Formula> formulas_of(const std::string& names) {
  if (names.empty())
    throw InputError(
        "no method is given; name one with --method, like rk4, adams_pece:order=4 or bdf_3, or several with "
        "commas");
  return choose_formulas(parse_names("--method", names));
}

// ---- limits

Json to_json(const Formula& formula, const StabilityLimits& limits) {
  const bool motion = static_cast<bool>(formula.amplification->of_oscillation);
  Json lobes = Json::array();
  for (const Lobe& lobe : limits.lobes)
    lobes.push_back({{"axis", lobe.imaginary ? "imaginary" : "real"},
                     {"from", lobe.from},
                     {"to", number_or_word(lobe.to)}});
  Json document{
      {"method", formula.id},
      {"order", formula.order},
      {"real", motion ? Json() : number_or_word(limits.real)},
      {"imaginary", number_or_word(limits.imaginary)},
      {"imaginary_weak", number_or_word(limits.imaginary_weak)},
      {"alpha_degrees", limits.alpha_degrees ? Json(*limits.alpha_degrees) : Json()},
      {"a_stable", limits.a_stable},
      {"l_stable", limits.l_stable},
      {"at_infinity",
       limits.at_infinity && std::isfinite(*limits.at_infinity) ? Json(*limits.at_infinity) : Json()},
      {"evaluations", formula.evaluations > 0 ? Json(formula.evaluations) : Json()},
      {"derived_from", formula.amplification->measured ? "steps of the code" : "coefficients"},
      {"lobes", lobes}};
  if (motion) {
    document["status"] =
        "steps positions and velocities: `imaginary` is the undamped omega h, and a real eigenvalue alone is "
        "no motion";
    document["critically_damped"] = number_or_word(limits.real);
  }
  if (formula.explicit_half) {
    const StabilityLimits half = stability_limits(*formula.explicit_half);
    document["nothing_stiff"] = {{"real", number_or_word(half.real)},
                                 {"imaginary", number_or_word(half.imaginary)},
                                 {"imaginary_weak", number_or_word(half.imaginary_weak)}};
  }
  return document;
}

void limits(const std::string& names, Console& console) {
  const std::vector<Formula> formulas = formulas_of(names);
  Json documents = Json::array();
  TextTable table({"method", "real", "imaginary", "weakly", "alpha [deg]", "A", "L", "at infinity"});
  std::string remarks;
  for (const Formula& formula : formulas) {
    const StabilityLimits found = stability_limits(*formula.amplification);
    documents.push_back(to_json(formula, found));
    const bool motion = static_cast<bool>(formula.amplification->of_oscillation);
    table.add(
        {formula.id, motion ? "-" : number_or_unbounded(found.real), number_or_unbounded(found.imaginary),
         number_or_unbounded(found.imaginary_weak),
         found.alpha_degrees ? short_number(*found.alpha_degrees, 6) : "-", found.a_stable ? "yes" : "no",
         found.l_stable ? "yes" : "no",
         found.at_infinity && std::isfinite(*found.at_infinity) ? short_number(*found.at_infinity, 4) : "-"});
    for (const Lobe& lobe : found.lobes)
      remarks += fmt::format("{}: stable again on the {} axis from {} to {}, behind a gap\n", formula.id,
                             lobe.imaginary ? "imaginary" : "real", short_number(lobe.from, 9),
                             number_or_unbounded(lobe.to, 9));
    if (formula.explicit_half) {
      const StabilityLimits half = stability_limits(*formula.explicit_half);
      remarks += fmt::format("{}: all of f stiff; with nothing stiff real {}, imaginary {}\n", formula.id,
                             number_or_unbounded(half.real), number_or_unbounded(half.imaginary));
    }
    if (formula.amplification->measured)
      remarks += fmt::format("{}: from steps of its code, not from coefficients\n", formula.id);
  }
  if (console.json) {
    console.print_json(formulas.size() == 1 ? documents.front() : documents);
    return;
  }
  console.print(table.text(console));
  if (!remarks.empty()) console.print("\n" + remarks);
  console.print(
      "\nz = h lambda of y' = lambda y: [-real, 0] and i [0, imaginary] are stable, up to the first exit "
      "from the\n"
      "origin. weakly: where a step first amplifies by more than 1e-6. alpha: half the angle of the stable "
      "wedge.\n"
      "'-' under real: the method steps positions and velocities, and imaginary is its omega h without "
      "damping.\n");
}

// ---- region

struct RegionOptions {
  std::string method, window, output;
  int cells = 400;
};

/// The window of the user, or one that fits.
PlaneWindow window_for(const RegionOptions& options, const Amplification& amplification) {
  if (options.window.empty()) return window_of(amplification);
  const std::vector<double> numbers = parse_numbers("--window", options.window);
  if (numbers.size() != 4 || !(numbers[0] < numbers[1]) || !(numbers[2] < numbers[3]) ||
      !std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }))
    throw InputError(
        fmt::format("--window {} is no rectangle; write re_from,re_to,im_from,im_to with smaller numbers "
                    "first, like -4,1,-4,4",
                    options.window));
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

void region(const RegionOptions& options, Console& console) {
  const std::vector<Formula> formulas = formulas_of(options.method);
  Json documents = Json::array();
  std::string csv = "method,curve,re,im\n", text;
  for (const Formula& formula : formulas) {
    const PlaneWindow window = window_for(options, *formula.amplification);
    const std::vector<RegionCurve> curves =
        region_boundary(stable_at(*formula.amplification), window, options.cells);
    Json list = Json::array(), about = Json::array();
    text += fmt::format("{}: {} closed curve{} in [{}, {}] x i [{}, {}]\n", formula.id, curves.size(),
                        curves.size() == 1 ? "" : "s", short_number(window.re_from, 4),
                        short_number(window.re_to, 4), short_number(window.im_from, 4),
                        short_number(window.im_to, 4));
    for (std::size_t i = 0; i < curves.size(); ++i) {
      Json points = Json::array();
      for (const Complex z : curves[i].points) {
        points.push_back({z.real(), z.imag()});
        csv += fmt::format("{},{},{},{}\n", formula.id, i, to_text(z.real()), to_text(z.imag()));
      }
      points.push_back(points.front());
      list.push_back(std::move(points));
      const double area = curves[i].area();
      about.push_back({{"area", area}, {"hole", area < 0}, {"clipped", curves[i].clipped}});
      text += fmt::format("  {} of area {}, {} points{}\n", area < 0 ? "hole" : "outline",
                          short_number(std::abs(area)), curves[i].points.size(),
                          curves[i].clipped ? ", closed along the edge of the window" : "");
    }
    documents.push_back({{"method", formula.id},
                         {"window", {window.re_from, window.re_to, window.im_from, window.im_to}},
                         {"curves", std::move(list)},
                         {"about", std::move(about)}});
  }
  if (!options.output.empty()) {
    std::ofstream file(options.output, std::ios::binary);
    file << csv;
    if (!file.flush())
      throw InputError(
          fmt::format("{} cannot be written; choose another place with --output", options.output));
    text += fmt::format("The points: {}\n", options.output);
  }
  if (console.json) return console.print_json(formulas.size() == 1 ? documents.front() : documents);
  console.print(text);
}

// ---- numerical damping

struct DampingOptions {
  std::string method;
  std::optional<double> h, frequency, zeta;
};

void numerical_damping(const DampingOptions& options, Console& console) {
  const auto positive = [](const std::optional<double>& value, std::string_view what,
                           std::string_view example) {
    if (!value) throw InputError(fmt::format("{} is missing; give it, for instance {}", what, example));
    if (!(*value > 0) || !std::isfinite(*value))
      throw InputError(fmt::format("{} is {} but must be a positive finite number, for instance {}", what,
                                   to_text(*value), example));
    return *value;
  };
  const double h = positive(options.h, "the step --h [s]", "--h 0.01");
  const double frequency = positive(options.frequency, "the frequency --frequency [Hz]", "--frequency 8");
  const double zeta = options.zeta.value_or(0);
  if (!(zeta >= 0) || !std::isfinite(zeta))
    throw InputError(fmt::format("the damping ratio --zeta is {} but must not be negative", to_text(zeta)));
  const double omega = 2 * std::numbers::pi * frequency;
  Json documents = Json::array();
  TextTable table({"method", "damping ratio", "added", "seen at [Hz]", "period error", "growth a step"});
  const std::vector<Formula> formulas = formulas_of(options.method);
  for (const Formula& formula : formulas) {
    const ShownOscillation shown = shown_oscillation(*formula.amplification, omega, zeta, h);
    const auto finite = [](double value) { return std::isfinite(value) ? Json(value) : Json(); };
    documents.push_back({{"method", formula.id},
                         {"h", h},
                         {"frequency", frequency},
                         {"zeta", zeta},
                         {"zeta_shown", finite(shown.zeta)},
                         {"zeta_added", finite(shown.zeta - zeta)},
                         {"frequency_shown", finite(shown.frequency_damped)},
                         {"period_error", finite(shown.period_error)},
                         {"spectral_radius", finite(shown.spectral_radius)},
                         {"stable", shown.spectral_radius <= 1 + 1e-12}});
    table.add({formula.id, short_number(shown.zeta, 4), short_number(shown.zeta - zeta, 4),
               short_number(shown.frequency_damped, 4),
               std::isfinite(shown.period_error) ? fmt::format("{:.2f} %", 100 * shown.period_error) : "-",
               short_number(shown.spectral_radius, 6)});
  }
  if (console.json) return console.print_json(formulas.size() == 1 ? documents.front() : documents);
  console.print(table.text(console));
  console.print(fmt::format("\nA mode of {} Hz with {} of critical damping, integrated with h = {} s.\n",
                            short_number(frequency), short_number(zeta), short_number(h)));
}

}  // namespace

Json number_or_word(double value) {
  return std::isnan(value) ? Json() : std::isinf(value) ? Json("unbounded") : Json(value);
}

void add_stability(CLI::App& app, Console& console) {
  CLI::App& stability = *app.add_subcommand("stability", "Say how large a step is stable, and prove it");
  stability.require_subcommand(1);
  const std::string formulas = "Ids, aliases or families of `hmax list methods`, all, or " +
                               fmt::format("{}", fmt::join(formula_patterns(), ", "));

  CLI::App& limits_command = add_command(stability, console, "limits",
                                         "The stable interval of each axis, A(alpha), A- and L-stability",
                                         {"hmax stability limits --method rk4",
                                          "hmax stability limits --method bdf_3,adams_pece:order=4 --json"});
  const auto method = std::make_shared<std::string>();
  limits_command.add_option("--method,--methods", *method, formulas)->type_name("A,B");
  limits_command.callback([method, &console] { limits(*method, console); });

  CLI::App& region_command =
      add_command(stability, console, "region", "The boundary of the stability region as closed curves",
                  {"hmax stability region --method dormand_prince_54",
                   "hmax stability region --method rk4 --window -4,1,-4,4 --json"});
  const auto options = std::make_shared<RegionOptions>();
  region_command.add_option("--method,--methods", options->method, formulas)->type_name("A,B");
  region_command
      .add_option("--window", options->window,
                  "Part of the plane, re_from,re_to,im_from,im_to; one that fits by default")
      ->type_name("NUMBERS");
  region_command
      .add_option("--cells", options->cells, "Squares along the longer side of the grid; 400 by default")
      ->check(CLI::Range(2, 4000))
      ->type_name("NUMBER");
  region_command.add_option("--output", options->output, "Write the points of the curves to this CSV file")
      ->type_name("FILE.csv");
  region_command.callback([options, &console] { region(*options, console); });

  CLI::App& damping_command =
      add_command(stability, console, "numerical-damping",
                  "The damping and the change of period that a method adds to a mode",
                  {"hmax stability numerical-damping --method implicit_euler --h 0.01 --frequency 8"});
  const auto damping = std::make_shared<DampingOptions>();
  damping_command.add_option("--method,--methods", damping->method, formulas)->type_name("A,B");
  add_number(damping_command, "--h", damping->h, "The step [s]");
  add_number(damping_command, "--frequency", damping->frequency, "Undamped frequency of the mode [Hz]");
  add_number(damping_command, "--zeta", damping->zeta, "Damping ratio of the mode; 0 by default");
  damping_command.callback([damping, &console] { numerical_damping(*damping, console); });

  add_stability_predict(stability, console);
}

}  // namespace hmax
