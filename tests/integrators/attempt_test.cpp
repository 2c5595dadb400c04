/// attempt() may be repeated, interpolate() may come between: neither leaves a trace, to the last bit.
#include <cstdint>
#include <cstring>

#include "integrators/stats.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using State = Eigen::Vector2d;

template <class StateT>
bool same_bits(const StateT& a, const StateT& b) {
  const auto bytes = static_cast<std::size_t>(a.size()) * sizeof(typename StateT::Scalar);
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), bytes) == 0;
}

/// Two accepted steps of size 0.1; before each attempt, `disturb` may do with the stepper what it likes.
template <class Method, class StateT, class Disturb>
StateT two_steps(Disturb disturb) {
  Stats unread;
  const Counted system(Pendulum<StateT>{}, unread);
  Rk<Method, StateT> stepper;
  StateT y(2), y_new(2);
  y << 0.3, 0.5;
  stepper.init(system, 0, y);
  for (int n = 0; n < 2; ++n) {
    disturb(stepper, system, 0.1 * n, y);
    stepper.attempt(system, 0.1 * n, y, 0.1, y_new);
    stepper.accept(y_new);
    y = y_new;
  }
  return y;
}

const auto nothing = [](auto&&...) {};
const auto reject_a_large_step = [](auto& stepper, const auto& system, double t, const auto& y) {
  auto rejected = y;
  stepper.attempt(system, t, y, 3.7, rejected);
};
const auto reject_and_interpolate = [](auto& stepper, const auto& system, double t, const auto& y) {
  auto rejected = y, between = y;
  stepper.attempt(system, t, y, 3.7, rejected);
  stepper.interpolate(system, t, 3.7, y, rejected, 0.4, between);
};

template <class Method>
struct Attempt : testing::Test {};
TYPED_TEST_SUITE(Attempt, EveryMethod, MethodId);

TYPED_TEST(Attempt, ThatIsRejectedLeavesNoTrace) {
  const State fresh = two_steps<TypeParam, State>(nothing);
  EXPECT_TRUE(same_bits(fresh, two_steps<TypeParam, State>(reject_a_large_step)));
  EXPECT_TRUE(same_bits(fresh, two_steps<TypeParam, State>(reject_and_interpolate)));
}

/// With and without the slope at the end as the next first stage, an error estimate, and stages of an
/// interpolant.
template <class Method>
struct DynamicAttempt : testing::Test {};
using OneOfEachKind = testing::Types<tableaux::ExplicitEuler, tableaux::Rk4, tableaux::BogackiShampine32,
                                     tableaux::DormandPrince54, tableaux::Fehlberg78, tableaux::Dop853>;
TYPED_TEST_SUITE(DynamicAttempt, OneOfEachKind, MethodId);

TYPED_TEST(DynamicAttempt, LeavesNoTrace) {
  using Dynamic = Eigen::VectorXd;
  const Dynamic fresh = two_steps<TypeParam, Dynamic>(nothing);
  EXPECT_TRUE(same_bits(fresh, two_steps<TypeParam, Dynamic>(reject_and_interpolate)));
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
  EXPECT_TRUE(same_bits(run(false), run(true)));
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
