/// The observed order of convergence: the end error of fixed steps falls as h^p.
#include <cmath>

#include "integrators/integrate.hpp"
#include "problems/oscillator/oscillator_exact.hpp"
#include "problems/oscillator/oscillator_reference.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

// In long double, so that methods of order 8 fall far before they reach rounding.
using Real = long double;
using Liver = BasicOscillator<Real>;
using LiverState = Liver::State;
constexpr double t_end = 2;

template <class Method>
Real end_error(const Liver& system, const LiverState& y0, const LiverState& exact, int steps) {
  LiverState y = y0;
  integrate(Rk<Method, LiverState>{}, system, Span<Real>{0, t_end}, y, FixedStep<Real>(Real(t_end) / steps));
  return (y - exact).norm();
}

/// The slope of log error over log h between a step and a quarter of it.
template <class Method>
double observed_order(const Liver& system, const Eigen::Vector2d& y0, const LiverState& exact) {
  const LiverState start = y0.cast<Real>();
  // So small that the leading term rules, so large that the error, here 1e-17 at least, is no rounding.
  const int steps = Method::order == 8 ? 16 : 512;
  const Real coarse = end_error<Method>(system, start, exact, steps);
  const Real fine = end_error<Method>(system, start, exact, 4 * steps);
  return static_cast<double>(std::log2(coarse / fine) / 2);
}

template <class Method>
struct Order : testing::Test {};
TYPED_TEST_SUITE(Order, EveryMethod, MethodId);

TYPED_TEST(Order, IsReachedOnTheDampedLinearOscillator) {
  const OscillatorParameters p{.m = 1.3, .c = 0.4, .k1 = 5.3, .k3 = 0, .P = 0, .w = 0};
  const Eigen::Vector2d y0(0.5, 1);
  const LiverState exact = exact_solution(p, y0)->extended(t_end);
  EXPECT_NEAR(observed_order<TypeParam>(Liver(p), y0, exact), TypeParam::order, 0.1);
}

TYPED_TEST(Order, IsReachedOnTheUndampedCubicOscillator) {
  const OscillatorParameters p{.m = 1.45, .c = 0, .k1 = 0.7, .k3 = 8, .P = 0, .w = 0};
  const Eigen::Vector2d y0(0.5, 1);
  const LiverState exact = exact_solution(p, y0)->extended(t_end);
  EXPECT_NEAR(observed_order<TypeParam>(Liver(p), y0, exact), TypeParam::order, 0.1);
}

TYPED_TEST(Order, IsReachedOnTheForcedCubicOscillator) {
  const OscillatorParameters p{.m = 1.45, .c = 0.5, .k1 = 0.7, .k3 = 8, .P = 2, .w = 3};
  const Eigen::Vector2d y0(0.5, 1);
  const LiverState exact = OscillatorReference(p, y0, t_end).extended_at(t_end);
  EXPECT_NEAR(observed_order<TypeParam>(Liver(p), y0, exact), TypeParam::order, 0.1);
}

}  // namespace
}  // namespace hmax
