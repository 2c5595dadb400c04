/// What the subcommands of `hmax stability` share.
#pragma once

#include "analysis/amplification/limits.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "cli/shared/console.hpp"
#include "cli/shared/options.hpp"
#include "limits/documents/number_json.hpp"

namespace hmax {

/// The formulas of --method; what is left out of families is warned of. @throws InputError when there is none
std::vector<Formula> formulas_of(const std::string& names, Console& console);

/// What --methods can name, for --help.
std::string words_of_formulas();

/// The stable intervals and what else tells a formula's limits: cells of a table from "real" to "at
/// infinity".
std::vector<std::string> limit_cells(const Formula& formula, const StabilityLimits& limits, int digits);

/// --methods and --tableau: names, and a tableau of the user's own beside them
struct MethodsChoice {
  std::string names, tableau;

  void add_to(CLI::App& command);
  /// @throws InputError when neither is given, or something is unknown
  [[nodiscard]] std::vector<Formula> formulas(Console& console) const;
  /// The same for predictions on these problems; what has no code has no `bind`.
  [[nodiscard]] std::vector<Method> methods(const std::vector<Problem>& problems, Console& console) const;
};

void add_stability_region(CLI::App& stability, Console& console);
void add_stability_damping(CLI::App& stability, Console& console);
void add_stability_predict(CLI::App& stability, Console& console);
void add_stability_gallery(CLI::App& stability, Console& console);
void add_stability_map(CLI::App& stability, Console& console);
void add_stability_frozen(CLI::App& stability, Console& console);
void add_stability_modes(CLI::App& stability, Console& console);
void add_stability_matrices(CLI::App& stability, Console& console);

}  // namespace hmax
