#include "catalogue/methods/choice/formulas.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/amplification/multistep_amplification.hpp"
#include "analysis/amplification/stabilised_amplification.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/chosen_methods.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

/// The whole number behind `prefix`, if `name` is made so.
std::optional<int> number_behind(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return std::nullopt;
  const std::optional<double> number = to_number(name.substr(prefix.size()));
  if (!number || *number != std::floor(*number) || std::abs(*number) > 1e6) return std::nullopt;
  return static_cast<int>(*number);
}

struct Pattern {
  std::string_view prefix, letter;
  int least, most;
  Formula (*make)(int);
  std::string_view chosen{};  ///< by a method as it runs, where this holds it
  int example = 0;
};

Formula formula(int order, int evaluations, Amplification amplification) {
  return {.order = order, .evaluations = evaluations, .amplification = shared(std::move(amplification))};
}

constexpr int most_stages = 2000;

const std::vector<Pattern>& patterns() {
  static const std::vector<Pattern> all{
      {"adams_bashforth_", "K", 1, most_adams_steps,
       [](int k) { return formula(k, 1, adams_amplification(AdamsMode::bashforth, k, k)); }},
      {"abm_pece_", "K", 1, most_adams_steps,
       [](int k) { return formula(k, 2, adams_amplification(AdamsMode::pece, k, k)); }},
      {"abm_pec_", "K", 1, most_adams_steps,
       [](int k) { return formula(k, 1, adams_amplification(AdamsMode::pec, k, k)); }},
      {"adams_moulton_", "K", 1, most_adams_steps,
       [](int k) { return formula(k, 0, adams_moulton_amplification(k)); }},
      {"adams_pece:order=", "K", 1, most_adams_steps,
       [](int k) { return formula(k + 1, 2, adams_amplification(AdamsMode::pece, k, k + 1)); }, "order", 4},
      {"bdf_", "K", 1, 6, [](int k) { return formula(k, 0, bdf_amplification(k)); }},
      {"rkc_2:stages=", "S", 2, most_stages,
       [](int s) { return formula(2, s, stabilised_amplification<Rkc2>(s)); }, "number of stages", 10},
      {"rkl_2:stages=", "S", 3, most_stages,
       [](int s) { return formula(2, s, stabilised_amplification<Rkl2>(s)); }, "number of stages", 10},
  };
  return all;
}

/// The half that an implicit-explicit pair makes of f when nothing is declared stiff.
std::shared_ptr<const Amplification> explicit_half_of(const std::shared_ptr<const Amplification>& pair) {
  Amplification half;
  half.of_eigenmode = [pair](const Eigenmode& mode) {
    Eigenmode nothing_stiff = mode;
    nothing_stiff.stiff = 0;
    return pair->of_eigenmode(nothing_stiff);
  };
  half.in_z = half.of_eigenmode(Eigenmode(1)).polynomial;
  return shared(std::move(half));
}

/// Evaluations of f in a step of a run: where the last stage is the first of the next step it costs nothing.
int evaluations_of(const Method& method) { return method.stages - (method.first_same_as_last ? 1 : 0); }

/// The pattern that begins with the id of a method and holds what the method chooses as it runs; null where
/// there is none.
const Pattern* pattern_of(const Method& method) {
  const auto held = std::ranges::find_if(patterns(), [start = method.id + ":"](const Pattern& pattern) {
    return pattern.prefix.starts_with(start);
  });
  return held == patterns().end() ? nullptr : &*held;
}

/// Of a method without an amplification.
std::string_view why_no_stability(const Method& method) {
  if (method.fixed_step && !method.unsuited)
    return "takes parts of h; take it without substeps, with its own step";
  return method.fixed_step
             ? "couples all points of a body in its iterations: no mode alone tells its stability"
             : "chooses its steps, and its order, as it runs: it has no stability of its own";
}

/// A formula of the patterns; nothing where `name` follows none of them.
std::optional<Formula> held_formula(std::string_view name) {
  for (const Pattern& pattern : patterns()) {
    const std::string_view prefix = pattern.prefix;
    if (!name.starts_with(prefix) || name.find(':', prefix.size()) != name.npos) continue;
    const std::optional<int> number = number_behind(name, prefix);
    if (!number || *number < pattern.least || *number > pattern.most)
      throw input_error("'{}' is no formula: {} of {}{} is a whole number from {} to {}", name,
                        pattern.letter, prefix, pattern.letter, pattern.least, pattern.most);
    Formula made = pattern.make(*number);
    made.id = std::string(name);
    for (const Method& method : methods())
      if (method.id == name) made.method = method;
    return made;
  }
  return std::nullopt;
}

/// For predictions only.
Method without_code(const Formula& formula) {
  Method method{.id = formula.id,
                .family = "formula",
                .order = formula.order,
                .is_explicit = formula.evaluations > 0,
                .needs_jacobian = formula.evaluations == 0,
                .engine = "none"};
  method.amplification = formula.amplification;
  return method;
}

}  // namespace

std::vector<std::string> formula_patterns() {
  std::vector<std::string> names;
  for (const Pattern& pattern : patterns())
    names.push_back(fmt::format("{}{}", pattern.prefix, pattern.letter));
  return names;
}

Formula find_formula(std::string_view name) {
  if (std::optional<Formula> held = held_formula(name)) return *std::move(held);
  const Method method = find_method(name);
  if (const Pattern* const held = pattern_of(method))
    throw input_error(
        "{} chooses its {} as it runs, and every {} has a stability of its own; hold one, for instance {}{}",
        method.id, held->chosen, held->chosen, held->prefix, held->example);
  return formula_of(method);
}

Formula formula_of(const Method& method) {
  if (!method.amplification)
    throw input_error("{} {}; formulas that are held are bdf_K, adams_moulton_K and adams_pece:order=K",
                      method.id, why_no_stability(method));
  Formula formula{
      .id = method.id, .order = method.order, .amplification = method.amplification, .method = method};
  if (method.is_explicit) formula.evaluations = evaluations_of(method);
  if (method.needs_split) formula.explicit_half = explicit_half_of(method.amplification);
  return formula;
}

ChosenMethods chosen_methods_and_formulas(const std::vector<std::string>& names,
                                          const std::vector<Problem>& problems) {
  ChosenMethods chosen;
  for (const std::string& name : names) {
    const std::optional<Formula> held = held_formula(name);
    if (held && !held->method)
      add_once(chosen.methods, without_code(*held));
    else
      add_methods(name, problems, chosen);
  }
  require_any(chosen, names);
  return chosen;
}

ChosenFormulas chosen_formulas(const std::vector<std::string>& names) {
  const std::vector<std::string> families = method_families();
  ChosenFormulas chosen;
  for (const std::string& name : names) {
    if (name != "all" && std::ranges::find(families, name) == families.end()) {
      add_once(chosen.formulas, find_formula(name));
      continue;
    }
    for (const Method& method : methods()) {
      if (name != "all" && method.family != name) continue;
      if (const Pattern* const held = pattern_of(method)) {
        Formula formula = *held_formula(fmt::format("{}{}", held->prefix, held->example));
        chosen.held.push_back(fmt::format("{} chooses its {} as it runs; {} is shown, name others with {}{}",
                                          method.id, held->chosen, formula.id, held->prefix, held->letter));
        add_once(chosen.formulas, std::move(formula));
      } else if (method.amplification) {
        add_once(chosen.formulas, formula_of(method));
      } else {
        add_once(chosen.left_out, LeftOut{method.id, std::string(why_no_stability(method))});
      }
    }
  }
  if (chosen.formulas.empty() && !chosen.left_out.empty())
    throw input_error(
        "no method of {} has a stability to show: {}; hold a formula, like bdf_3 or adams_pece:order=4",
        fmt::join(names, ","), fmt::join(in_words(chosen.left_out), "; "));
  return chosen;
}

std::vector<Formula> choose_formulas(const std::vector<std::string>& names) {
  return chosen_formulas(names).formulas;
}

}  // namespace hmax
