/// hmax stability limits, and the group of its commands
#include "cli/stability/stability.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/amplification/limits.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/methods/tableau_file.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "limits/documents/method_json.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

std::string number_or_unbounded(double value, int digits = 10) {
  return std::isinf(value) ? "unbounded" : short_number(value, digits);
}

}  // namespace

std::vector<std::string> limit_cells(const Formula& formula, const StabilityLimits& limits, int digits) {
  const bool motion = static_cast<bool>(formula.amplification->of_oscillation);
  return {
      motion ? "-" : number_or_unbounded(limits.real, digits),
      number_or_unbounded(limits.imaginary, digits),
      number_or_unbounded(limits.imaginary_weak, digits),
      limits.alpha_degrees ? short_number(*limits.alpha_degrees, 6) : "-",
      limits.a_stable ? "yes" : "no",
      limits.l_stable ? "yes" : "no",
      limits.at_infinity && std::isfinite(*limits.at_infinity) ? short_number(*limits.at_infinity, 4) : "-"};
}

std::string words_of_formulas() {
  return fmt::format("Ids, aliases or families of `hmax list methods`, all, or {}",
                     fmt::join(formula_patterns(), ", "));
}

namespace {

// ---- limits

void limits(const MethodsChoice& choice, Console& console) {
  const std::vector<Formula> formulas = choice.formulas(console);
  Json documents = Json::array();
  TextTable table({"method", "real", "imaginary", "|R|<=1+1e-6", "alpha [deg]", "A", "L", "at infinity"});
  std::string remarks;
  for (const Formula& formula : formulas) {
    const StabilityLimits found = stability_limits(*formula.amplification);
    documents.push_back(limits_json(formula, found));
    std::vector<std::string> cells = limit_cells(formula, found, 10);
    cells.insert(cells.begin(), formula.id);
    table.add(std::move(cells));
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
      "origin. |R|<=1+1e-6: up to where a step first amplifies by more than 1e-6. alpha: half the angle of the stable "
      "wedge.\n"
      "'-' under real: the method steps positions and velocities, and imaginary is its omega h without "
      "damping.\n");
}

}  // namespace

void MethodsChoice::add_to(CLI::App& command) {
  add_text(command, "--methods,--method", names, words_of_formulas(), "A,B");
  add_text(command, "--tableau", tableau, "A file with an explicit tableau of your own", "FILE");
}

std::vector<Formula> MethodsChoice::formulas(Console& console) const {
  std::vector<Formula> chosen;
  if (!names.empty() || tableau.empty()) chosen = formulas_of(names, console);
  if (!tableau.empty()) chosen.push_back(formula_of(make_method(read_tableau(tableau))));
  return chosen;
}

std::vector<Method> MethodsChoice::methods(const std::vector<Problem>& problems, Console& console) const {
  if (names.empty() && tableau.empty())
    throw InputError(
        "no method is given; name some with --methods, like ode45,newmark,bdf_3, a family of `hmax list "
        "methods`, or all");
  std::vector<Method> chosen;
  if (!names.empty()) {
    ChosenMethods named = chosen_methods_and_formulas(parse_names("--methods", names), problems);
    warn_of_left_out(console, named.left_out);
    chosen = std::move(named.methods);
  }
  if (!tableau.empty()) chosen.push_back(make_method(read_tableau(tableau)));
  return chosen;
}

std::vector<Formula> formulas_of(const std::string& names, Console& console) {
  if (names.empty())
    throw InputError(
        "no method is given; name one with --method, like rk4, adams_pece:order=4 or bdf_3, or several with "
        "commas");
  ChosenFormulas chosen = chosen_formulas(parse_names("--method", names));
  for (const std::string& sentence : chosen.held) console.note(sentence);
  warn_of_left_out(console, chosen.left_out);
  return std::move(chosen.formulas);
}

void add_stability(CLI::App& app, Console& console) {
  CLI::App& stability = add_group(app, "stability", "Predict the largest stable step, and verify it");
  const auto [command, methods] = add_command(
      stability, console, "limits", "Show the stable intervals of the axes, A(alpha), A- and L-stability",
      {"hmax stability limits --method rk4",
       "hmax stability limits --method bdf_3,adams_pece:order=4 --json"},
      limits);
  methods.add_to(command);

  add_stability_region(stability, console);

  add_stability_damping(stability, console);
  add_stability_predict(stability, console);
  add_stability_gallery(stability, console);
  add_stability_map(stability, console);
  add_stability_frozen(stability, console);
  add_stability_modes(stability, console);
  add_stability_matrices(stability, console);
}

}  // namespace hmax
