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

/// The largest |y_new - R(z)| / max(1, |R(z)|) over 1000 random z = h lambda with |z| < 3.
template <class Method, class State>
double worst_defect(State y) {
  const auto coefficients = stability_coefficients<Method>();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(0, 6.283), radius(0, 3), exponent(-3, 3);
  Decay<State> system{y};
  Rk<Method, State> stepper;
  State y_new = y;
  double worst = 0;
  for (int repeat = 0; repeat < 1000; ++repeat) {
    const double h = std::pow(10, exponent(random));
    const Complex z = std::polar(radius(random), angle(random));
    system.lambda.fill(z / h);
    y.fill(1);
    stepper.init(system, 0, y);
    stepper.attempt(system, 0, y, h, y_new);
    const Complex R = polynomial(coefficients, z);
    for (const Complex component : y_new)
      worst = std::max(worst, std::abs(component - R) / std::max(1.0, std::abs(R)));
  }
  return worst;
}

template <class Method>
struct StabilityFunction : testing::Test {};
TYPED_TEST_SUITE(StabilityFunction, EveryMethod, MethodId);

TYPED_TEST(StabilityFunction, IsWhatOneStepMultipliesBy) {
  using One = Eigen::Matrix<Complex, 1, 1>;
  EXPECT_LT((worst_defect<TypeParam, One>(One(1.0))), 1e-13);
}

template <class Method>
struct DynamicStabilityFunction : testing::Test {};
TYPED_TEST_SUITE(DynamicStabilityFunction, OneOfEachKind, MethodId);

TYPED_TEST(DynamicStabilityFunction, IsWhatOneStepMultipliesBy) {
  EXPECT_LT((worst_defect<TypeParam, Eigen::VectorXcd>(Eigen::VectorXcd::Ones(3))), 1e-13);
}

TEST(StabilityFunction, OfDormandPrinceIsThePublishedPolynomial) {
  const auto R = stability_coefficients<tableaux::DormandPrince54>();
  const std::vector<long double> published{1, 1, 1 / 2.0L, 1 / 6.0L, 1 / 24.0L, 1 / 120.0L, 1 / 600.0L, 0};
  ASSERT_EQ(R.size(), published.size());
  for (std::size_t k = 0; k < R.size(); ++k) EXPECT_LT(std::abs(R[k] - published[k]), 1e-18L);
}

}  // namespace
}  // namespace hmax
