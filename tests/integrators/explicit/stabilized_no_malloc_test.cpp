/// After init() no stabilised step allocates, whatever its number of stages.
#include <stdexcept>

#define EIGEN_RUNTIME_NO_MALLOC
#define eigen_assert(condition) \
  ((condition) ? void(0) : throw std::logic_error("Eigen's assertion failed: " #condition))

#include "integrators/explicit/stabilized_rk.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using State = Eigen::VectorXd;

template <class Polynomials>
struct StabilisedAllocatesNothing : testing::Test {};
using Families = testing::Types<Rkc2, Rkl2>;
TYPED_TEST_SUITE(StabilisedAllocatesNothing, Families, MethodId);

TYPED_TEST(StabilisedAllocatesNothing, FromAttemptToAccept) {
  const Decay<State> system{State::LinSpaced(20, -200, -1)};
  StabilizedRk<TypeParam, State> stepper;
  State y = State::Ones(20), y_new = y, between = y;
  stepper.init(system, 0, y);
  double error = 0;
  Eigen::internal::set_is_malloc_allowed(false);
  EXPECT_NO_THROW(for (const double h
                       : {0.01, 0.1, 1.0}) {
    stepper.attempt(system, 0, y, 2 * h, y_new);
    stepper.reject();
    stepper.attempt(system, 0, y, h, y_new);
    error += stepper.error_squared(h, y, y_new, RmsNorm<double>{1e-6, 1e-6});
    stepper.interpolate(system, 0, h, y, y_new, 0.3, between);
    stepper.accept(y_new);
  });
  Eigen::internal::set_is_malloc_allowed(true);
  EXPECT_GT(error, 0);
}

}  // namespace
}  // namespace hmax
