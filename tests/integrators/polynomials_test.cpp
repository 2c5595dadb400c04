/// A method of order p integrates polynomials of degree p without error, and its error estimate sees the
/// first degree it cannot.
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using LongState = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
constexpr Eigen::Index degrees = 10;

/// y_k' = k t^(k-1): y_k = t^k by quadrature, the bushy trees of the order conditions.
const auto quadrature = system_of<LongState>(
    [](long double t, const LongState&, LongState& dydt) {
      long double power = 1;
      for (Eigen::Index k = 0; k <= degrees; ++k) {
        dydt[k] = k == 0 ? 0 : static_cast<long double>(k) * power;
        if (k > 0) power *= t;
      }
    },
    degrees + 1);

/// y_k' = k y_(k-1), y_0 = 1: y_k = t^k by a chain, the tall trees.
const auto chain = system_of<LongState>(
    [](long double, const LongState& y, LongState& dydt) {
      dydt[0] = 0;
      for (Eigen::Index k = 1; k <= degrees; ++k) dydt[k] = static_cast<long double>(k) * y[k - 1];
    },
    degrees + 1);

LongState powers_of(long double t) {
  LongState y(degrees + 1);
  y[0] = 1;
  for (Eigen::Index k = 1; k <= degrees; ++k) y[k] = t * y[k - 1];
  return y;
}

/// The result of one step from t to t + h on either system; the stepper shows its error estimate afterwards.
template <class Method, class System>
LongState one_step(Rk<Method, LongState>& stepper, const System& system, long double t, long double h) {
  const LongState y = powers_of(t);
  LongState y_new = y;
  stepper.init(system, t, y);
  stepper.attempt(system, t, y, h, y_new);
  return y_new;
}

template <class Method>
long double estimate(long double h, const LongState& y, const Rk<Method, LongState>& stepper,
                     Eigen::Index degree) {
  return std::sqrt(stepper.error_squared(h, y, y, Component{degree}));
}

template <class Method>
struct Polynomials : testing::Test {};
TYPED_TEST_SUITE(Polynomials, EveryMethod, MethodId);

// Coefficients are published as decimals with 18 digits or more, those of DOP853 as large as 44.
constexpr long double rounding = 1e-16L;

TYPED_TEST(Polynomials, AreIntegratedExactlyUpToTheOrder) {
  Rk<TypeParam, LongState> stepper;
  const LongState exact = powers_of(1.1L);
  const LongState by_quadrature = one_step<TypeParam>(stepper, quadrature, 0.4L, 0.7L);
  const LongState by_chain = one_step<TypeParam>(stepper, chain, 0.4L, 0.7L);
  for (Eigen::Index k = 0; k <= TypeParam::order; ++k) {
    EXPECT_LT(std::abs(by_quadrature[k] - exact[k]), rounding) << "degree " << k;
    EXPECT_LT(std::abs(by_chain[k] - exact[k]), rounding) << "degree " << k;
  }
  const Eigen::Index beyond = TypeParam::order + 1;
  EXPECT_GT(std::abs(by_chain[beyond] - exact[beyond]), 1e-7L);
}

TYPED_TEST(Polynomials, AreErrorlessToTheEstimateUpToTheEmbeddedOrder) {
  if constexpr (TypeParam::error_order > 0) {
    Rk<TypeParam, LongState> stepper;
    const LongState y = powers_of(0.4L);
    one_step<TypeParam>(stepper, quadrature, 0.4L, 0.7L);
    for (Eigen::Index k = 0; k <= TypeParam::embedded_order; ++k)
      EXPECT_LT(estimate<TypeParam>(0.7L, y, stepper, k), rounding) << "degree " << k;
    one_step<TypeParam>(stepper, chain, 0.4L, 0.7L);
    for (Eigen::Index k = 0; k <= TypeParam::embedded_order; ++k)
      EXPECT_LT(estimate<TypeParam>(0.7L, y, stepper, k), rounding) << "degree " << k;
    EXPECT_GT(estimate<TypeParam>(0.7L, y, stepper, TypeParam::embedded_order + 1), 1e-7L);
  }
}

// From t = 0 the error of degree q is c h^q without further terms: twice the step, 2^q times the estimate.
TYPED_TEST(Polynomials, OfTheNextDegreeScaleTheEstimateByTheErrorOrder) {
  if constexpr (TypeParam::error_order > 0) {
    constexpr int q = TypeParam::embedded_order + 1;
    Rk<TypeParam, LongState> stepper;
    const LongState y = powers_of(0);
    one_step<TypeParam>(stepper, chain, 0, 0.5L);
    const long double small = estimate<TypeParam>(0.5L, y, stepper, q);
    one_step<TypeParam>(stepper, chain, 0, 1);
    EXPECT_LT(std::abs(estimate<TypeParam>(1, y, stepper, q) / small - std::pow(2.0L, q)), 1e-12L);
  }
}

// DOP853 divides two estimates, O(h^6)^2 / O(h^4): its order shows only as a limit on general systems.
TYPED_TEST(Polynomials, NeverHideTheErrorOrderOnGeneralSystems) {
  if constexpr (TypeParam::error_order > 0) {
    using Plane = Eigen::Matrix<long double, 2, 1>;
    const Pendulum<Plane> pendulum;
    const Plane y(0.7L, 0.2L);
    const auto estimate_of = [&](long double h) {
      return first_step<Rk<TypeParam, Plane>>(pendulum, 0, y, h).error(RmsNorm<long double>{0, 1});
    };
    const long double h = TypeParam::error_order == 8 ? 0.05L : 0.004L;  // well above rounding, h^8 = 4e-11
    const long double order = std::log2(estimate_of(h) / estimate_of(h / 2));
    EXPECT_LT(std::abs(order - TypeParam::error_order), 0.1L) << order;
  }
}

}  // namespace
}  // namespace hmax
