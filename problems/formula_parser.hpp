/// Formulas as text.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "problems/formula_graph.hpp"

namespace hmax {

/// What is wrong with a formula, and from which character on.
class FormulaError : public std::runtime_error {
 public:
  FormulaError(const std::string& sentence, std::size_t position)
      : std::runtime_error(sentence), position_(position) {}
  [[nodiscard]] std::size_t position() const { return position_; }

 private:
  std::size_t position_;
};

/// What names stand for: states, parameters and constants.
using FormulaNames = std::map<std::string, FormulaNodeId, std::less<>>;

/// The functions that a formula may call, in alphabetical order.
const std::vector<std::string>& formula_functions();

/// The operators and functions in one sentence, for help and error messages.
std::string formula_language();

/// "did you mean 'k1'?" where a known name is near, else the list of what is known.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// 'text', with control characters as '?'.
std::string quoted(std::string_view text);

/// Adds a formula to a graph. From weak to strong: `a ? b : c`, ||, &&, comparisons, + -, * / and signs, ^ or
/// **, which groups from the right. -x^2 is -(x^2).
/// @param names  what names other than those of functions mean
/// @return  the node of its value
/// @throws FormulaError  where the text is no formula: what is wrong and what to do
FormulaNodeId parse_formula(std::string_view text, const FormulaNames& names, FormulaGraph& graph);

}  // namespace hmax
