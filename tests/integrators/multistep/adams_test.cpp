/// Adams methods at fixed step.
#include "integrators/multistep/adams.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "integrators/control.hpp"
#include "integrators/integrate.hpp"
#include "integrators/stats.hpp"
#include "problems/oscillator/oscillator_reference.hpp"
#include "tests/integrators/methods.hpp"
#include "tests/integrators/rejected_attempts.hpp"

namespace hmax {
namespace {

using State = Eigen::Vector2d;
static_assert(Stepper<Adams<State>, Pendulum<State>>);

struct Case {
  AdamsMode mode;
  int k;
};
void PrintTo(const Case& c, std::ostream* out) { *out << static_cast<int>(c.mode) << ' ' << c.k; }

std::string name_of(const testing::TestParamInfo<Case>& info) {
  const auto& [mode, k] = info.param;
  return (mode == AdamsMode::bashforth ? "adams_bashforth_"
          : mode == AdamsMode::pece    ? "abm_pece_"
                                       : "abm_pec_") +
         std::to_string(k);
}

std::vector<Case> every_case() {
  std::vector<Case> cases;
  for (const AdamsMode mode : {AdamsMode::bashforth, AdamsMode::pece, AdamsMode::pec})
    for (int k = 1; k <= 6; ++k) cases.push_back({mode, k});
  return cases;
}

struct AdamsOfOrder : testing::TestWithParam<Case> {
  template <class S = State>
  static Adams<S> stepper() {
    return Adams<S>(GetParam().mode, GetParam().k);
  }
  static int k() { return GetParam().k; }
  static AdamsMode mode() { return GetParam().mode; }
};
INSTANTIATE_TEST_SUITE_P(Every, AdamsOfOrder, testing::ValuesIn(every_case()), name_of);

template <std::size_t N>
std::array<double, N> values_of(const std::array<long double, N>& differences, double denominator) {
  std::array<long double, N> values{};
  std::array<double, N> numerators{};
  adams::weights_of_values<long double>(differences, values);
  for (std::size_t i = 0; i < N; ++i) numerators[i] = static_cast<double>(values[i] * denominator);
  return numerators;
}

TEST(AdamsCoefficients, AreThePublishedFractions) {
  // [hairer1993solving], tables III.1.1 and III.1.2 and equations (1.5), (1.9).
  const std::array<double, 6> four{55, -59, 37, -9}, moulton_four{9, 19, -5, 1};
  const auto bashforth = values_of(adams::gamma<4>(), 24), moulton = values_of(adams::gamma_star<4>(), 24);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(bashforth[i], four[i], 1e-14);
    EXPECT_NEAR(moulton[i], moulton_four[i], 1e-14);
  }
  constexpr auto gamma = adams::gamma<9>();
  constexpr auto gamma_star = adams::gamma_star<9>();
  EXPECT_NEAR(static_cast<double>(gamma[6]), 19087.0 / 60480, 1e-16);
  EXPECT_NEAR(static_cast<double>(gamma[8]), 1070017.0 / 3628800, 1e-16);
  EXPECT_NEAR(static_cast<double>(gamma_star[5]), -3.0 / 160, 1e-17);
  EXPECT_NEAR(static_cast<double>(gamma_star[8]), -33953.0 / 3628800, 1e-17);
}

TEST_P(AdamsOfOrder, IsExactOnPolynomialsWithItsStartItsShorterLastStepAndItsOutput) {
  using One = Eigen::Matrix<double, 1, 1>;
  const auto system =
      system_of<One>([](double t, const One&, One& dydt) { dydt[0] = k() * std::pow(t, k() - 1); });
  One y(0.0), between(0.0);
  double worst = 0;
  const auto end = integrate(stepper<One>(), system, {0, 1.02}, y, FixedStep<double>(0.1), [&](auto& view) {
    for (const double theta : {0.0, 0.3, 0.8, 0.9999999}) {
      const double t = view.t0() + theta * view.h();
      view.at(t, between);
      worst = std::max(worst, std::abs(between[0] - std::pow(t, k())));
    }
  });
  EXPECT_EQ(end.stats.steps, 11);
  EXPECT_NEAR(y[0], std::pow(1.02, k()), 3e-15);
  EXPECT_LT(worst, 1e-13);  // the interpolant of the starting steps rounds most
}

TEST_P(AdamsOfOrder, HasItsOrderAtTheEndAndBetween) {
  using Extended = BasicOscillator<long double>;
  const Extended system;
  const OscillatorReference exact({}, {0.5, 1}, 10);
  const auto errors = [&](long double h) {
    Extended::State y(0.5L, 1), middle;
    long double between = 0;
    // 9.99 is no multiple of any of the steps.
    integrate(stepper<Extended::State>(), system, {0, 9.99L}, y, FixedStep<long double>(h), [&](auto& view) {
      const long double t = view.t0() + 0.4L * view.h();
      view.at(t, middle);
      between = std::max(between, (middle - exact.extended_at(t)).norm());
    });
    return std::pair{(y - exact.extended_at(9.99L)).norm(), between};
  };
  const auto coarse = errors(0.01L), fine = errors(0.005L);
  EXPECT_NEAR(std::log2(static_cast<double>(coarse.first / fine.first)), k(), 0.2);
  EXPECT_NEAR(std::log2(static_cast<double>(coarse.second / fine.second)), k(), 0.2);
}

TEST_P(AdamsOfOrder, LeavesNoTraceOfARejectedAttempt) {
  expect_no_trace_of_rejected_attempts(stepper(), Pendulum<State>(), State(0.3, 0.5), {0.37}, 9);
}

TEST_P(AdamsOfOrder, EvaluatesAsOftenAsItsNameSays) {
  Stats stats;
  const Pendulum<State> pendulum;
  const Counted system(pendulum, stats);
  State y(0.3, 0.5);
  State between;
  integrate(stepper(), system, {0, 2}, y, FixedStep<double>(0.1), [&](auto& view) {
    if (view.t0() > 0.75) view.at(view.t0() + 0.05, between);
  });
  // f(t_0, y_0) is the first; a starting step of order 8 takes 11 more and gives the slope at its end.
  const int start = k() - 1, steps = 20 - start;
  const int per_step = mode() == AdamsMode::pece ? 2 : 1;
  const int first = mode() == AdamsMode::bashforth && start == 0 ? 0 : 1;
  const int last_not_needed = mode() == AdamsMode::pec || first == 0 ? 0 : 1;
  EXPECT_EQ(stats.rhs, first + 12 * start + per_step * steps - last_not_needed);
}

TEST_P(AdamsOfOrder, OfADynamicStateStepsAsOfASmallOne) {
  const Pendulum<State> small;
  const Pendulum<Eigen::VectorXd> large;
  State y(0.3, 0.5), between = y, last = y;
  Eigen::VectorXd z = y, z_between = y, z_last = y;
  const auto look = [](auto& at, auto& keep) {
    return [&](auto& view) { view.at(view.t0() + 0.04, at), keep = at; };
  };
  integrate(stepper(), small, {0, 1.03}, y, FixedStep<double>(0.1), look(between, last));
  integrate(stepper<Eigen::VectorXd>(), large, {0, 1.03}, z, FixedStep<double>(0.1), look(z_between, z_last));
  EXPECT_LT((z - y).norm(), 1e-14);
  EXPECT_LT((z_last - last).norm(), 1e-14);
}

TEST_P(AdamsOfOrder, DivergesIntoAnOutcome) {
  const auto blow_up =
      system_of<State>([](double, const State& y, State& dydt) { dydt = y.cwiseProduct(y); });
  State y(1, 1);
  const auto end = integrate(stepper(), blow_up, {0, 30}, y, FixedStep<double>(0.1));
  EXPECT_EQ(end.outcome, Outcome::diverged);
  EXPECT_TRUE(y.allFinite());
}

TEST(Adams, OfOrderOneIsEulersMethod) {
  const Pendulum<State> system;
  State y(0.3, 0.5), euler(0.3, 0.5);
  integrate(Adams<State>(AdamsMode::bashforth, 1), system, {0, 1.03}, y, FixedStep<double>(0.1));
  integrate(Rk<tableaux::ExplicitEuler, State>(), system, {0, 1.03}, euler, FixedStep<double>(0.1));
  EXPECT_EQ(y, euler);
}

/// |y| after many steps of y' = -y with h past the start, relative to the start.
double remains(AdamsMode mode, int k, double h) {
  using One = Eigen::Matrix<double, 1, 1>;
  const Decay<One> decay{One(-1.0)};
  One y(1.0);
  integrate(Adams<One>(mode, k), decay, {0, 4000 * h}, y, FixedStep<double>(h));
  return std::abs(y[0]);
}

TEST(Adams, IsStableOnTheRealAxisUpToItsPublishedLimit) {
  struct Limit {
    AdamsMode mode;
    int k;
    double h;
  };
  using enum AdamsMode;
  for (const auto& [mode, k, h] : {Limit{bashforth, 2, 1},
                                   {bashforth, 3, 6.0 / 11},
                                   {bashforth, 4, 0.3},
                                   {pece, 2, 2},
                                   {pece, 3, 1.728783568074},
                                   {pece, 4, 1.284816263107}}) {
    EXPECT_LT(remains(mode, k, 0.99 * h), 1e-6) << k;
    EXPECT_GT(remains(mode, k, 1.01 * h), 1e6) << k;
  }
}

/// One step past the start of y' = lambda y, against the formula written out with the published fractions.
TEST(Adams, StepsByTheFormulasOfTheBook) {
  using Scalar = std::complex<double>;
  using One = Eigen::Matrix<Scalar, 1, 1>;
  const double h = 0.1;
  for (const Scalar lambda : {Scalar(-2, 1), Scalar(0.3, -4), Scalar(-7, 0.5)}) {
    const Decay<One> decay{One(lambda)};
    for (const AdamsMode mode : {AdamsMode::bashforth, AdamsMode::pece, AdamsMode::pec}) {
      Adams<One> adams(mode, 3);
      std::vector<Scalar> y{1.0}, f;
      adams.init(decay, 0, One(y[0]));
      for (int n = 0; n < 6; ++n) {
        One y_new;
        adams.attempt(decay, h * n, One(y.back()), h, y_new);
        if (mode != AdamsMode::pec || n < 3) f.push_back(lambda * y.back());
        if (n >= 2) {
          const auto m = f.size() - 1;
          const Scalar p = y.back() + h / 12 * (23.0 * f[m] - 16.0 * f[m - 1] + 5.0 * f[m - 2]);
          const Scalar c = y.back() + h / 12 * (5.0 * lambda * p + 8.0 * f[m] - f[m - 1]);
          EXPECT_LT(std::abs(y_new[0] - (mode == AdamsMode::bashforth ? p : c)), 1e-14 * (1 + std::abs(c)));
          if (mode == AdamsMode::pec) f.push_back(lambda * p);
        }
        adams.accept(y_new);
        y.push_back(y_new[0]);
      }
    }
  }
}

/// y' = cos t split into its time part, which counts.
struct CountingCosine {
  using State = Eigen::Matrix<double, 1, 1>;
  int* calls;
  static Eigen::Index dim() { return 1; }
  double at(double t) const {
    ++*calls;
    return std::cos(t);
  }
  static void rhs_at(double g, const State&, State& dydt) { dydt[0] = g; }
  void rhs(double t, const State& y, State& dydt) const { rhs_at(at(t), y, dydt); }
};

TEST(Adams, PeceEvaluatesTheTimePartOnceAStep) {
  int calls = 0;
  CountingCosine::State y(0.0);
  integrate(Adams<CountingCosine::State>(AdamsMode::pece, 1), CountingCosine{&calls}, {0, 10}, y,
            FixedStep<double>(0.1));
  EXPECT_EQ(calls, 101);
}

}  // namespace
}  // namespace hmax
