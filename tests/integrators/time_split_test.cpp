/// Systems that split off their dependence on time: g(t) is evaluated once per distinct time.
#include <cmath>

#include <gtest/gtest.h>

#include "integrators/control.hpp"
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"

namespace hmax {
namespace {

/// y' = cos t, so y = sin t.
struct Cosine {
  using State = Eigen::Matrix<double, 1, 1>;
  static Eigen::Index dim() { return 1; }
  void rhs(double t, const State&, State& dydt) const { dydt[0] = std::cos(t); }
};

struct SplitCosine : Cosine {
  explicit SplitCosine(int& calls) : calls_(calls) {}
  double at(double t) const {
    ++calls_;
    return std::cos(t);
  }
  void rhs_at(double g, const State&, State& dydt) const { dydt[0] = g; }
  void rhs(double t, const State& y, State& dydt) const { rhs_at(at(t), y, dydt); }

 private:
  int& calls_;
};
static_assert(TimeSplitSystem<SplitCosine> && !TimeSplitSystem<Cosine>);

template <class Method>
int calls_in(int steps, double h) {
  int calls = 0;
  Cosine::State y = Cosine::State::Zero();
  const auto end =
      integrate(Rk<Method, Cosine::State>(), SplitCosine(calls), {0, steps * h}, y, FixedStep<double>(h));
  EXPECT_EQ(end.stats.steps, steps);
  return calls;
}

// 0.1 is not a binary fraction: t0 + n h and t + h then differ in their last digit in a third of the steps.
TEST(TimeSplit, Rk4EvaluatesTwoNewTimesAStep) { EXPECT_EQ(calls_in<tableaux::Rk4>(100, 0.1), 2 * 100 + 1); }
TEST(TimeSplit, MidpointHasNoStageAtTheEndToKeep) {
  EXPECT_EQ(calls_in<tableaux::Rk2Midpoint>(100, 0.1), 2 * 100);
}
TEST(TimeSplit, DormandPrinceEvaluatesFiveTimesAStep) {
  EXPECT_EQ(calls_in<tableaux::DormandPrince54>(100, 0.1), 5 * 100 + 1);
}

TEST(TimeSplit, AKeptValueChangesNothingButRounding) {
  int calls = 0;
  Cosine::State split = Cosine::State::Zero(), plain = split;
  integrate(Rk<tableaux::Rk4, Cosine::State>(), SplitCosine(calls), {0, 10}, split, FixedStep<double>(0.1));
  integrate(Rk<tableaux::Rk4, Cosine::State>(), Cosine(), {0, 10}, plain, FixedStep<double>(0.1));
  EXPECT_NEAR(split[0], plain[0], 1e-14);
}

TEST(TimeSplit, AValueIsNotKeptAcrossAJumpInTimeOrAnotherRun) {
  int calls = 0;
  const SplitCosine system(calls);
  Rk<tableaux::Rk4, Cosine::State> rk4;
  const Cosine::State y = Cosine::State::Zero();
  Cosine::State found = y;
  rk4.init(system, 0, y);
  rk4.attempt(system, 0, y, 0.5, found);
  rk4.accept(found);
  rk4.attempt(system, 2, y, 0.25, found);
  const double simpson = 0.25 / 6 * (std::cos(2.0) + 4 * std::cos(2.125) + std::cos(2.25));
  EXPECT_NEAR(found[0], simpson, 1e-16);

  const int before = calls;
  rk4.init(system, 2.25, y);
  rk4.attempt(system, 2.25, y, 0.25, found);
  EXPECT_EQ(calls - before, 3);
}

TEST(TimeSplit, ARejectedAttemptLeavesTheFirstStageAsItWas) {
  int calls = 0;
  const SplitCosine system(calls);
  Rk<tableaux::Rk4, Cosine::State> rk4;
  const Cosine::State y = Cosine::State::Zero();
  Cosine::State found = y;
  rk4.init(system, 1, y);
  rk4.attempt(system, 1, y, 0.5, found);
  rk4.attempt(system, 1, y, 0.25, found);
  EXPECT_NEAR(found[0], 0.25 / 6 * (std::cos(1.0) + 4 * std::cos(1.125) + std::cos(1.25)), 1e-16);
}

}  // namespace
}  // namespace hmax
