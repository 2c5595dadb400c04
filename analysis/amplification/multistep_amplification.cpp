#include "analysis/amplification/multistep_amplification.hpp"

#include <cmath>
#include <span>
#include <utility>

#include "integrators/multistep/adams_coefficients.hpp"

namespace hmax {

namespace {

/// From lambda = 1 to lambda.
/// Only on the imaginary axis may the principal root leave at once: to the left it is below one for small
/// h, to the right the mode grows by itself.
Amplification of_difference_equation(StepPolynomial in_z) {
  Amplification amplification;
  amplification.of_eigenmode = [in_z](const Eigenmode& mode) {
    Growth growth{.polynomial = in_z.along(mode.lambda), .scale = 1 / std::abs(mode.lambda)};
    // On the axis |exp(h lambda)| = 1: the series decides.
    growth.grows_at_origin = mode.lambda.real() == 0 && growth.polynomial->grows_at_origin(mode.lambda);
    return growth;
  };
  amplification.in_z = std::move(in_z);
  return amplification;
}

template <class Differences>
/// From gamma_j of sum_j gamma_j nabla^j f, j < order, to the weights of the values f_n-i:
///   sum_j gamma_j nabla^j f_n = sum_i beta_i f_n-i,   nabla^j f_n = sum_i (-1)^i (j over i) f_n-i.
Polynomial weights(const Differences& differences, int order) {
  const auto k = static_cast<std::size_t>(order);
  Polynomial values(k);
  adams::weights_of_values<long double>(std::span(differences).first(k), values);
  return values;
}

/// beta_i of f_n-i, and beta*_i of f_n+1-i.
Polynomial predictor_weights(int order) {
  static constexpr auto gamma = adams::gamma<most_adams_steps + 1>();
  return weights(gamma, order);
}
Polynomial corrector_weights(int order) {
  static constexpr auto gamma = adams::gamma_star<most_adams_steps + 1>();
  return weights(gamma, order);
}

/// pi(zeta, z) being collected: p[j] holds the coefficients 1, z, z^2 of zeta^j.
/// The coefficient of z^2 is used by pece alone.
class Collected {
 public:
  explicit Collected(std::size_t degree) : p_(degree + 1, Polynomial(3)) {}
  void add(std::size_t power_of_zeta, std::size_t power_of_z, long double c) {
    p_[power_of_zeta][power_of_z] += c;
  }
  Amplification done() && { return of_difference_equation(StepPolynomial::real(p_)); }

 private:
  std::vector<Polynomial> p_;
};

}  // namespace

// Each branch writes the difference equation of its scheme for y' = z y (h = 1) with zeta^n in place of
// y_n, divided by the lowest power.
Amplification adams_amplification(AdamsMode mode, int predictor_order, int corrector_order) {
  const Polynomial beta = predictor_weights(predictor_order);
  const std::size_t k = beta.size();
  if (mode == AdamsMode::bashforth) {
    // y_n+1 = y_n + z sum_i beta_i y_n-i,    zeta^k stands for y_n+1
    Collected pi(k);
    pi.add(k, 0, 1);
    pi.add(k - 1, 0, -1);
    for (std::size_t i = 0; i < k; ++i) pi.add(k - 1 - i, 1, -beta[i]);
    return std::move(pi).done();
  }
  const Polynomial corrector = corrector_weights(corrector_order);
  const std::size_t past = std::max(k, corrector.size());
  // zeta^past stands for y_n+1, zeta^(past-1) for y_n.
  if (mode == AdamsMode::pece) {
    // y_n+1 = y_n + z beta*_0 p + z sum_{i >= 1} beta*_i y_n+1-i,    p = y_n + z sum_i beta_i y_n-i
    Collected pi(past);
    pi.add(past, 0, 1);
    pi.add(past - 1, 0, -1);
    pi.add(past - 1, 1, -corrector[0]);
    // z beta*_0 times z beta_i: the predicted value inside the corrected one.
    for (std::size_t i = 0; i < k; ++i) pi.add(past - 1 - i, 2, -corrector[0] * beta[i]);
    for (std::size_t i = 1; i < corrector.size(); ++i) pi.add(past - i, 1, -corrector[i]);
    return std::move(pi).done();
  }
  // y_n+1 = y_n + z sum_i beta*_i p_n+1-i with y_n = p_n+1 - z sum_i beta_i p_n-i; zeta^(past+1) stands for
  // p_n+2
  Collected pi(past + 1);
  pi.add(past + 1, 0, 1);
  pi.add(past, 0, -1);
  for (std::size_t i = 0; i < k; ++i) {
    pi.add(past - i, 1, -beta[i]);
    pi.add(past - 1 - i, 1, beta[i]);
  }
  for (std::size_t i = 0; i < corrector.size(); ++i) pi.add(past - i, 1, -corrector[i]);
  return std::move(pi).done();
}

/// rho = zeta^k - zeta^(k-1), sigma = sum_i beta*_i zeta^(k-i).
Amplification adams_moulton_amplification(int order) {
  const Polynomial corrector = corrector_weights(order);
  const std::size_t k = std::max<std::size_t>(corrector.size() - 1, 1);
  Collected pi(k);
  pi.add(k, 0, 1);
  pi.add(k - 1, 0, -1);
  for (std::size_t i = 0; i < corrector.size(); ++i) pi.add(k - i, 1, -corrector[i]);
  return std::move(pi).done();
}

/// nabla^j y_n+1 = sum_i (-1)^i (j over i) y_n+1-i.
Amplification bdf_amplification(int order) {
  const auto k = static_cast<std::size_t>(order);
  Collected pi(k);
  pi.add(k, 1, -1);
  for (std::size_t j = 1; j <= k; ++j) {
    long double binomial = 1;  // (-1)^i (j over i)
    for (std::size_t i = 0; i <= j; ++i) {
      pi.add(k - i, 0, binomial / static_cast<long double>(j));
      binomial = -binomial * static_cast<long double>(j - i) / static_cast<long double>(i + 1);
    }
  }
  return std::move(pi).done();
}

}  // namespace hmax
