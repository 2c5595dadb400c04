/// After init() no implicit-explicit step allocates when its Jacobian is dense.
#include <stdexcept>

#define EIGEN_RUNTIME_NO_MALLOC
#define eigen_assert(condition) \
  ((condition) ? void(0) : throw std::logic_error("Eigen's assertion failed: " #condition))

#include "integrators/implicit/imex.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

/// y' = -rate y (stiff) + cos y, every component with a rate of its own.
struct Relaxation {
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  State rate = State::LinSpaced(20, 1, 1000);
  [[nodiscard]] Eigen::Index dim() const { return rate.size(); }
  void rhs_stiff(double, const State& y, State& dydt) const { dydt = -rate.cwiseProduct(y); }
  void rhs_nonstiff(double, const State& y, State& dydt) const { dydt = y.array().cos().matrix(); }
  void rhs(double, const State& y, State& dydt) const {
    dydt = y.array().cos().matrix() - rate.cwiseProduct(y);
  }
  void jacobian_stiff(double, const State&, Jacobian& J) const {
    J.setZero();
    J.diagonal() = -rate;
  }
};

template <class Method>
struct ImexAllocatesNothing : testing::Test {};
using Methods = TestTypesOf<tableaux::AllImex>::type;
TYPED_TEST_SUITE(ImexAllocatesNothing, Methods, MethodId);

TYPED_TEST(ImexAllocatesNothing, FromAttemptToAccept) {
  using State = Relaxation::State;
  const Relaxation system;
  ImexRk<TypeParam, State, Relaxation::Jacobian> stepper;
  stepper.set_jacobian_update({1});
  State y = State::Ones(20), y_new = y, between = y;
  stepper.init(system, 0, y);
  double error = 0;
  Eigen::internal::set_is_malloc_allowed(false);
  EXPECT_NO_THROW(for (const double h
                       : {0.2, 0.1}) {
    stepper.attempt(system, 0, y, 2 * h, y_new);
    stepper.attempt(system, 0, y, h, y_new);
    if constexpr (TypeParam::error_order > 0)
      error += stepper.error_squared(h, y, y_new, RmsNorm<double>{1e-6, 1e-6});
    stepper.interpolate(system, 0, h, y, y_new, 0.3, between);
    stepper.accept(y_new);
  });
  Eigen::internal::set_is_malloc_allowed(true);
  EXPECT_EQ(error > 0, TypeParam::error_order > 0);
}

}  // namespace
}  // namespace hmax
