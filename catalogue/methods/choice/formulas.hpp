/// What the stability analysis can be asked about by name: the methods of the catalogue, and formulas that no
/// stepper of the house steps by themselves.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/amplification/amplification.hpp"
#include "catalogue/methods/catalogue.hpp"

namespace hmax {

/// A method as its stability sees it.
struct Formula {
  std::string id{};
  int order = 0;
  /// Evaluations of f that a step costs; 0 where the solution of equations rules.
  int evaluations = 0;
  std::shared_ptr<const Amplification> amplification;
  std::shared_ptr<const Amplification> explicit_half{};  ///< of implicit-explicit pairs: nothing stiff
  std::optional<Method> method{};                        ///< of the catalogue, where it is one
};

/// The patterns of formulas, for help and errors: "bdf_K", ...
std::vector<std::string> formula_patterns();

/// A method of the catalogue by id, alias or with parameters; or
///   adams_bashforth_K, abm_pece_K, abm_pec_K, adams_moulton_K   K = 1 .. 12
///   adams_pece:order=K                                          the pair of ode113 held at one order
///   bdf_K                                                       K = 1 .. 6
///   rkc_2:stages=S, rkl_2:stages=S                              the stage number held
/// @throws InputError with a suggestion for anything else, and for methods that have no map of their own
Formula find_formula(std::string_view name);

/// A method as its stability sees it. @throws InputError when it chooses its steps, and its order, as it runs
Formula formula_of(const Method& method);

/// The formulas of a list: names as of find_formula, families, or "all"; for rkc_2 and its like one that is
/// held.
std::vector<Formula> choose_formulas(const std::vector<std::string>& names);

}  // namespace hmax
