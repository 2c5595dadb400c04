#include "catalogue/models/parameter_units.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "catalogue/models/tissue_choice.hpp"

namespace hmax {

namespace {

using Unit = std::pair<std::string_view, std::string_view>;

constexpr Unit of_oscillators[] = {{"m", "kg"},    {"c", "N s/m"}, {"k1", "N/m"},
                                   {"k3", "N/m³"}, {"P", "N"},     {"w", "rad/s"}};

}  // namespace

std::string with_unit(const Problem& problem, std::string_view parameter) {
  if (problem.body) return fmt::format("{} [{}]", parameter, unit_of_tissue_parameter(parameter));
  if (problem.matrices) return fmt::format("{} [{}]", parameter, parameter == "alpha" ? "1/s" : "s");
  if (!std::holds_alternative<Oscillator>(problem.system)) return std::string(parameter);
  const auto* const known = std::ranges::find(of_oscillators, parameter, &Unit::first);
  return fmt::format("{} [{}]", parameter, known == std::end(of_oscillators) ? "1" : known->second);
}

}  // namespace hmax
