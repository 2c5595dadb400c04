/// After init() no step of a structural method allocates. Eigen itself reports every allocation.
#include <stdexcept>

#define EIGEN_RUNTIME_NO_MALLOC
// Eigen reports through its assertion, which a release build would drop.
#define eigen_assert(condition) \
  ((condition) ? void(0) : throw std::logic_error("Eigen's assertion failed: " #condition))

#include <gtest/gtest.h>

#include "integrators/structural/generalized_alpha.hpp"
#include "integrators/structural/structural.hpp"

namespace hmax {
namespace {

using State = Eigen::VectorXd;

/// Twenty masses on hardening springs of their own, in dense matrices that are written in place.
struct Springs {
  using State = Eigen::VectorXd;
  using Dofs = Eigen::VectorXd;
  using DofMatrix = Eigen::MatrixXd;
  static constexpr Eigen::Index n = 20;
  static Eigen::Index dim() { return 2 * n; }
  static Eigen::Index dofs() { return n; }
  static Dofs mass() { return Dofs::Constant(n, 1.5); }
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const {
    for (Eigen::Index i = 0; i < n; ++i) f[i] = t - q[i] - q[i] * q[i] * q[i] - v[i];
  }
  void rhs(double t, const State& y, State& dydt) const {
    for (Eigen::Index i = 0; i < n; ++i) {
      dydt[i] = y[n + i];
      dydt[n + i] = (t - y[i] - y[i] * y[i] * y[i] - y[n + i]) / 1.5;
    }
  }
  void stiffness(double, const Dofs& q, const Dofs&, DofMatrix& K) const {
    K.setZero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) K(i, i) = 1 + 3 * q[i] * q[i];
  }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& C) const { C.setIdentity(n, n); }
};

template <class StepperT>
void expect_no_allocation(StepperT stepper) {
  const Springs springs;
  State y = State::LinSpaced(40, -2, 2), y_new = y, between = y;
  stepper.init(springs, 0, y);
  Eigen::internal::set_is_malloc_allowed(false);
  // A step of 30 is one that simplified Newton iteration does not solve.
  EXPECT_NO_THROW(for (const double h
                       : {0.1, 0.2}) {
    stepper.attempt(springs, 0, y, 30, y_new);
    stepper.attempt(springs, 0, y, h, y_new);
    stepper.interpolate(springs, 0, h, y, y_new, 0.3, between);
    stepper.accept(y_new);
    y = y_new;
  });
  Eigen::internal::set_is_malloc_allowed(true);
  EXPECT_TRUE(y.allFinite());
}

TEST(NoMalloc, InStepsOfStructuralMethods) {
  expect_no_allocation(SymplecticEuler<State>{});
  expect_no_allocation(VelocityVerlet<State>{});
  expect_no_allocation(StormerVerlet<State>{});
  expect_no_allocation(CentralDifference<State>{});
  for (const int every : {JacobianUpdate::automatic, JacobianUpdate::frozen, 1}) {
    GeneralizedAlpha<State, State, Eigen::MatrixXd> stepper(generalized_alpha_parameters(0.8L));
    stepper.set_jacobian_update({every});
    expect_no_allocation(std::move(stepper));
  }
}

}  // namespace
}  // namespace hmax
