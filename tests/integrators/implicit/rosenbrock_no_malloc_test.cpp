/// After init() no step of a Rosenbrock method allocates: with the system's own Jacobian, with differences of
/// columns and of groups of columns, for equations that are solved here and for those left to Eigen.
#include <stdexcept>

#define EIGEN_RUNTIME_NO_MALLOC
// Eigen reports through its assertion, which a release build would drop.
#define eigen_assert(condition) \
  ((condition) ? void(0) : throw std::logic_error("Eigen's assertion failed: " #condition))

#include "tests/integrators/implicit/rosenbrock_systems.hpp"

namespace hmax {
namespace {

using State = Eigen::VectorXd;

struct Patterned : Decay<State> {
  void sparsity(Eigen::SparseMatrix<double>& pattern) const {
    pattern.resize(dim(), dim());
    pattern.setIdentity();
  }
};

/// Forbids allocation for as long as it lives.
struct NoMalloc {
  NoMalloc() { Eigen::internal::set_is_malloc_allowed(false); }
  ~NoMalloc() { Eigen::internal::set_is_malloc_allowed(true); }
  NoMalloc(const NoMalloc&) = delete;
  NoMalloc& operator=(const NoMalloc&) = delete;
};

template <class Method>
struct RosenbrockAllocatesNothing : testing::Test {};
TYPED_TEST_SUITE(RosenbrockAllocatesNothing, EveryRosenbrock, MethodId);

template <class Method, class System>
void expect_no_allocation(const System& system) {
  const Eigen::Index n = system.dim();
  Rosenbrock<Method, State> stepper;
  State y = State::Ones(n), y_new = y, between = y;
  stepper.init(system, 0, y);
  const NoMalloc guard;
  double error = 0;
  ASSERT_NO_THROW(for (const double h
                       : {0.2, 0.1}) {
    EXPECT_EQ(stepper.attempt(system, 0, y, 2 * h, y_new), StepStatus::ok);
    EXPECT_EQ(stepper.attempt(system, 0, y, h, y_new), StepStatus::ok);
    if constexpr (Method::error_order > 0)
      error += stepper.error_squared(h, y, y_new, RmsNorm<double>{1e-6, 1e-6});
    stepper.interpolate(system, 0, h, y, y_new, 0.3, between);
    stepper.accept(y_new);
  });
  EXPECT_EQ(error > 0, Method::error_order > 0);
}

TYPED_TEST(RosenbrockAllocatesNothing, FromAttemptToAccept) {
  for (const Eigen::Index n : {2, 20}) {
    const Decay<State> decay{State::LinSpaced(n, -2, -1)};
    expect_no_allocation<TypeParam>(ErasedSystem(DecayWithJacobian<State>{decay}));
    expect_no_allocation<TypeParam>(ErasedSystem(decay));
    expect_no_allocation<TypeParam>(Patterned{decay});
  }
}

}  // namespace
}  // namespace hmax
