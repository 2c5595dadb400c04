/// Dense output: what lies between the ends of a step.
#include <algorithm>
#include <cmath>
#include <utility>

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
  auto step =
      first_step<Rk<Method, LongPlane>>(rotation<LongPlane>, t, LongPlane(std::sin(t), std::cos(t)), h);
  Real worst = 0;
  for (const Real theta : {0.1L, 0.25L, 0.5L, 0.6L, 0.75L, 0.9L}) {
    const LongPlane exact(std::sin(t + theta * h), std::cos(t + theta * h));
    worst = std::max(worst, (step.at(theta) - exact).norm());
  }
  return worst;
}

template <class Method>
struct DenseOutput : testing::Test {};
TYPED_TEST_SUITE(DenseOutput, EveryMethod, MethodId);

TYPED_TEST(DenseOutput, MeetsBothEnds) {
  const Pendulum<LongPlane> system;
  auto step = first_step<Rk<TypeParam, LongPlane>>(system, 0.2L, LongPlane(0.3L, 0.5L), 0.4L);
  EXPECT_EQ(step.at(0), step.y);
  EXPECT_LT((step.at(1) - step.y_new).norm(), 1e-14L);
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
  auto step = first_step<Rk<TypeParam, LongPlane>>(system, 0, LongPlane(0, 0), 1);
  for (const Real theta : {0.2L, 0.5L, 0.7L})
    EXPECT_LT(std::abs(step.at(theta)[0] - std::pow(theta, degree)), 1e-13L);
}

template <class Method>
struct DynamicDenseOutput : testing::Test {};
TYPED_TEST_SUITE(DynamicDenseOutput, OneOfEachKind, MethodId);

TYPED_TEST(DynamicDenseOutput, IsThatOfASmallState) {
  const auto step_of = []<class State>(const State& y) {
    const Pendulum<State> system;
    auto step = first_step<Rk<TypeParam, State>>(system, 0.2, y, 0.4);
    return std::pair<Eigen::VectorXd, Eigen::VectorXd>(step.y_new, step.at(0.3));
  };
  EXPECT_EQ(step_of(Eigen::VectorXd(Eigen::Vector2d(0.3, 0.5))), step_of(Eigen::Vector2d(0.3, 0.5)));
}

}  // namespace
}  // namespace hmax
