#include "analysis/amplification/part_amplification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/amplification/polynomial.hpp"

namespace hmax {

namespace {

/// The mode lambda = slow + fast of which `fast` is treated implicitly; with h = 1 the two are z_slow and
/// z_fast.
Eigenmode beside(Complex slow, Complex fast) {
  Eigenmode mode(slow + fast);
  mode.stiff = fast;
  return mode;
}

}  // namespace

bool is_at_most_one(const SlowPolynomial& R, Complex z) { return std::norm(evaluate(R, z)) <= 1 + 2e-9; }

// R beside a fixed z_fast is a polynomial in z_slow divided by a number: the denominator prod (1 - z_fast
// aI_ii) does not contain z_slow. So its values on a circle determine it.
SlowPolynomial in_slow(const Amplification& pair, Complex fast) {
  constexpr std::size_t points = 24;
  constexpr long double radius = 4;
  const auto on_unit_circle = [](std::size_t i) {
    return std::polar(1.0L,
                      2 * std::numbers::pi_v<long double> * static_cast<long double>(i % points) / points);
  };
  std::array<LongComplex, points> value;
  for (std::size_t i = 0; i < points; ++i) {
    const Complex slow(radius * on_unit_circle(i));
    const StepPolynomial pi = *pair.of_eigenmode(beside(slow, fast)).polynomial;
    // pi = D zeta - N, so R = N / D = -p_0 / p_1, at h = 1.
    value[i] =
        -evaluate(pi.coefficients()[0], LongComplex(1)) / evaluate(pi.coefficients()[1], LongComplex(1));
  }
  std::array<LongComplex, points> share;
  long double largest = 0;
  for (std::size_t j = 0; j < points; ++j) {
    share[j] = 0;
    // Discrete Fourier transform: the coefficient of z^j times radius^j.
    for (std::size_t i = 0; i < points; ++i) share[j] += value[i] * std::conj(on_unit_circle(i * j));
    share[j] /= static_cast<long double>(points);
    largest = std::max(largest, std::abs(share[j]));
  }
  SlowPolynomial c;
  for (std::size_t j = 0; j < points; ++j)
    c.push_back(std::abs(share[j]) <= 1e-13L * largest
                    ? Complex(0)
                    : Complex(share[j] / std::pow(radius, static_cast<long double>(j))));
  while (c.size() > 1 && c.back() == Complex(0)) c.pop_back();
  return c;
}

Amplification beside_stiff(const std::shared_ptr<const Amplification>& pair, Complex fast) {
  Amplification amplification;
  amplification.of_eigenmode = [pair, fast](const Eigenmode& mode) {
    return pair->of_eigenmode(beside(mode.lambda, fast));
  };
  amplification.stable_at = [c = in_slow(*pair, fast)](Complex z) {
    // Beside an oscillation that is stiff a slow one may turn either way.
    return is_at_most_one(c, z) && is_at_most_one(c, std::conj(z));
  };
  return amplification;
}

// pi for lambda = 1 with z0 = z / ratio is again a polynomial in z, so that all that is known of such
// polynomials serves.
Amplification with_old_jacobian(const std::shared_ptr<const Amplification>& method, double ratio) {
  Eigenmode mode(Complex(1));
  mode.frozen = 1 / ratio;
  Amplification amplification;
  amplification.of_eigenmode = [method, ratio](const Eigenmode& told) {
    Eigenmode old = told;
    old.frozen = told.lambda / ratio;
    return method->of_eigenmode(old);
  };
  amplification.in_z = method->of_eigenmode(mode).polynomial;
  amplification.stable_at = [pi = *amplification.in_z](Complex z) { return pi.is_at_most_one(z); };
  return amplification;
}

}  // namespace hmax
