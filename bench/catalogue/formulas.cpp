#include "bench/catalogue/formulas.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/amplification/multistep_amplification.hpp"
#include "analysis/amplification/stabilised_amplification.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

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
  return {.id = {},
          .order = order,
          .evaluations = evaluations,
          .amplification = shared(std::move(amplification))};
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
       [](int s) { return formula(2, s, stabilised_amplification<Rkc2>(s)); }, "number of stages", 11},
      {"rkl_2:stages=", "S", 3, most_stages,
       [](int s) { return formula(2, s, stabilised_amplification<Rkl2>(s)); }, "number of stages", 11},
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

/// A formula of the patterns; nothing where `name` follows none of them.
std::optional<Formula> held_formula(std::string_view name) {
  for (const Pattern& pattern : patterns()) {
    const std::string_view prefix = pattern.prefix;
    if (!name.starts_with(prefix)) continue;
    const std::optional<int> number = number_behind(name, prefix);
    if (!number || *number < pattern.least || *number > pattern.most)
      throw InputError(fmt::format("'{}' is no formula: {} of {}{} is a whole number from {} to {}", name,
                                   pattern.letter, prefix, pattern.letter, pattern.least, pattern.most));
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
                .aliases = {},
                .family = "formula",
                .order = formula.order,
                .is_explicit = formula.evaluations > 0,
                .needs_jacobian = formula.evaluations == 0,
                .engine = "none",
                .source = {},
                .bind = {}};
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
  // A pattern that begins with the id of a method holds what the method chooses.
  const auto held = std::ranges::find_if(patterns(), [start = method.id + ":"](const Pattern& pattern) {
    return pattern.prefix.starts_with(start);
  });
  if (held != patterns().end())
    throw InputError(fmt::format(
        "{} chooses its {} as it runs, and every {} has a stability of its own; hold one, for instance {}{}",
        method.id, held->chosen, held->chosen, held->prefix, held->example));
  return formula_of(method);
}

Formula formula_of(const Method& method) {
  if (!method.amplification)
    throw InputError(fmt::format(
        "{} chooses its steps, and its order, as it runs: it has no stability of its own; formulas "
        "that are held are bdf_K, adams_moulton_K and adams_pece:order=K",
        method.id));
  Formula formula{
      .id = method.id, .order = method.order, .amplification = method.amplification, .method = method};
  if (method.is_explicit) formula.evaluations = evaluations_of(method);
  if (method.needs_split) formula.explicit_half = explicit_half_of(method.amplification);
  return formula;
}

std::vector<Method> choose_methods_and_formulas(const std::vector<std::string>& names,
                                                const std::vector<Problem>& problems) {
  std::vector<Method> chosen;
  for (const std::string& name : with_their_parameters(names)) {
    const std::optional<Formula> held = held_formula(name);
    if (held && !held->method) {
      chosen.push_back(without_code(*held));
      continue;
    }
    const std::vector<Method> known = choose_methods({name}, problems);
    chosen.insert(chosen.end(), known.begin(), known.end());
  }
  return chosen;
}

std::vector<Formula> choose_formulas(const std::vector<std::string>& names) {
  const std::vector<std::string> families = method_families();
  std::vector<Formula> chosen;
  for (const std::string& name : with_their_parameters(names)) {
    if (name != "all" && std::ranges::find(families, name) == families.end()) {
      chosen.push_back(find_formula(name));
      continue;
    }
    for (const Method& method : methods())
      if ((name == "all" || method.family == name) && method.amplification && !method.stages_by_radius)
        chosen.push_back(formula_of(method));
  }
  return chosen;
}

}  // namespace hmax
