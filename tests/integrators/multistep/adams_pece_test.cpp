/// The Adams method of variable order and step.
#include "integrators/multistep/adams_pece.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "integrators/integrate.hpp"
#include "integrators/observers.hpp"
#include "integrators/stats.hpp"
#include "problems/oscillator/oscillator_reference.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using State = Eigen::Vector2d;
using One = Eigen::Matrix<double, 1, 1>;
using PlaneAdams = AdamsPece<State>;
static_assert(Stepper<PlaneAdams, Pendulum<State>>);

template <class System>
RunEnd<double> run(const System& system, double t_end, typename System::State& y,
                   Tolerances<double> tolerances, std::int64_t attempts = 100'000) {
  using Stepper = AdamsPece<typename System::State>;
  return integrate(Stepper(), system, {0, t_end}, y, typename Stepper::Control(tolerances), ObserveNothing{},
                   attempts);
}

struct Figures {
  std::int64_t rhs;
  double error_at_steps, error_between;  // largest of the run, maximum norm
};

Figures forced_liver(double tolerance) {
  const Oscillator oscillator;
  const State y0(0.5, 1);
  const OscillatorReference exact(oscillator.parameters(), y0, 100);
  Figures figures{};
  const auto integrate_and = [&](auto&& look) {
    Stats stats;
    State y = y0;
    const auto end = integrate(PlaneAdams(), Counted(oscillator, stats), {0, 100}, y,
                               PlaneAdams::Control({tolerance, tolerance}), look);
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    return stats.rhs;
  };
  figures.rhs = integrate_and([&](auto& view) {
    figures.error_at_steps =
        std::max(figures.error_at_steps, (view.y1() - exact.at(view.t1())).cwiseAbs().maxCoeff());
  });
  State sample;
  integrate_and([&](auto& view) {
    for (const double theta : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const double t = view.t0() + theta * view.h();
      view.at(t, sample);
      figures.error_between = std::max(figures.error_between, (sample - exact.at(t)).cwiseAbs().maxCoeff());
    }
  });
  return figures;
}

TEST(AdamsPece, CostsAndErrsLikeThePublishedCodeOnTheForcedLiverModel) {
  // Evaluations and global errors of a published Shampine-Gordon code; ours may take 1.15 times as many and
  // err twice as much.
  struct Published {
    double tolerance;
    int rhs;
    double error;
  };
  for (const auto& [tolerance, rhs, error] :
       {Published{1e-4, 449, 2e-4}, {1e-6, 696, 4e-6}, {1e-8, 1050, 7e-8}, {1e-10, 1702, 1e-10}}) {
    const Figures ours = forced_liver(tolerance);
    EXPECT_LE(static_cast<double>(ours.rhs), 1.15 * rhs) << tolerance;
    EXPECT_LE(ours.error_at_steps, 2 * error) << tolerance;
    EXPECT_LE(ours.error_between, 2 * error) << tolerance;
  }
}

/// One step of order k after a past of unequal steps, on a polynomial of degree k + 1 in t: the past is
/// exact.
/// @returns the error of the step, and the largest error of the interpolant
template <class StateT>
std::pair<double, double> error_on_polynomials(int k) {
  const auto system = system_of<StateT>(
      [=](double t, const StateT&, StateT& dydt) { dydt[0] = (k + 1) * std::pow(t, k); }, 1);
  AdamsPece<StateT> adams;
  const auto exact = [&](double t) -> StateT { return StateT::Constant(1, std::pow(t, k + 1)); };
  double t = -1.5;
  StateT y = exact(t), y_new = y, between = y;
  adams.init(system, t, y);
  for (int n = 0; n < 30; ++n) {
    const double h = 0.05 * (1 + (n * 7 % 5) / 5.0);
    adams.set_order(std::min(n + 1, k));
    adams.attempt(system, t, y, h, y_new);
    if (n == 29) {
      double worst = 0;
      for (const double theta : {0.0, 0.2, 0.5, 0.8, 1.0}) {
        adams.interpolate(system, t, h, y, y_new, theta, between);
        worst = std::max(worst, std::abs(between[0] - exact(t + theta * h)[0]));
      }
      return {std::abs(y_new[0] - exact(t + h)[0]), worst};
    }
    adams.accept(y_new);
    t += h;
    y = exact(t);
  }
  return {};
}

TEST(AdamsPece, IsExactToOrderKPlusOneAtUnequalStepsAtTheEndAndBetween) {
  for (int k = 1; k <= PlaneAdams::max_order; ++k) {
    const auto [error, between] = error_on_polynomials<One>(k);
    EXPECT_LT(error, 1e-14) << k;
    EXPECT_LT(between, 1e-14) << k;
    EXPECT_LT(error_on_polynomials<Eigen::VectorXd>(k).first, 1e-14) << k;
  }
}

TEST(AdamsPece, ItsEstimatesAreTheTermsOfTheAdamsFormulas) {
  // y' = exp t at equal steps: the formula of order q leaves out h |gamma*_q nabla^q f_n+1|, and
  // nabla^q exp t = (1 - exp(-h))^q exp t.
  using Extended = Eigen::Matrix<long double, 1, 1>;
  const auto system =
      system_of<Extended>([](long double t, const Extended&, Extended& dydt) { dydt[0] = std::exp(t); });
  constexpr auto gamma_star = adams::gamma_star<14>();
  const long double h = 0.1L;
  for (int k = 3; k <= PlaneAdams::max_order; ++k) {
    AdamsPece<Extended> adams;
    Extended y(1.0L), y_new;
    adams.init(system, 0, y);
    for (int n = 0; n < 2 * k; ++n) {
      adams.set_order(std::min(n + 1, k));
      adams.attempt(system, static_cast<long double>(n) * h, y, h, y_new);
      adams.accept(y_new);
      y = y_new;
    }
    const long double t = 2 * k * h;
    adams.attempt(system, t, y, h, y_new);
    adams.evaluate_end(system, t + h, y_new);
    ASSERT_TRUE(adams.steps_are_equal());
    const auto one = [](Eigen::Index) { return 1.0L; };
    const auto ratio = [&](long double estimate, int q) {
      const long double term = h * std::abs(gamma_star[static_cast<std::size_t>(q)]) *
                               std::pow(1 - std::exp(-h), static_cast<long double>(q)) * std::exp(t + h);
      return static_cast<double>(estimate / term);
    };
    const AdamsErrors<long double> errors = adams.errors(one);
    EXPECT_NEAR(ratio(errors.step, k), 1, 1e-3) << k;
    EXPECT_NEAR(ratio(errors.at_order, k), 1, 1e-3) << k;
    EXPECT_NEAR(ratio(errors.one_below, k - 1), 1, 1e-3) << k;
    EXPECT_NEAR(ratio(errors.two_below, k - 2), 1, 1e-3) << k;
    EXPECT_NEAR(ratio(adams.error_one_above(one), k + 1), 1, 1e-2) << k;
  }
}

TEST(AdamsPece, ItsEstimatesForTheOrderDoNotDependOnThePastSteps) {
  // y' = t^k: the k-th divided difference is 1, the one before it the sum of its nodes, whatever the steps.
  constexpr auto gamma_star = adams::gamma_star<14>();
  for (int k = 3; k <= 8; ++k) {
    const auto system = system_of<One>([=](double t, const One&, One& dydt) { dydt[0] = std::pow(t, k); });
    AdamsPece<One> adams;
    One y(0.0), y_new;
    std::vector<double> t{0.1};
    double h = 0;
    adams.init(system, t[0], y);
    for (int n = 0; n < 20; ++n) {
      if (n > 0) adams.accept(y_new);
      h = 0.05 * (1 + (n * 7 % 5) / 5.0);
      adams.set_order(std::min(n + 1, k));
      adams.attempt(system, t.back(), y, h, y_new);
      t.push_back(t.back() + h);
    }
    const auto errors = adams.errors([](Eigen::Index) { return 1.0; });
    const auto scale = [&](int q) {
      return std::abs(static_cast<double>(gamma_star[static_cast<std::size_t>(q)])) * std::pow(h, q + 1) *
             static_cast<double>(std::tgamma(q + 1.0L));
    };
    double nodes = 0;
    for (int i = 0; i < k; ++i) nodes += t[t.size() - 1 - static_cast<std::size_t>(i)];
    EXPECT_NEAR(errors.at_order / scale(k), 1, 1e-4) << k;
    EXPECT_NEAR(errors.one_below / (scale(k - 1) * nodes), 1, 1e-4) << k;
  }
}

/// What a stepper tells the control, as a test wants it.
struct Told {
  static constexpr int max_order = 12;
  AdamsErrors<double> told{};
  double above = 0;
  bool equal = false;
  int k = 1;
  One slope = One::Zero();
  const AdamsErrors<double>& errors(const auto&) const { return told; }
  double error_one_above(const auto&) const { return above; }
  bool steps_are_equal() const { return equal; }
  int current_order() const { return k; }
  void set_order(int order) { k = order; }
  const One& evaluate_start(const auto&, double, const One&) const { return slope; }
  const One& evaluate_end(const auto&, double, const One&) const { return slope; }
};

/// The control with eps = 1e-3, past its first phase unless `doubling`.
struct AfterTheStart {
  explicit AfterTheStart(bool doubling = false) {
    control.start(stepper, system, {0, 1e6}, y);
    if (!doubling) judge(1, {.step = 3, .at_order = 3});
  }
  /// Size of the step after one of size 1 at order k with these errors, in units of eps / 2.
  double judge(int k, AdamsErrors<double> errors, double above = -1) {
    const double half = 5e-4;
    stepper.k = k;
    stepper.equal = above >= 0;
    stepper.above = above * half;
    stepper.told = {errors.step * half, errors.at_order * half, errors.one_below * half,
                    errors.two_below * half};
    accepted = control.judge(stepper, system, {1, 2, false}, y, y) == Judgement::accept;
    return control.propose(2).h;
  }
  ShampineGordonControl<double> control{{1e-3 / 0.7, 1e-3 / 0.7}};
  Told stepper;
  Decay<One> system{One(-1.0)};
  One y = One::Zero();
  bool accepted = false;
};

TEST(ShampineGordon, DoublesStepAndRaisesOrderAtTheStart) {
  AfterTheStart run(true);
  EXPECT_EQ(run.judge(1, {.step = 1, .at_order = 1.9}), 2);
  EXPECT_EQ(run.stepper.k, 2);
}

TEST(ShampineGordon, DoublesKeepsOrShrinksTheStep) {
  AfterTheStart run;
  const AdamsErrors<double> none{.step = 0.1, .at_order = 0, .one_below = 999, .two_below = 999};
  const auto next = [&](double error) {
    AdamsErrors<double> errors = none;
    errors.at_order = error;
    return run.judge(4, errors);
  };
  EXPECT_EQ(next(0.99 / 32), 2);
  EXPECT_EQ(next(1.01 / 32), 1);
  EXPECT_EQ(next(0.99), 1);
  EXPECT_EQ(next(1.01), 0.9);
  EXPECT_NEAR(next(5), std::pow(5, -0.2), 1e-12);
  EXPECT_EQ(next(100), 0.5);
  EXPECT_EQ(run.stepper.k, 4);
}

TEST(ShampineGordon, LowersTheOrderWhenErrorsBelowAreNoLarger) {
  AfterTheStart run;
  const auto order_after = [&](int k, double one_below, double two_below, double above = -1) {
    run.judge(k, {.step = 0.1, .at_order = 0.5, .one_below = one_below, .two_below = two_below}, above);
    return run.stepper.k;
  };
  EXPECT_EQ(order_after(5, 0.5, 0.4), 4);
  EXPECT_EQ(order_after(5, 0.4, 0.6), 5);
  EXPECT_EQ(order_after(5, 0.6, 0.4), 5);
  EXPECT_EQ(order_after(2, 0.25, 0), 1);
  EXPECT_EQ(order_after(2, 0.26, 0), 2);
  EXPECT_EQ(order_after(5, 0.4, 0.6, 0.45), 4) << "equal steps tell that order 6 would err more";
}

TEST(ShampineGordon, RaisesTheOrderWhenTheErrorAboveIsSmaller) {
  AfterTheStart run;
  const auto order_after = [&](int k, double above) {
    run.judge(k, {.step = 0.1, .at_order = 0.5, .one_below = 1, .two_below = 9}, above);
    return run.stepper.k;
  };
  EXPECT_EQ(order_after(5, 0.49), 6);
  EXPECT_EQ(order_after(5, 0.5), 5);
  EXPECT_EQ(order_after(12, 0.1), 12);
  EXPECT_EQ(order_after(1, 0.24), 2);
  EXPECT_EQ(order_after(1, 0.26), 1);
}

TEST(ShampineGordon, HalvesFailedStepsAndStartsAnewAfterTheThird) {
  AfterTheStart run;  // one failure behind it
  run.judge(5, {.step = 1, .at_order = 0.5, .one_below = 9, .two_below = 9});
  const AdamsErrors<double> failing{.step = 2.1, .at_order = 50, .one_below = 60, .two_below = 60};
  for (const int order : {5, 5, 1}) {
    EXPECT_EQ(run.judge(5, failing), 0.5);
    EXPECT_FALSE(run.accepted);
    EXPECT_EQ(run.stepper.k, order);
  }
  EXPECT_NEAR(run.judge(1, failing), std::sqrt(1 / 50.0), 1e-12);
}

TEST(AdamsPece, LeavesNoTraceOfARejectedAttempt) {
  const Pendulum<State> system;
  const auto go = [&](bool disturbed) {
    PlaneAdams adams;
    State y(0.3, 0.5), y_new, other;
    adams.init(system, 0, y);
    for (int n = 0; n < 20; ++n) {
      const double t = 0.1 * n;
      if (disturbed) {
        adams.set_order(std::max(1, std::min(n, 6) - 1));
        adams.attempt(system, t, y, 0.37, other);
        adams.interpolate(system, t, 0.37, y, other, 0.4, y_new);
      }
      adams.set_order(std::min(n + 1, 6));
      adams.attempt(system, t, y, 0.1, y_new);
      if (n % 3 == 0) adams.evaluate_end(system, t + 0.1, y_new);
      adams.accept(y_new);
      y = y_new;
    }
    return y;
  };
  const State fresh = go(false), disturbed = go(true);
  EXPECT_EQ(fresh, disturbed);
}

TEST(AdamsPece, TakesTwoEvaluationsAStepOneARejectionAndNoneAtTheEnd) {
  Stats stats;
  const Pendulum<State> pendulum;
  State y(0.3, 0.5);
  const auto end = run(Counted(pendulum, stats), 20, y, {1e-6, 1e-6});
  EXPECT_EQ(stats.rhs, 2 * end.stats.steps + end.stats.rejected);
}

TEST(AdamsPece, EndsOnTheSameStateWhetherSomebodyLooksOrNot) {
  const Pendulum<State> system;
  State y(0.3, 0.5), watched = y;
  run(system, 20, y, {1e-7, 1e-7});
  integrate(PlaneAdams(), system, {0, 20}, watched, PlaneAdams::Control({1e-7, 1e-7}),
            SampleEvery<State, void (*)(double, const State&)>({0, 20}, 0.03, watched,
                                                               [](double, const State&) {}));
  EXPECT_EQ(y, watched);
}

TEST(AdamsPece, ADynamicStateTakesTheStepsOfASmallOne) {
  State y(0.3, 0.5);
  Eigen::VectorXd z = y;
  const auto small = run(Pendulum<State>(), 5, y, {1e-5, 1e-5});
  const auto large = run(Pendulum<Eigen::VectorXd>(), 5, z, {1e-5, 1e-5});
  EXPECT_EQ(small.stats, large.stats);
  EXPECT_LT((y - z).norm(), 1e-12);
}

/// The control, with a record of the orders it chose.
struct Spy : ShampineGordonControl<double> {
  using ShampineGordonControl::ShampineGordonControl;
  std::vector<std::pair<double, int>>* orders = nullptr;
  template <class Stepper, class Sys>
  Judgement judge(Stepper& stepper, const Sys& system, const Proposal<double>& step, const One& from,
                  const One& to) {
    const Judgement verdict = ShampineGordonControl::judge(stepper, system, step, from, to);
    orders->emplace_back(step.t_next, stepper.current_order());
    return verdict;
  }
};

TEST(AdamsPece, ReachesHighOrdersWhereTheyPayAndFallsBackAfterAJump) {
  const auto system =
      system_of<One>([](double t, const One& y, One& dydt) { dydt[0] = std::cos(t) - (t > 20 ? y[0] : 0); });
  One y(0.0);
  Spy control({1e-9, 1e-9});
  std::vector<std::pair<double, int>> orders;
  control.orders = &orders;
  const auto end = integrate(AdamsPece<One>(), system, {0, 40}, y, control);
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  int highest = 0, after_jump = PlaneAdams::max_order;
  for (const auto& [t, k] : orders)
    if (t < 20)
      highest = std::max(highest, k);
    else if (t < 21)
      after_jump = std::min(after_jump, k);
  EXPECT_GE(highest, 10);
  EXPECT_LE(after_jump, 2);
  // y' = cos t - y from y(20) = sin 20 on.
  const auto particular = [](double t) { return (std::cos(t) + std::sin(t)) / 2; };
  EXPECT_NEAR(y[0], particular(40) + (std::sin(20) - particular(20)) * std::exp(-20), 1e-7);
}

TEST(AdamsPece, CutsItsStepsBeforeARegionWithoutValuesAndSaysSo) {
  const auto wall =
      system_of<One>([](double, const One& y, One& dydt) { dydt[0] = std::sqrt(1 - y[0]) + 1; });
  One y(0.0);
  const auto end = run(wall, 10, y, {1e-6, 1e-6});
  EXPECT_EQ(end.outcome, Outcome::step_too_small);
  EXPECT_NEAR(y[0], 1, 1e-3);
  EXPECT_LE(y[0], 1);

  const auto nothing = system_of<One>([](double, const One&, One& dydt) { dydt[0] = std::nan(""); });
  y[0] = 1;
  EXPECT_EQ(run(nothing, 10, y, {1e-6, 1e-6}).outcome, Outcome::step_too_small);
  EXPECT_EQ(y[0], 1);
}

TEST(AdamsPece, StopsWhereTheSolutionDoes) {
  const auto blow_up = system_of<One>([](double, const One& y, One& dydt) { dydt[0] = y[0] * y[0]; });
  One y(1.0);
  const auto end = run(blow_up, 2, y, {1e-8, 1e-8});
  EXPECT_TRUE(end.outcome == Outcome::step_too_small || end.outcome == Outcome::diverged);
  EXPECT_NEAR(end.t, 1, 1e-5);
}

TEST(AdamsPece, ServesTheShortestRunAndTheExtremeTolerances) {
  const Oscillator oscillator;
  State y(0.5, 1);
  const auto hair = run(oscillator, 1e-300, y, {1e-6, 1e-6});
  EXPECT_EQ(hair.outcome, Outcome::reached_end);
  EXPECT_EQ(hair.stats.steps, 10);  // the longest step is a tenth of the span

  State late(0.5, 1);
  const double t0 = 50, t_end = std::nextafter(t0, 51);
  EXPECT_EQ(integrate(PlaneAdams(), oscillator, {t0, t_end}, late, PlaneAdams::Control({1e-6, 1e-6})).outcome,
            Outcome::reached_end);

  const OscillatorReference exact(oscillator.parameters(), {0.5, 1}, 100);
  State fine(0.5, 1), coarse(0.5, 1);
  EXPECT_EQ(run(oscillator, 100, fine, {1e-15, 1e-15}).outcome, Outcome::reached_end);
  EXPECT_LT((fine - exact.at(100)).norm(), 1e-12);
  EXPECT_EQ(run(oscillator, 100, coarse, {1, 1}).outcome, Outcome::reached_end);
  EXPECT_TRUE(coarse.allFinite());
}

TEST(AdamsPece, KeepsToTheLargestAndTheFirstStepItIsGiven) {
  State y(0.5, 1);
  double first = 0, largest = 0;
  integrate(PlaneAdams(), Oscillator(), {0, 100}, y,
            PlaneAdams::Control({.rtol = 1e-4, .atol = 1e-4, .h_first = 1e-4, .h_max = 0.2}),
            [&](auto& view) {
              if (first == 0) first = view.h();
              largest = std::max(largest, view.h());
            });
  EXPECT_EQ(first, 1e-4);
  EXPECT_LE(largest, 0.2 * 1.01);
  EXPECT_GT(largest, 0.1);
}

TEST(AdamsPece, TellsWhenAttemptsRunOut) {
  State y(0.5, 1);
  const auto end = run(Oscillator(), 100, y, {1e-6, 1e-6}, 10);
  EXPECT_EQ(end.outcome, Outcome::too_many_steps);
}

}  // namespace
}  // namespace hmax
