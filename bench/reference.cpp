/// References: solutions that errors are measured against, made by engines that take no part.
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "bench/catalogue.hpp"
#include "bench/formula_reference.hpp"
#include "problems/oscillator_reference.hpp"

namespace hmax {

Reference make_reference(const Problem& problem, double t_end) {
  if (const auto* oscillator = std::get_if<Oscillator>(&problem.system)) {
    auto taylor = std::make_shared<const OscillatorReference>(oscillator->parameters(),
                                                              Eigen::Vector2d(problem.y0), t_end);
    return {.at = [taylor](double t) -> Eigen::VectorXd { return taylor->at(t); },
            .valid_until = taylor->valid_until(),
            .error_bound = taylor->error_bound(),
            .name = "Taylor series of order 30 in long double",
            .extended_at = [taylor](long double t) -> Eigen::Vector<long double, Eigen::Dynamic> {
              return taylor->extended_at(t);
            }};
  }
  auto formula = std::make_shared<FormulaReference>(std::get<AnySystem>(problem.system), problem.y0, t_end);
  return {.at = [formula](double t) { return formula->at(t); },
          .valid_until = formula->valid_until(),
          .error_bound = formula->error_bound(),
          .name = formula->name(),
          .extended_at = nullptr};
}

}  // namespace hmax
