/// After init() no implicit step allocates when its Jacobian is dense.
#include <stdexcept>

#define EIGEN_RUNTIME_NO_MALLOC
// Eigen reports through its assertion, which a release build would drop.
#define eigen_assert(condition) \
  ((condition) ? void(0) : throw std::logic_error("Eigen's assertion failed: " #condition))

#include "tests/integrators/implicit_methods.hpp"

namespace hmax {
namespace {

using State = Eigen::VectorXd;

/// Nonlinear, coupled, with a Jacobian of its own, so that iterations, renewals and failures happen.
struct Chain {
  using State = Eigen::VectorXd;
  Eigen::Index n;
  [[nodiscard]] Eigen::Index dim() const { return n; }
  void rhs(double, const State& y, State& dydt) const {
    for (Eigen::Index i = 0; i < n; ++i) dydt[i] = -50 * y[i] * y[i] * y[i] + y[(i + 1) % n];
  }
  void jacobian(double, const State& y, Eigen::MatrixXd& J) const {
    J.setZero();
    for (Eigen::Index i = 0; i < n; ++i) {
      J(i, i) = -150 * y[i] * y[i];
      J(i, (i + 1) % n) += 1;
    }
  }
};

/// The same without a Jacobian: differences take its place.
struct PlainChain {
  using State = Eigen::VectorXd;
  Chain chain;
  [[nodiscard]] Eigen::Index dim() const { return chain.n; }
  void rhs(double t, const State& y, State& dydt) const { chain.rhs(t, y, dydt); }
};

struct NoMalloc {
  NoMalloc() { Eigen::internal::set_is_malloc_allowed(false); }
  ~NoMalloc() { Eigen::internal::set_is_malloc_allowed(true); }
  NoMalloc(const NoMalloc&) = delete;
  NoMalloc& operator=(const NoMalloc&) = delete;
};

template <class Method>
struct ImplicitRkAllocatesNothing : testing::Test {};
TYPED_TEST_SUITE(ImplicitRkAllocatesNothing, EveryImplicitMethod, MethodId);

template <class Stepper, class System>
void steps(const System& system) {
  Stepper stepper;
  State y = State::LinSpaced(system.dim(), 0.1, 2), y_new = y, between = y;
  stepper.init(system, 0, y);
  if constexpr (Stepper::may_estimate_error) stepper.set_tolerances(1e-6, 1e-6);
  const NoMalloc guard;
  for (const double h : {0.01, 0.02, 5.0, 0.02}) {
    if (stepper.attempt(system, 0, y, h, y_new) != StepStatus::ok) continue;
    if constexpr (Stepper::may_estimate_error)
      stepper.error_squared(h, y, y_new, RmsNorm<double>{1e-6, 1e-6});
    stepper.interpolate(system, 0, h, y, y_new, 0.5, between);
    stepper.accept(y_new);
    y = y_new;
  }
}

TYPED_TEST(ImplicitRkAllocatesNothing, FromAttemptToAccept) {
  using Stepper = typename TypeParam::template Stepper<State>;
  for (const Eigen::Index n : {2, 20, 60}) {
    EXPECT_NO_THROW(steps<Stepper>(ErasedSystem(Chain{n}))) << n;
    EXPECT_NO_THROW(steps<Stepper>(ErasedSystem(PlainChain{{n}}))) << n;
  }
}

}  // namespace
}  // namespace hmax
