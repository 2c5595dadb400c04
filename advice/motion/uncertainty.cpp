#include "advice/motion/uncertainty.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/errors.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"

namespace hmax {

namespace {

struct Quantity {
  std::string_view name;
  double spread;
  std::vector<std::string_view> parameters;
};

const std::array<Quantity, 3>& quantities() {
  static const std::array<Quantity, 3> all{
      {{"stiffness", stiffness_spread, {"E", "fibre_E", "k", "k1", "k3"}},
       {"mass", 0.077, {"rho", "mass", "m"}},
       {"damping", 0.33, {"alpha", "beta", "damper", "c"}}}};
  return all;
}

/// Parameters of the problem that belong to a quantity, those of single regions too, times a factor. A
/// density does not act where the mass of the body is given. None of formulas: their k may be anything.
std::vector<std::pair<std::string, double>> scaled(const Problem& problem, const Quantity& quantity,
                                                   double factor) {
  const bool has_mass = std::ranges::any_of(problem.parameters, [](const auto& parameter) {
    return parameter.first == "mass" && parameter.second != 0;
  });
  std::vector<std::pair<std::string, double>> values;
  if (problem.kind() != ModelKind::body && problem.kind() != ModelKind::oscillator) return values;
  for (const auto& [name, value] : problem.parameters) {
    const std::string_view stem = std::string_view(name).substr(0, name.find(':'));
    if (value == 0 || (stem == "rho" && has_mass)) continue;
    if (std::ranges::find(quantity.parameters, stem) != quantity.parameters.end())
      values.emplace_back(name, factor * value);
  }
  return values;
}

}  // namespace

std::vector<LimitBand> limit_bands(const Method& method, const Problem& problem, const Eigen::VectorXd& y,
                                   const ProblemWith& make) {
  std::vector<LimitBand> bands;
  const auto limit_of = [&](const Quantity& quantity, double factor) {
    const Problem changed = make(scaled(problem, quantity, factor));
    return predict(method, linearised(changed, 0, y)).h_max.value_or(std::nan(""));
  };
  std::optional<double> unchanged;
  for (const Quantity& quantity : quantities()) {
    if (scaled(problem, quantity, 1).empty()) continue;
    try {
      if (!unchanged) unchanged = predict(method, linearised(problem, 0, y)).h_max.value_or(std::nan(""));
      if (!(*unchanged > 0 && std::isfinite(*unchanged))) return bands;
      const double low = limit_of(quantity, 1 - quantity.spread),
                   high = limit_of(quantity, 1 + quantity.spread);
      if (!(low > 0 && high > 0 && std::isfinite(low) && std::isfinite(high))) continue;
      bands.push_back(
          {.quantity = quantity.name,
           .spread = quantity.spread,
           .low = std::min(low, high) / *unchanged,
           .high = std::max(low, high) / *unchanged,
           .exponent = std::log(high / low) / std::log((1 + quantity.spread) / (1 - quantity.spread))});
    } catch (const InputError&) {
      continue;  // no such model
    }
  }
  return bands;
}

std::optional<Linearised> stiffer(const Problem& problem, const Eigen::VectorXd& y, const ProblemWith& make,
                                  double factor) {
  const auto values = scaled(problem, quantities().front(), factor);
  if (values.empty()) return std::nullopt;
  try {
    return linearised(make(values), 0, y);
  } catch (const InputError&) {
    return std::nullopt;  // no such model
  }
}

}  // namespace hmax
