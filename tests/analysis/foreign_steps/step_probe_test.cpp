/// Limits of lattices of more numbers than all eigenvalues are computed of, against dense eigenvalues of
/// their step.
#include "analysis/foreign_steps/step_probe.hpp"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/analysis/foreign_steps/mapped_stepper.hpp"
#include "tests/analysis/foreign_steps/random_lattice.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

std::string status_of(const ProbedLimit& found) {
  std::string all;
  for (const std::string& remark : found.status) all += remark + "; ";
  return all;
}

struct Judged {
  double exact = 0, least = 0, most = 0;
  ProbedLimit found;
  std::int64_t steps = 0;

  [[nodiscard]] bool is_right() const {
    if (std::isinf(exact))
      return std::isinf(found.h_max) && std::isinf(found.observed) && !found.contradiction;
    return std::abs(found.h_max / exact - 1) < 2e-3 && std::abs(found.observed / exact - 1) < 0.05 &&
           !found.contradiction;
  }
};

/// @param random  of the range of step sizes
Judged judged(const Lattice& lattice, std::mt19937_64& random, double seconds_a_run) {
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution(from, to)(random);
  };
  const Eigen::VectorXd w2 = lattice.squared_frequencies();
  const double top = std::sqrt(w2.maxCoeff());
  Judged judged;
  judged.exact = lattice.limit(w2, 1e-4 / top, 1e3 / top);
  const double about = std::isinf(judged.exact) ? 2 / top : judged.exact;
  judged.least = about / std::pow(10, uniform(0.5, 2));
  judged.most = about * std::pow(10, uniform(0.3, 1));
  LatticeStepper engine(lattice);
  judged.found = probe_steps(engine, {.h0 = judged.least, .h1 = judged.most, .seconds_a_run = seconds_a_run});
  judged.steps = engine.steps;
  return judged;
}

TEST(RandomLattice, ItsModesAreThoseOfTheMatrixOfItsStep) {
  std::mt19937_64 random(1);
  for (const Scheme scheme :
       {Scheme::symplectic_euler, Scheme::explicit_euler, Scheme::implicit_euler, Scheme::newmark})
    for (const LatticeSupport support :
         {LatticeSupport::free, LatticeSupport::held, LatticeSupport::touching}) {
      const Lattice lattice = random_lattice(random, support, scheme, 60);
      const Eigen::VectorXd w2 = lattice.squared_frequencies();
      const double h = 2.5 / std::sqrt(w2.maxCoeff());
      double by_modes = 0;
      for (const double each : w2) by_modes = std::max(by_modes, Lattice::radius(lattice.block(each, h)));
      const double dense = dense_eigenvalues(lattice.step_matrix(h)).cwiseAbs().maxCoeff();
      EXPECT_NEAR(by_modes, dense, 1e-6) << lattice.name();
      // And the matrix is that of the step.
      LatticeStepper engine(lattice);
      engine.save(0);
      const Eigen::VectorXd y = engine.state();
      Eigen::VectorXd v = Eigen::VectorXd::Random(y.size()) * 1e-7 * y.cwiseAbs().maxCoeff();
      const auto is_held = [&](Eigen::Index i) {
        return lattice.held[static_cast<std::size_t>(i % (y.size() / 2) / 3)];
      };
      for (Eigen::Index i = 0; i < y.size(); ++i)
        if (is_held(i)) v[i] = 0;
      const Eigen::VectorXd moved = engine.after(0, y + v, h, 1) - engine.after(0, y - v, h, 1);
      const Eigen::VectorXd expected = 2 * lattice.step_matrix(h) * v;
      EXPECT_LT((moved - expected).norm(), 1e-5 * expected.norm()) << lattice.name();
    }
}

TEST(StepProbe, BodiesOfMoreThan300NumbersHaveTheirLimits) {
  std::mt19937_64 random(36);
  const auto expect_right = [&](LatticeSupport support, Scheme scheme, double numbers) {
    const Lattice lattice = random_lattice(random, support, scheme, numbers);
    // Runs that a time limits are shorter on a slow machine, and show less.
    const Judged found = judged(lattice, random, std::numeric_limits<double>::infinity());
    EXPECT_TRUE(found.is_right()) << lattice.name() << ", " << found.found.dim << " numbers: h_max "
                                  << found.found.h_max << ", observed " << found.found.observed << ", right "
                                  << found.exact << "; " << status_of(found.found);
  };
  expect_right(LatticeSupport::free, Scheme::symplectic_euler, 384);
  expect_right(LatticeSupport::touching, Scheme::symplectic_euler, 330);
  expect_right(LatticeSupport::free, Scheme::explicit_euler, 384);
  expect_right(LatticeSupport::held, Scheme::symplectic_euler, 400);
  expect_right(LatticeSupport::free, Scheme::newmark, 330);
  expect_right(LatticeSupport::free, Scheme::implicit_euler, 330);
}

TEST(StepProbe, RoundingOfManyNumbersIsNoJump) {
  // The 21st and the 54th of the lattices below.
  for (const auto& [seed, scheme] :
       {std::pair(20382, Scheme::implicit_euler), {20415, Scheme::explicit_euler}}) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const double numbers = 48 * std::pow(3000.0 / 48, std::uniform_real_distribution(0.0, 1.0)(random));
    const Lattice lattice = random_lattice(random, LatticeSupport::free, scheme, numbers);
    LatticeStepper engine(lattice);
    const ProbedLimit found = probe_steps(engine, {.h0 = 1e-6, .h1 = 1e-5, .rows = 2, .observe = false});
    EXPECT_EQ(found.smoothness, StepSmoothness::smooth) << status_of(found);
  }
}

/// Runge-Kutta steps of x'' + c x' + 100 x = 0 of order 1 or 2, whose modulus is 1 + (10 h)^2 / 2 or
/// 1 + (10 h)^4 / 8 without damping.
template <int order, int micro_c>
Eigen::VectorXd oscillating(const Eigen::VectorXd& y, double h) {
  const auto rate = [](const Eigen::VectorXd& of) {
    return Eigen::Vector2d(of[1], -100 * of[0] - 1e-6 * micro_c * of[1]);
  };
  return y + h * rate(order == 1 ? y : Eigen::VectorXd(y + 0.5 * h * rate(y)));
}

TEST(StepProbe, GrowthThatFallsWithThePowerOfAMethodHasNoLimit) {
  for (const auto& [step, power] : {std::pair(&oscillating<1, 0>, "h^2"), {&oscillating<2, 0>, "h^4"}})
    for (const double h0 : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
      Mapped engine(step, Eigen::VectorXd::Zero(2));
      const ProbedLimit found = probe_steps(engine, {.h0 = h0, .h1 = 1});
      EXPECT_TRUE(std::isnan(found.h_max)) << found.h_max;
      EXPECT_TRUE(says(status_of(found), std::string("no step size is stable: growth falls as ") + power));
      EXPECT_FALSE(found.contradiction) << status_of(found);
    }
}

TEST(StepProbe, ASmallLimitIsOne) {
  // c / 100
  Mapped engine(oscillating<1, 20'000>, Eigen::VectorXd::Zero(2));
  EXPECT_NEAR(probe_steps(engine, {.h0 = 1e-5, .h1 = 1, .observe = false}).h_max, 2e-4, 2e-7);
  const std::string status = status_of(probe_steps(engine, {.h0 = 1e-2, .h1 = 1, .observe = false}));
  EXPECT_TRUE(says(status, "motions grow at h0 already; take an h0 of 0.00016 s"));
}

/// Explicit Euler of y' = -y^3, and symplectic Euler of a ball above an elastic floor.
Eigen::VectorXd slowing(const Eigen::VectorXd& y, double h) { return y.array() - h * y.array().cube(); }
Eigen::VectorXd falling(const Eigen::VectorXd& y, double h) {
  const double v = y[1] - h * (9.81 + (y[0] < 0 ? 1e4 * y[0] : 0));
  return Eigen::Vector2d(y[0] + h * v, v);
}

TEST(StepProbe, RunsThatLeaveAStateContradictNothing) {
  Mapped engine(slowing, Eigen::VectorXd::Ones(1));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-3, .h1 = 1.9});
  EXPECT_EQ(found.state, ProbedState::initial);
  EXPECT_NEAR(found.h_max, 2.0 / 3, 1e-4);
  EXPECT_FALSE(found.contradiction);
  EXPECT_TRUE(says(status_of(found), "runs leave this state, and do not grow up to 1.9 s"));
  Mapped ball(falling, Eigen::Vector2d(1, 0));
  const ProbedLimit above = probe_steps(ball, {.h0 = 1e-4, .h1 = 0.03});
  EXPECT_FALSE(above.contradiction);
  EXPECT_TRUE(says(status_of(above), "runs leave this state, and grow from"));
  EXPECT_TRUE(std::isinf(above.h_max));
  EXPECT_LT(above.limit(), 0.03);
}

/// Implicit Euler of x'' + 0.3 x' + 7.3 x = 0.
Eigen::VectorXd swinging(const Eigen::VectorXd& y, double h) {
  const double v = (y[1] - 7.3 * h * y[0]) / (1 + 0.3 * h + 7.3 * h * h);
  return Eigen::Vector2d(y[0] + h * v, v);
}

TEST(StepProbe, RestAtZeroIsOneUpToRounding) {
  Mapped engine(swinging, Eigen::Vector2d(0.7, 0.2));
  for (const StepSpectrum& row : probe_steps(engine, {.h0 = 1e-3, .h1 = 1, .observe = false}).rows)
    EXPECT_EQ(row.settled_moves, 0) << row.h;
}

/// Numbers that decay at a random rate.
Eigen::VectorXd shaking(const Eigen::VectorXd& y, double h) {
  static std::mt19937_64 random(1);
  return y / (1 + h * std::uniform_real_distribution(1.0, 2.0)(random));
}

TEST(StepProbe, NoiseOfMotionsIsSeenAtRest) {
  Mapped engine(shaking, Eigen::VectorXd::Zero(2));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-2, .h1 = 0.1, .observe = false});
  EXPECT_TRUE(says(status_of(found), "steps are not reproducible"));
}

Eigen::VectorXd by_its_own_size(const Eigen::VectorXd& y, double) { return oscillating<1, 0>(y, 0.01); }
Eigen::VectorXd halving(const Eigen::VectorXd& y, double) { return y / 2; }

TEST(StepProbe, AStepThatIgnoresItsSizeIsRefused) {
  const std::string told = "the step does not depend on its size";
  for (const auto step : {by_its_own_size, halving}) {
    Mapped engine(step, Eigen::VectorXd::Zero(2));
    for (const std::optional<double> motion : {std::optional<double>(), std::optional<double>(2)}) {
      const ProbeSettings settings{.h0 = 1e-3, .h1 = 1, .motion = motion, .observe = false};
      EXPECT_TRUE(says(error_of<InputError>([&] { probe_steps(engine, settings); }), told));
      EXPECT_EQ(engine.state().norm(), 0);
    }
    EXPECT_TRUE(says(error_of<InputError>([&] { compare_steps(engine, {.h0 = 1e-3, .h1 = 1}); }), told));
  }
  Mapped one(halving, Eigen::VectorXd::Zero(2));
  EXPECT_NO_THROW(probe_steps(one, {.h0 = 1e-2, .h1 = 1e-2, .observe = false}));
}

/// Free bodies, held ones and bodies on a floor, of 48 to 3,000 numbers, with runs as long as those of `hmax
/// probe`: shorter ones do not show growth of some 1e-4 a step. Takes an hour of an idle core:
/// test_analysis --gtest_also_run_disabled_tests --gtest_filter='*TwoHundredRandomLattices'
TEST(StepProbe, DISABLED_TwoHundredRandomLattices) {
  constexpr std::uint64_t seed = 20361;
  int wrong = 0, remarked = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    std::mt19937_64 random(seed + i);
    const auto support = static_cast<LatticeSupport>(i % 3);
    const auto scheme = static_cast<Scheme>(std::array{0, 0, 1, 1, 3, 0, 1, 2}[i / 3 % 8]);
    const double numbers = 48 * std::pow(3000.0 / 48, std::uniform_real_distribution(0.0, 1.0)(random));
    const Lattice lattice = random_lattice(random, support, scheme, numbers);
    const std::clock_t begin = std::clock();
    const Judged found = judged(lattice, random, ProbeSettings{}.seconds_a_run);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    wrong += !found.is_right();
    remarked += !found.found.status.empty();
    std::printf("%3d %-26s %5d numbers  exact %-11.6g h_max %-11.6g observed %-11.6g %s %5.1f s  %s\n",
                static_cast<int>(i), lattice.name().c_str(), static_cast<int>(found.found.dim), found.exact,
                found.found.h_max, found.found.observed, found.is_right() ? "right" : "WRONG", seconds,
                status_of(found.found).c_str());
    std::fflush(stdout);
  }
  std::printf("%d wrong, %d with a remark\n", wrong, remarked);
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace hmax
