/// How sure a limit is where the material is known as well as the literature knows it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "limits/linearised_problem.hpp"

namespace hmax {

/// Makes the problem once more with some parameters set to other values.
using ProblemWith = std::function<Problem(const std::vector<std::pair<std::string, double>>& values)>;

/// The limit where some parameters are as small and as large as published values spread.
struct LimitBand {
  std::string_view quantity;  ///< stiffness | mass | damping
  double spread = 0;          ///< relative, to both sides
  double low = 1, high = 1;   ///< the least and the largest of both limits, relative to that without a change
  double exponent = 0;        ///< d ln h / d ln p, over the whole band
};

/// The bands of the limit of a method at a state, with that quantity alone changed and the state kept; of
/// quantities that the problem does not have, or where a limit is missing, there are none; nor of what is
/// neither a body nor the oscillator of the liver, whose parameters mean what their formulas say.
///   stiffness  E, k, k1, k3: 29 %, that of 429 healthy livers, 5.49 +- 1.59 kPa [roulot2008liver]
///   mass       rho, mass, m: 7.7 %, the range 1.2 to 1.4 kg of the female livers of the study
///   damping    alpha, beta, damper, c: 33 %, the range of c of the study, 4.5 to 8 N s/m about 6
/// @param y  the state, shape (dim)
std::vector<LimitBand> limit_bands(const Method& method, const Problem& problem, const Eigen::VectorXd& y,
                                   const ProblemWith& make);

/// Of the stiffness, relative.
inline constexpr double stiffness_spread = 0.29;

/// The problem at a state, with its stiffness times a factor, by default the stiffer end of limit_bands().
/// Nothing of problems that have no bands of the stiffness.
/// @param y  the state, shape (dim)
std::optional<Linearised> stiffer(const Problem& problem, const Eigen::VectorXd& y, const ProblemWith& make,
                                  double factor = 1 + stiffness_spread);

}  // namespace hmax
