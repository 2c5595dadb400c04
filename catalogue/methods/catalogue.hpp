/// Every method by name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "integrators/explicit/runtime_tableau.hpp"

namespace hmax {

/// Every method, in the order in which they are listed.
const std::vector<Method>& methods();

/// A method by id or alias, with parameters if it has some: "rk4", "ode45", "newmark:beta=0.25,gamma=0.5".
/// @throws InputError with a suggestion when there is none
Method find_method(std::string_view name);

/// The method with other values of some of its parameters.
/// @throws InputError  for names that it has not, and values that make no method
Method with_values(const Method& method, const Parameters& changed);

/// The families of methods(), in their order.
std::vector<std::string> method_families();

/// The methods of a list of names. A name is an id or alias as of find_method, a family
/// ("explicit_runge_kutta") or "all"; of the last two those are taken that suit all `problems`. Each is taken
/// once.
/// @throws InputError for unknown names, and where nothing is left of families (chosen_methods.hpp says what
/// is left out)
std::vector<Method> choose_methods(const std::vector<std::string>& names,
                                   const std::vector<Problem>& problems);

/// The method of a user's tableau.
Method make_method(const RuntimeTableau& tableau);

}  // namespace hmax
