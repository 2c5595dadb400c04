/// The methods and formulas of a list of names, and what is left out of it.
#pragma once

#include <string>
#include <vector>

#include "catalogue/methods/method.hpp"

namespace hmax {

struct Formula;  // catalogue/methods/choice/formulas.hpp

/// A method that a family or `all` holds, and that cannot be taken.
struct LeftOut {
  std::string id;
  std::string why;  ///< "steps positions and velocities, which van_der_pol does not have"
};

struct ChosenMethods {
  std::vector<Method> methods;
  std::vector<LeftOut> left_out;
};
struct ChosenFormulas {
  std::vector<Formula> formulas;
  std::vector<LeftOut> left_out;
  std::vector<std::string>
      held;  ///< sentences: which formula stands for a method that chooses its own as it runs
};

/// As choose_methods, with what the problems do not suit.
ChosenMethods chosen_methods(const std::vector<std::string>& names, const std::vector<Problem>& problems);

/// What one name adds to a choice.
void add_methods(const std::string& name, const std::vector<Problem>& problems, ChosenMethods& chosen);
/// @throws InputError  where a family was named and nothing is taken
void require_any(const ChosenMethods& chosen, const std::vector<std::string>& names);

/// As choose_methods, and by name the formulas of find_formula that no stepper takes: their `bind` is empty,
/// and their family is "formula". With what the problems do not suit.
ChosenMethods chosen_methods_and_formulas(const std::vector<std::string>& names,
                                          const std::vector<Problem>& problems);

/// As choose_formulas, with what has no stability of its own.
ChosenFormulas chosen_formulas(const std::vector<std::string>& names);

/// "adams_pece, cvode_adams: no order of their own", a line for each reason.
std::vector<std::string> in_words(const std::vector<LeftOut>& left_out);

/// Adds what is not there yet, by id.
template <class Item>
void add_once(std::vector<Item>& all, Item item) {
  for (const Item& one : all)
    if (one.id == item.id) return;
  all.push_back(std::move(item));
}

}  // namespace hmax
