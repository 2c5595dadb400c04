/// After init() no step allocates. Eigen itself reports every allocation; an overridden operator new would
/// miss its malloc.
#include <stdexcept>

#define EIGEN_RUNTIME_NO_MALLOC
// Eigen reports through its assertion, which a release build would drop.
#define eigen_assert(condition) \
  ((condition) ? void(0) : throw std::logic_error("Eigen's assertion failed: " #condition))

#include "integrators/integrate.hpp"
#include "integrators/observers.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using State = Eigen::VectorXd;
const Decay<State> system_of_twenty{State::LinSpaced(20, -2, -1)};

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

template <class Method>
struct AllocatesNothing : testing::Test {};
TYPED_TEST_SUITE(AllocatesNothing, EveryMethod, MethodId);

TYPED_TEST(AllocatesNothing, FromAttemptToAccept) {
  Rk<TypeParam, State> stepper;
  State y = State::Ones(20), y_new = y, between = y;
  stepper.init(system_of_twenty, 0, y);
  const NoMalloc guard;
  double error = 0;
  ASSERT_NO_THROW(for (const double h
                       : {0.2, 0.1}) {
    stepper.attempt(system_of_twenty, 0, y, 2 * h, y_new);
    stepper.attempt(system_of_twenty, 0, y, h, y_new);
    if constexpr (TypeParam::error_order > 0) {
      error += stepper.error_squared(h, y, y_new, RmsNorm<double>{1e-6, 1e-6});
      error += stepper.error_squared(h, y, y_new, MatlabNorm<double>{1e-6, 1e-6});
    }
    stepper.interpolate(system_of_twenty, 0, h, y, y_new, 0.3, between);
    stepper.accept(y_new);
  });
  EXPECT_EQ(error > 0, TypeParam::error_order > 0);
}

/// Forbids allocation from the first accepted step on, that is once the run is set up.
struct ForbidFromTheFirstStep {
  template <class View>
  void operator()(View& view) {
    Eigen::internal::set_is_malloc_allowed(false);
    inner(view);
  }
  SampleEvery<State, void (*)(double, const State&)> inner;
};

template <class Stepper, class Control>
RunEnd<double> run(Stepper stepper, Control control) {
  const Span<double> span{0, 3};
  State y = State::Ones(20);
  ForbidFromTheFirstStep observer{{span, 0.25, y, [](double, const State&) {}}};
  const auto end = integrate(stepper, system_of_twenty, span, y, control, observer);
  Eigen::internal::set_is_malloc_allowed(true);
  return end;
}

TEST(IntegrateAllocatesNothing, InFixedSteps) {
  RunEnd<double> end;
  ASSERT_NO_THROW(end = run(Rk<tableaux::Rk4, State>{}, FixedStep<double>(0.1)));
  EXPECT_EQ(end.stats.steps, 30);
  ASSERT_NO_THROW(end = run(Rk<tableaux::Dop853, State>{}, FixedStep<double>(0.1)));
  EXPECT_EQ(end.stats.steps, 30);
}

TEST(IntegrateAllocatesNothing, InAdaptiveSteps) {
  RunEnd<double> end;
  // A first step of 3 is rejected.
  ASSERT_NO_THROW(
      end = run(Rk<tableaux::DormandPrince54, State>{}, Adaptive<double, PiController>({1e-9, 1e-9, 3}, 5)));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
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
  RunEnd<double> end;
  ASSERT_NO_THROW(end = run(ExplicitRk<RuntimeTableau, State>(heun_euler),
                            Adaptive<double, DeadbandController>({1e-4, 1e-4}, 2)));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
}

}  // namespace
}  // namespace hmax
