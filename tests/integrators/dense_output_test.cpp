/// Dense output: what lies between the ends of a step.
#include <algorithm>
#include <cmath>

#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using Real = long double;
using LongPlane = Eigen::Matrix<long double, 2, 1>;

/// Order of the continuous output itself; cubic Hermite interpolation where the method brings none.
template <class Method>
constexpr int interpolant_order() {
  if constexpr (requires { Method::interpolant_order; })
    return Method::interpolant_order;
  else
    return 3;
}

/// The largest error between the ends of one step of size h from exact values at t = 0.3.
template <class Method>
Real error_between(Real h) {
  const Real t = 0.3L;
  Rk<Method, LongPlane> stepper;
  LongPlane y(std::sin(t), std::cos(t)), y_new, between;
  stepper.init(rotation<LongPlane>, t, y);
  stepper.attempt(rotation<LongPlane>, t, y, h, y_new);
  Real worst = 0;
  for (const Real theta : {0.1L, 0.25L, 0.5L, 0.6L, 0.75L, 0.9L}) {
    stepper.interpolate(rotation<LongPlane>, t, h, y, y_new, theta, between);
    const LongPlane exact(std::sin(t + theta * h), std::cos(t + theta * h));
    worst = std::max(worst, (between - exact).norm());
  }
  return worst;
}

template <class Method>
struct DenseOutput : testing::Test {};
TYPED_TEST_SUITE(DenseOutput, EveryMethod, MethodId);

TYPED_TEST(DenseOutput, MeetsBothEnds) {
  const Pendulum<LongPlane> system;
  Rk<TypeParam, LongPlane> stepper;
  const LongPlane y(0.3L, 0.5L);
  LongPlane y_new, left, right;
  stepper.init(system, 0.2L, y);
  stepper.attempt(system, 0.2L, y, 0.4L, y_new);
  stepper.interpolate(system, 0.2L, 0.4L, y, y_new, 0, left);
  stepper.interpolate(system, 0.2L, 0.4L, y, y_new, 1, right);
  EXPECT_EQ(left, y);
  EXPECT_LT((right - y_new).norm(), 1e-14L);
}

TYPED_TEST(DenseOutput, HasItsLocalOrder) {
  // The step itself errs by h^(order + 1), the polynomial through its ends by h^(interpolant_order + 1).
  const int expected = std::min(TypeParam::order, interpolant_order<TypeParam>()) + 1;
  const Real h = expected > 6 ? 0.25L : 0.01L;
  const Real observed = std::log2(error_between<TypeParam>(h) / error_between<TypeParam>(h / 2));
  EXPECT_LT(std::abs(observed - expected), 0.1L) << observed;
}

TYPED_TEST(DenseOutput, ReproducesPolynomialsOfItsOrder) {
  // y' = 3 t^2 needs a method of order 3; y' = 4 t^3 would show a cubic.
  const int degree = std::min(TypeParam::order, interpolant_order<TypeParam>());
  const auto system = system_of<LongPlane>(
      [=](Real t, const LongPlane&, LongPlane& dydt) { dydt << degree * std::pow(t, degree - 1), 0; });
  Rk<TypeParam, LongPlane> stepper;
  const LongPlane y(0, 0);
  LongPlane y_new, between;
  stepper.init(system, 0, y);
  stepper.attempt(system, 0, y, 1, y_new);
  for (const Real theta : {0.2L, 0.5L, 0.7L}) {
    stepper.interpolate(system, 0, 1, y, y_new, theta, between);
    EXPECT_LT(std::abs(between[0] - std::pow(theta, degree)), 1e-13L);
  }
}

template <class Method>
struct DynamicDenseOutput : testing::Test {};
TYPED_TEST_SUITE(DynamicDenseOutput, OneOfEachKind, MethodId);

TYPED_TEST(DynamicDenseOutput, IsThatOfASmallState) {
  const Eigen::Vector2d y(0.3, 0.5);
  Eigen::Vector2d y_new, between;
  const Pendulum<Eigen::Vector2d> small;
  Rk<TypeParam, Eigen::Vector2d> stepper;
  stepper.init(small, 0.2, y);
  stepper.attempt(small, 0.2, y, 0.4, y_new);
  stepper.interpolate(small, 0.2, 0.4, y, y_new, 0.3, between);
  const Eigen::VectorXd dynamic_y = y;
  Eigen::VectorXd dynamic_y_new = y, dynamic_between = y;
  const Pendulum<Eigen::VectorXd> dynamic;
  Rk<TypeParam, Eigen::VectorXd> dynamic_stepper;
  dynamic_stepper.init(dynamic, 0.2, dynamic_y);
  dynamic_stepper.attempt(dynamic, 0.2, dynamic_y, 0.4, dynamic_y_new);
  dynamic_stepper.interpolate(dynamic, 0.2, 0.4, dynamic_y, dynamic_y_new, 0.3, dynamic_between);
  EXPECT_EQ(dynamic_y_new, y_new);
  EXPECT_EQ(dynamic_between, between);
}

}  // namespace
}  // namespace hmax
