/// Adaptive control that takes the order of its error estimate from the method.
#include <stdexcept>

#include <gtest/gtest.h>

#include "integrators/explicit/adaptive.hpp"
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"

namespace hmax {
namespace {

struct Spring {
  using State = Eigen::Vector2d;
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double /*t*/, const State& y, State& dydt) const { dydt << y[1], -y[0]; }
};

TEST(AdaptiveOfMethod, TakesTheOrderOfItsErrorFromTheMethod) {
  using Method = tableaux::BogackiShampine32;
  const auto run = [](auto stepper, auto control) {
    Spring::State y(1, 0);
    const auto end = integrate(stepper, Spring{}, Span<double>{0, 10}, y, control);
    return std::pair(y, end.stats.steps);
  };
  using State = Spring::State;
  const auto [y, steps] =
      run(Rk<Method, State>{}, Adaptive<double, PiController>({1e-6, 1e-6}, Method::error_order));
  const auto [own, own_steps] = run(Rk<Method, State>{}, adaptive<Method>({1e-6, 1e-6}));
  EXPECT_EQ(own, y);
  EXPECT_EQ(own_steps, steps);
  const RuntimeTableau tableau = runtime_tableau<Method>();
  const auto [read, read_steps] =
      run(ExplicitRk<RuntimeTableau, State>(tableau), adaptive(tableau, {1e-6, 1e-6}));
  EXPECT_EQ(read_steps, steps);
  EXPECT_NEAR((read - y).norm(), 0, 1e-12);
}

TEST(AdaptiveOfMethod, RefusesATableauWithoutAnErrorEstimate) {
  EXPECT_THROW(adaptive(runtime_tableau<tableaux::Rk4>(), {1e-6, 1e-6}), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
