/// attempt() may be repeated, interpolate() may come between: neither leaves a trace, to the last bit.
#include <cstdint>

#include "integrators/stats.hpp"
#include "tests/integrators/methods.hpp"
#include "tests/integrators/rejected_attempts.hpp"

namespace hmax {
namespace {

using State = Eigen::Vector2d;

template <class Method>
struct Attempt : testing::Test {};
TYPED_TEST_SUITE(Attempt, OneOfEachKind, MethodId);

TYPED_TEST(Attempt, ThatIsRejectedLeavesNoTrace) {
  const State start(0.3, 0.5);
  expect_no_trace_of_rejected_attempts(Rk<TypeParam, State>{}, Pendulum<State>{}, start, {3.7});
  expect_no_trace_of_rejected_attempts(Rk<TypeParam, Eigen::VectorXd>{}, Pendulum<Eigen::VectorXd>{},
                                       Eigen::VectorXd(start), {3.7});
}

TYPED_TEST(Attempt, IsAcceptedAfterInterpolationAsWithout) {
  Stats unread;
  const Counted system(Pendulum<State>{}, unread);
  const auto run = [&](bool looks) {
    Rk<TypeParam, State> stepper;
    State y(0.3, 0.5), y_new, between;
    stepper.init(system, 0, y);
    for (int n = 0; n < 3; ++n) {
      stepper.attempt(system, 0.1 * n, y, 0.1, y_new);
      if (looks)
        for (const double theta : {0.2, 0.9})
          stepper.interpolate(system, 0.1 * n, 0.1, y, y_new, theta, between);
      stepper.accept(y_new);
      y = y_new;
    }
    return y;
  };
  EXPECT_EQ(run(false), run(true));
}

TYPED_TEST(Attempt, EvaluatesAsOftenAsItsTableauSays) {
  constexpr std::int64_t s = TypeParam::tableau.stages;
  constexpr bool fsal = is_fsal(TypeParam::tableau);
  Stats stats;
  const Pendulum<State> pendulum;
  const Counted system(pendulum, stats);
  Rk<TypeParam, State> stepper;
  State y(0.3, 0.5), y_new, between;
  const auto cost_of = [&](auto&& action) {
    const std::int64_t before = stats.rhs;
    action();
    return stats.rhs - before;
  };
  const auto attempt = [&] { stepper.attempt(system, 0, y, 0.1, y_new); };
  stepper.init(system, 0, y);
  EXPECT_EQ(cost_of(attempt), s);
  EXPECT_EQ(cost_of(attempt), s - 1) << "a repeated attempt knows its first stage";
  stepper.accept(y_new);
  EXPECT_EQ(cost_of(attempt), fsal ? s - 1 : s);
  stepper.accept(y_new);
  attempt();
  // The extra stages of an interpolant, or the slope at the end where the method does not have it: once a
  // step. The slope at the end then is the first stage of the next step.
  const auto interpolate = [&] { stepper.interpolate(system, 0, 0.1, y, y_new, 0.5, between); };
  const std::int64_t extra = StaticCoefficients<TypeParam>::extra_stages;
  EXPECT_EQ(cost_of(interpolate), fsal ? extra : 1);
  EXPECT_EQ(cost_of(interpolate), 0);
  stepper.accept(y_new);
  EXPECT_EQ(cost_of(attempt), s - 1);
}

}  // namespace
}  // namespace hmax
