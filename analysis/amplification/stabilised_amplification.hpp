/// The amplification of stabilised Runge-Kutta methods by the recurrence of their stages.
/// R_s(z) is a polynomial of degree s with |R_s| <= 1 (damped: below) on [-beta(s), 0], beta growing with
/// s^2: for RKC of order 2 about 2/3 (s^2 - 1) (1 - 2/15 eps) [sommeijer1998rkc]. No polynomial in z is
/// formed: its terms would cancel for large s.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/amplification/amplification.hpp"
#include "integrators/explicit/stabilized_rk.hpp"

namespace hmax {

namespace detail {

using StabilisedStages = std::vector<StabilizedStage<double>>;

/// R_s(z): the stages of StabilizedRk on y' = lambda y.
/// Recurrence of three terms, with Y_0 = 1 and Y_1 = 1 + mu_f z:
///   Y_j = mu Y_(j-1) + nu Y_(j-2) + rest + z (mu_f Y_(j-1) + gamma_f),   R_s = Y_s.
Complex stabilised_step(const StabilisedStages& stages, Complex z);

/// Whether |R_s(z)| > 1 for arbitrarily small |z| along a direction with |exp z| = 1.
/// By c_3 and c_4 of R; the methods have order 2.
bool stabilised_grows_at_origin(const StabilisedStages& stages);

}  // namespace detail

/// With s stages, or with as many as the stepper takes for h times the spectral radius of the model.
/// A chosen number of stages makes the map depend on h |lambda_max| besides z, so that R(z) exists for a
/// fixed number only.
/// @param stages  0: chosen as the stepper does
template <class Polynomials>
Amplification stabilised_amplification(int stages = 0) {
  const auto most = StabilizedRk<Polynomials, Eigen::VectorXd>::max_stages();
  const double farthest = Polynomials::template reach<double>(most);
  const auto with = [](int s) {
    detail::StabilisedStages made;
    make_stages<Polynomials>(s, made);
    return made;
  };
  const auto chosen = [most, farthest](double x) {
    return std::min(most, Polynomials::template stages<double>(std::min(x, farthest)));
  };
  Amplification amplification;
  amplification.of_eigenmode = [=](const Eigenmode& mode) {
    Growth growth;
    growth.scale = 1 / std::abs(mode.lambda);
    // The reach beta(s) bounds the real stability interval; twice that is far enough to see the exit.
    const double reach = stages > 0 ? Polynomials::template reach<double>(stages) : farthest;
    growth.farthest = 2 * reach;
    // What decays leaves nowhere before the reach, since stages are chosen by a radius that its rate does not
    // exceed. Before it there would be thousands of stages to evaluate beside a fast mode.
    const bool covered = stages > 0 || mode.radius >= (1 - 1e-12) * std::abs(mode.lambda);
    if (covered && mode.lambda.imag() == 0 && mode.lambda.real() < 0) growth.nearest = reach;
    growth.grows_at_origin =
        mode.lambda.real() == 0 && detail::stabilised_grows_at_origin(with(stages > 0 ? stages : chosen(0)));
    if (stages > 0) {
      growth.radius = [lambda = mode.lambda, made = with(stages)](double h) {
        return std::abs(detail::stabilised_step(made, h * lambda));
      };
    } else {
      growth.radius = [=, made = detail::StabilisedStages{}](double h) mutable {
        const int s = chosen(h * mode.radius);
        if (static_cast<int>(made.size()) != s) made = with(s);
        return std::abs(detail::stabilised_step(made, h * mode.lambda));
      };
    }
    return growth;
  };
  if (stages > 0)
    amplification.R = [made = with(stages)](Complex z) { return detail::stabilised_step(made, z); };
  return amplification;
}

}  // namespace hmax
