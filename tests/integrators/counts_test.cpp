/// What a run costs, and that neither the wrapper that counts nor the split of time changes a bit of it.
#include <cstdint>

#include "integrators/integrate.hpp"
#include "problems/oscillator/oscillator.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using State = Eigen::Vector2d;
constexpr Span<double> span{0, 10};

/// The oscillator as a system that does not split off its force.
struct Unsplit {
  using State = Oscillator::State;
  Oscillator oscillator;
  static Eigen::Index dim() { return 2; }
  void rhs(double t, const State& y, State& dydt) const { oscillator.rhs(t, y, dydt); }
};
static_assert(TimeSplitSystem<Oscillator> && !TimeSplitSystem<Unsplit>);

template <class Method, class System>
State end_state(const System& system) {
  State y(0.5, 1);
  integrate(Rk<Method, State>{}, system, span, y, FixedStep<double>(0.15));
  return y;
}

/// Evaluations of f in n fixed steps.
template <class Method>
std::int64_t cost_of_steps(int n) {
  Stats stats;
  const Oscillator oscillator;
  State y(0.5, 1);
  integrate(Rk<Method, State>{}, Counted(oscillator, stats), span, y, FixedStep<double>(10.0 / n));
  return stats.rhs;
}

template <class Method>
struct Run : testing::Test {};
TYPED_TEST_SUITE(Run, EveryMethod, MethodId);

TYPED_TEST(Run, HasTheSameBitsHoweverTheSystemIsWrapped) {
  const Oscillator oscillator;
  const State y = end_state<TypeParam>(oscillator);
  EXPECT_EQ(y, end_state<TypeParam>(oscillator)) << "a second run";
  EXPECT_EQ(y, end_state<TypeParam>(Unsplit{oscillator}));
  Stats stats;
  EXPECT_EQ(y, end_state<TypeParam>(Counted(oscillator, stats)));
}

TEST(Counts, AreThoseOfTheLiterature) {
  EXPECT_EQ(cost_of_steps<tableaux::ExplicitEuler>(50), 50);
  EXPECT_EQ(cost_of_steps<tableaux::Rk4>(50), 4 * 50);
  EXPECT_EQ(cost_of_steps<tableaux::BogackiShampine32>(50), 3 * 50 + 1);
  EXPECT_EQ(cost_of_steps<tableaux::DormandPrince54>(50), 6 * 50 + 1);
  EXPECT_EQ(cost_of_steps<tableaux::Tsitouras54>(50), 6 * 50 + 1);
  EXPECT_EQ(cost_of_steps<tableaux::Fehlberg78>(50), 13 * 50);
  EXPECT_EQ(cost_of_steps<tableaux::Dop853>(50), 12 * 50 + 1);
}

TEST(Counts, OfRejectedAttemptsReuseTheFirstStage) {
  Stats stats;
  const Oscillator oscillator;
  State y(0.5, 1);
  // A first step of 5 is rejected. h_first is given, so the control itself evaluates nothing.
  const auto end = integrate(Rk<tableaux::Fehlberg78, State>{}, Counted(oscillator, stats), span, y,
                             Adaptive<double, PiController>({1e-10, 1e-10, 5}, 8));
  EXPECT_GT(end.stats.rejected, 0);
  EXPECT_EQ(stats.rhs, 13 * end.stats.steps + 12 * end.stats.rejected);
}

TEST(Counts, OfTheForceAreOnePerStageTime) {
  // g(t) of DP54: at c = 1/5, 3/10, 4/5, 8/9 and 1 once each; the first stage is known from the step before.
  struct CountsForce {
    using State = Oscillator::State;
    const Oscillator& oscillator;
    std::int64_t& calls;
    static Eigen::Index dim() { return 2; }
    double at(double t) const { return ++calls, oscillator.at(t); }
    void rhs_at(double force, const State& y, State& dydt) const { oscillator.rhs_at(force, y, dydt); }
    void rhs(double t, const State& y, State& dydt) const { rhs_at(at(t), y, dydt); }
  };
  const Oscillator oscillator;
  std::int64_t calls = 0;
  const CountsForce system{oscillator, calls};
  end_state<tableaux::DormandPrince54>(system);
  EXPECT_EQ(calls, 5 * 67 + 1);
}

}  // namespace
}  // namespace hmax
