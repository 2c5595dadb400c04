/// The observed order of convergence: the end error of fixed steps falls as h^p.
#include <cmath>

#include "integrators/integrate.hpp"
#include "problems/oscillator/oscillator_reference.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

template <class Method>
struct Order : testing::Test {};
TYPED_TEST_SUITE(Order, EveryMethod, MethodId);

TYPED_TEST(Order, IsReachedOnTheForcedCubicOscillator) {
  // In long double, so that methods of order 8 fall far before they reach rounding.
  using Liver = BasicOscillator<long double>;
  constexpr double t_end = 2;
  const OscillatorParameters p{.m = 1.45, .c = 0.5, .k1 = 0.7, .k3 = 8, .P = 2, .w = 3};
  const Eigen::Vector2d y0(0.5, 1);
  const Liver::State exact = OscillatorReference(p, y0, t_end).extended_at(t_end);
  const auto end_error = [&](int steps) {
    Liver::State y = y0.cast<long double>();
    integrate(Rk<TypeParam, Liver::State>{}, Liver(p), Span<long double>{0, t_end}, y,
              FixedStep<long double>(static_cast<long double>(t_end) / steps));
    return (y - exact).norm();
  };
  // So small that the leading term rules, so large that the error, here 1e-17 at least, is no rounding.
  const int steps = TypeParam::order == 8 ? 16 : 512;
  const double observed = static_cast<double>(std::log2(end_error(steps) / end_error(4 * steps)) / 2);
  EXPECT_NEAR(observed, TypeParam::order, 0.1);
}

}  // namespace
}  // namespace hmax
