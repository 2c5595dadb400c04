/// One step on y' = lambda y is y_new = R(h lambda) y.
#include "tests/integrators/stability_function.hpp"

#include <random>

#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;

template <class Method>
struct StabilityFunction : testing::Test {};
TYPED_TEST_SUITE(StabilityFunction, EveryMethod, MethodId);

TYPED_TEST(StabilityFunction, IsWhatOneStepMultipliesBy) {
  using One = Eigen::Matrix<Complex, 1, 1>;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(0, 6.283), radius(0, 3), exponent(-3, 3);
  Rk<TypeParam, One> stepper;
  for (int repeat = 0; repeat < 1000; ++repeat) {
    const double h = std::pow(10, exponent(random));
    const Complex z = std::polar(radius(random), angle(random));
    const Complex R(stability_function(TypeParam::tableau, z));
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
