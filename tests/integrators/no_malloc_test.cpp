/// After init() no step allocates. Eigen itself reports every allocation; an overridden operator new would
/// miss its malloc.
#include <stdexcept>

#define EIGEN_RUNTIME_NO_MALLOC
// Eigen reports through its assertion, which a release build would drop.
#define eigen_assert(condition) \
  ((condition) ? void(0) : throw std::logic_error("Eigen's assertion failed: " #condition))

#include "integrators/explicit/stabilized_rk.hpp"
#include "integrators/implicit/imex.hpp"
#include "integrators/integrate.hpp"
#include "integrators/multistep/adams.hpp"
#include "integrators/multistep/adams_pece.hpp"
#include "integrators/structural/generalized_alpha.hpp"
#include "integrators/structural/structural.hpp"
#include "tests/integrators/implicit/rosenbrock_systems.hpp"
#include "tests/integrators/implicit_methods.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using State = Eigen::VectorXd;

/// Forbids allocation for as long as it lives.
struct NoMalloc {
  NoMalloc() { Eigen::internal::set_is_malloc_allowed(false); }
  ~NoMalloc() { Eigen::internal::set_is_malloc_allowed(true); }
  NoMalloc(const NoMalloc&) = delete;
  NoMalloc& operator=(const NoMalloc&) = delete;
};

TEST(NoMalloc, SeesAnAllocation) {
  const NoMalloc guard;
  EXPECT_THROW(State(20), std::logic_error);
}

/// An attempt of size `large` before each of two steps of h and 2 h, all of them with an estimate and a look
/// between, where they are made.
template <class StepperT, class Sys>
void expect_no_allocation(StepperT stepper, const Sys& system, State y, double large, double h = 0.1) {
  State y_new = y, between = y;
  stepper.init(system, 0, y);
  if constexpr (requires { stepper.set_tolerances(1e-6, 1e-6); }) stepper.set_tolerances(1e-6, 1e-6);
  int made = 0;
  double error = 0;
  const NoMalloc guard;
  EXPECT_NO_THROW(for (const double size
                       : {large, h, large, 2 * h}) {
    const bool rejected = size == large;
    if (stepper.attempt(system, 0, y, size, y_new) != StepStatus::ok) continue;
    if constexpr (StepperT::may_estimate_error) {
      error += stepper.error_squared(size, y, y_new, RmsNorm<double>{1e-6, 1e-6});
      error += stepper.error_squared(size, y, y_new, MatlabNorm<double>{1e-6, 1e-6});
    }
    stepper.interpolate(system, 0, size, y, y_new, 0.3, between);
    if (rejected) {
      if constexpr (requires { stepper.reject(); }) stepper.reject();
      continue;
    }
    stepper.accept(y_new);
    y = y_new;
    ++made;
  });
  EXPECT_EQ(made, 2);
  EXPECT_TRUE(y.allFinite());
  EXPECT_EQ(error > 0, StepperT::may_estimate_error);
}

const Decay<State> system_of_twenty{State::LinSpaced(20, -2, -1)};

template <class Method>
struct ExplicitAllocatesNothing : testing::Test {};
TYPED_TEST_SUITE(ExplicitAllocatesNothing, OneOfEachKind, MethodId);

TYPED_TEST(ExplicitAllocatesNothing, FromAttemptToAccept) {
  expect_no_allocation(Rk<TypeParam, State>{}, system_of_twenty, State::Ones(20), 0.4);
}

TEST(StabilisedAllocatesNothing, FromAttemptToAccept) {
  const Decay<State> system{State::LinSpaced(20, -200, -1)};
  for (const double large : {0.02, 2.0}) {
    expect_no_allocation(StabilizedRk<Rkc2, State>{}, system, State::Ones(20), large);
    expect_no_allocation(StabilizedRk<Rkl2, State>{}, system, State::Ones(20), large);
  }
}

/// Forbids allocation from the first accepted step on, that is once the run is set up, and looks between the
/// ends of each.
struct ForbidFromTheFirstStep {
  template <class View>
  void operator()(View& view) {
    Eigen::internal::set_is_malloc_allowed(false);
    view.at(view.t0() + 0.3 * view.h(), between);
  }
  State between;
};

/// y' = lambda y of `n` numbers over 3.02.
template <class StepperT, class Control>
RunEnd<double> run(StepperT stepper, Control control, Eigen::Index n = 20) {
  const Decay<State> system{State::LinSpaced(n, -2, -1)};
  State y = State::Ones(n);
  ForbidFromTheFirstStep observer{y};
  RunEnd<double> end{};
  EXPECT_NO_THROW(end = integrate(stepper, system, {0, 3.02}, y, control, observer));
  Eigen::internal::set_is_malloc_allowed(true);
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  EXPECT_LT((y - (3.02 * system.lambda).array().exp().matrix()).cwiseAbs().maxCoeff(), 1e-3);
  return end;
}

TEST(IntegrateAllocatesNothing, InFixedSteps) {
  EXPECT_EQ(run(Rk<tableaux::Rk4, State>{}, FixedStep<double>(0.1)).stats.steps, 31);
}

TEST(IntegrateAllocatesNothing, InAdaptiveSteps) {
  // A first step of 3 is rejected.
  const auto end =
      run(Rk<tableaux::DormandPrince54, State>{}, Adaptive<double, PiController>({1e-9, 1e-9, 3}, 5));
  EXPECT_GT(end.stats.rejected, 0);
}

TEST(IntegrateAllocatesNothing, WithATableauOfTheUser) {
  const RuntimeTableau heun_euler{.name = "heun_euler",
                                  .a = {0, 0, 1, 0},
                                  .b = {0.5L, 0.5L},
                                  .b_err = {-0.5L, 0.5L},
                                  .c = {0, 1},
                                  .computed_order = 2,
                                  .embedded_order = 1};
  run(ExplicitRk<RuntimeTableau, State>(heun_euler), Adaptive<double, DeadbandController>({1e-4, 1e-4}, 2));
}

TEST(AdamsAllocatesNothing, FromItsStartToItsShorterLastStep) {
  for (const AdamsMode mode : {AdamsMode::bashforth, AdamsMode::pece, AdamsMode::pec})
    for (const int k : {2, 4})
      EXPECT_EQ(run(Adams<State>(mode, k), FixedStep<double>(0.02), 600).stats.steps, 151);
}

TEST(AdamsAllocatesNothing, WhileItChoosesOrderAndStep) {
  using Method = AdamsPece<State>;
  EXPECT_GT(run(Method(), Method::Control({1e-6, 1e-6}), 600).stats.steps, 20);
}

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

/// A system without its Jacobian: differences take its place.
template <class Base>
struct Plain {
  using State = Eigen::VectorXd;
  Base base;
  [[nodiscard]] Eigen::Index dim() const { return base.dim(); }
  void rhs(double t, const State& y, State& dydt) const { base.rhs(t, y, dydt); }
};

template <class Method>
struct ImplicitRkAllocatesNothing : testing::Test {};
TYPED_TEST_SUITE(ImplicitRkAllocatesNothing, EveryImplicitMethod, MethodId);

TYPED_TEST(ImplicitRkAllocatesNothing, FromAttemptToAccept) {
  using Stepper = typename TypeParam::template Stepper<State>;
  for (const Eigen::Index n : {2, 20, 60}) {
    const State y = State::LinSpaced(n, 0.1, 2);
    expect_no_allocation(Stepper{}, ErasedSystem(Chain{n}), y, 5, 5e-4);
    expect_no_allocation(Stepper{}, ErasedSystem(Plain<Chain>{{n}}), y, 5, 5e-4);
  }
}

struct Patterned : Decay<State> {
  void sparsity(Eigen::SparseMatrix<double>& pattern) const {
    pattern.resize(dim(), dim());
    pattern.setIdentity();
  }
};

template <class Method>
struct RosenbrockAllocatesNothing : testing::Test {};
/// Without an error estimate, with the slope at the end as the next first stage, with an interpolant.
using RosenbrockKinds =
    testing::Types<tableaux::LinearlyImplicitEuler, tableaux::Rosenbrock23, tableaux::Rodas4>;
TYPED_TEST_SUITE(RosenbrockAllocatesNothing, RosenbrockKinds, MethodId);

/// With the system's own Jacobian, with differences of columns and of groups of columns, for equations that
/// are solved here and for those left to Eigen.
TYPED_TEST(RosenbrockAllocatesNothing, FromAttemptToAccept) {
  for (const Eigen::Index n : {2, 20}) {
    const Decay<State> decay{State::LinSpaced(n, -2, -1)};
    const Rosenbrock<TypeParam, State> stepper;
    expect_no_allocation(stepper, ErasedSystem(DecayWithJacobian<State>{decay}), State::Ones(n), 0.4);
    expect_no_allocation(stepper, ErasedSystem(decay), State::Ones(n), 0.4);
    expect_no_allocation(stepper, Patterned{decay}, State::Ones(n), 0.4);
  }
}

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
using ImexKinds = testing::Types<tableaux::ImexEuler, tableaux::ImexArk324>;
TYPED_TEST_SUITE(ImexAllocatesNothing, ImexKinds, MethodId);

TYPED_TEST(ImexAllocatesNothing, FromAttemptToAccept) {
  ImexRk<TypeParam, State, Relaxation::Jacobian> stepper;
  stepper.set_jacobian_update({1});
  expect_no_allocation(stepper, Relaxation(), State::Ones(20), 0.4);
}

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

TEST(StructuralAllocatesNothing, FromAttemptToAccept) {
  const State y = State::LinSpaced(40, -2, 2);
  // A step of 30 is one that simplified Newton iteration does not solve.
  expect_no_allocation(SymplecticEuler<State>{}, Springs(), y, 30);
  expect_no_allocation(VelocityVerlet<State>{}, Springs(), y, 30);
  expect_no_allocation(StormerVerlet<State>{}, Springs(), y, 30);
  expect_no_allocation(CentralDifference<State>{}, Springs(), y, 30);
  for (const int every : {JacobianUpdate::automatic, JacobianUpdate::frozen, 1}) {
    GeneralizedAlpha<State, State, Eigen::MatrixXd> stepper(generalized_alpha_parameters(0.8L));
    stepper.set_jacobian_update({every});
    expect_no_allocation(stepper, Springs(), y, 30);
  }
}

}  // namespace
}  // namespace hmax
