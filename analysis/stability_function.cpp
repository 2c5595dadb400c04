#include "analysis/stability_function.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hmax {

namespace {

/// |R| may exceed 1 by what rounding of the coefficients and of R does. No more: Dormand-Prince leaves the
/// circle on the imaginary axis by parts in a million only.
bool stable(const StabilityFunction& R, std::complex<double> z) { return std::abs(R(z)) <= 1 + 1e-12; }

}  // namespace

std::complex<double> explicit_stability_function(std::span<const long double> a,
                                                 std::span<const long double> b, std::complex<double> z) {
  const std::size_t s = b.size();
  std::vector<std::complex<double>> k(s);
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < s; ++i) {
    std::complex<double> stage = 1;
    for (std::size_t j = 0; j < i; ++j) stage += z * static_cast<double>(a[i * s + j]) * k[j];
    k[i] = stage;
    sum += static_cast<double>(b[i]) * stage;
  }
  return 1.0 + z * sum;
}

double largest_stable_step(const StabilityFunction& R, std::complex<double> lambda, double beyond) {
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  const double size = std::abs(lambda);
  if (!(size > 0) || lambda.real() > 0) return unlimited;
  const std::complex<double> direction = lambda / size;
  // The first exit is sought outwards in small strides, then located by bisection.
  constexpr double stride = 5e-3;
  double inside = 0;
  for (double r = stride; r <= beyond; r += std::max(stride, 1e-3 * r)) {
    if (stable(R, r * direction)) {
      inside = r;
      continue;
    }
    double outside = r;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = inside + (outside - inside) / 2;
      (stable(R, middle * direction) ? inside : outside) = middle;
    }
    return inside / size;
  }
  return unlimited;
}

double largest_stable_step(const StabilityFunction& R, std::span<const std::complex<double>> spectrum,
                           double beyond) {
  double h = std::numeric_limits<double>::infinity();
  for (const std::complex<double> lambda : spectrum) h = std::min(h, largest_stable_step(R, lambda, beyond));
  return h;
}

}  // namespace hmax
