/// One step on y' = lambda y is y_new = R(h lambda) y, with R(z) = 1 + sum_k b^T A^k 1 z^(k+1)
/// [hairer1996solving, IV.2].
#include <random>
#include <vector>

#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;

/// The coefficients of R: 1, b^T 1, b^T A 1, b^T A^2 1, ...
template <class Method>
std::vector<long double> stability_coefficients() {
  const auto& [a, b, b_err, c] = Method::tableau;
  constexpr std::size_t s = Method::tableau.stages;
  std::vector<long double> power(s, 1), coefficients{1};  // power = A^k 1
  for (std::size_t k = 0; k < s; ++k) {
    long double sum = 0;
    for (std::size_t i = 0; i < s; ++i) sum += b[i] * power[i];
    coefficients.push_back(sum);
    std::vector<long double> next(s, 0);
    for (std::size_t i = 0; i < s; ++i)
      for (std::size_t j = 0; j < s; ++j) next[i] += a[i][j] * power[j];
    power = next;
  }
  return coefficients;
}

Complex polynomial(const std::vector<long double>& coefficients, Complex z) {
  std::complex<long double> sum = 0;
  for (std::size_t k = coefficients.size(); k-- > 0;)
    sum = sum * std::complex<long double>(z) + coefficients[k];
  return Complex(sum);
}

template <class Method>
struct StabilityFunction : testing::Test {};
TYPED_TEST_SUITE(StabilityFunction, EveryMethod, MethodId);

TYPED_TEST(StabilityFunction, IsWhatOneStepMultipliesBy) {
  using One = Eigen::Matrix<Complex, 1, 1>;
  const auto coefficients = stability_coefficients<TypeParam>();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(0, 6.283), radius(0, 3), exponent(-3, 3);
  Rk<TypeParam, One> stepper;
  for (int repeat = 0; repeat < 1000; ++repeat) {
    const double h = std::pow(10, exponent(random));
    const Complex z = std::polar(radius(random), angle(random)), R = polynomial(coefficients, z);
    const Decay<One> system{One(z / h)};
    const One y(1.0);
    One y_new;
    stepper.init(system, 0, y);
    stepper.attempt(system, 0, y, h, y_new);
    ASSERT_LT(std::abs(y_new[0] - R), 1e-13 * std::max(1.0, std::abs(R))) << z;
  }
}

}  // namespace
}  // namespace hmax
