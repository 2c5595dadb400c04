#include "studies/thigh/thigh_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

namespace hmax {
namespace {

const ThighLoad load{.point = 5};

const AnySystem& system_of(const Problem& problem) { return std::get<AnySystem>(problem.system); }

Eigen::VectorXd pressed(const Thigh& thigh) {
  return press(thigh, pressed_points(thigh, load.point, load.probe), std::array{load.depth}).front().u;
}

TEST(ThighMotion, IsInEquilibriumWhereItsLoadHoldsIt) {
  const Thigh thigh = true_thigh(4, 4);
  const Problem problem = moving_thigh(thigh, load);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(32), f(32);
  system_of(problem).rhs(0, y, f);
  EXPECT_EQ(f.norm(), 0);
  system_of(problem).rhs(2 * load.rise, y, f);
  const double unbalanced = f.norm();
  y.head(16) = pressed(thigh);
  system_of(problem).rhs(2 * load.rise, y, f);
  EXPECT_LT(f.norm(), 1e-9 * unbalanced);
}

TEST(ThighMotion, HasTheJacobianOfDifferences) {
  const Problem problem = moving_thigh(true_thigh(3, 3), {.point = 4});
  const AnySystem& system = system_of(problem);
  const Eigen::Index n = system.dim();
  Eigen::VectorXd y(n), more(n), less(n);
  for (Eigen::Index i = 0; i < n; ++i) y[i] = 0.01 * std::sin(static_cast<double>(i));
  Eigen::SparseMatrix<double> sparse;
  AnySystem::Jacobian J = sparse;
  system.jacobian(0.1, y, J);
  const Eigen::MatrixXd dense = std::visit([](const auto& held) { return Eigen::MatrixXd(held); }, J);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Eigen::VectorXd e = 1e-7 * Eigen::VectorXd::Unit(n, j);
    system.rhs(0.1, y + e, more);
    system.rhs(0.1, y - e, less);
    EXPECT_LT((dense.col(j) - (more - less) / 2e-7).norm(), 1e-6 * dense.norm()) << j;
  }
}

TEST(ThighLimits, OfExplicitEulerAreDampingOverTheSquareOfTheFrequency) {
  // |1 + h lambda| = 1 at h = damping / omega^2 for every mode that swings.
  const Thigh thigh = true_thigh(4, 4);
  const auto largest = [&](const Eigen::VectorXd& u) {
    const Eigen::MatrixXd K = thigh.stiffness(u);
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues().maxCoeff() / load.mass;
  };
  const auto limits = thigh_limits({"explicit_euler", "linearly_implicit_euler"}, thigh, load);
  const double at_rest = load.damping / largest(Eigen::VectorXd::Zero(16)),
               at_depth = load.damping / largest(pressed(thigh));
  EXPECT_NEAR(limits[0].h_rest, at_rest, 1e-9 * at_rest);
  EXPECT_NEAR(limits[0].h_pressed, at_depth, 1e-9 * at_depth);
  EXPECT_LT(limits[0].h_pressed, limits[0].h_rest);
  EXPECT_TRUE(std::isinf(limits[1].h_pressed));
}

TEST(ThighLimits, GrowWithTheMassUntilAStepIsStable) {
  const Thigh thigh = true_thigh(4, 4);
  constexpr double h = 0.01;
  ThighLoad heavy = load;
  heavy.mass = stable_mass("explicit_euler", thigh, load, h);
  EXPECT_GT(heavy.mass, load.mass);
  const double limit = thigh_limits({"explicit_euler"}, thigh, heavy).front().h_pressed;
  EXPECT_GE(limit, h);
  EXPECT_LT(limit, 1.02 * h);
  EXPECT_EQ(stable_mass("linearly_implicit_euler", thigh, load, h), load.mass);
}

TEST(ThighRuns, OfLinearlyImplicitEulerBearTenMillisecondsAndThoseOfExplicitEulerDoNot) {
  ThighLoad gentle = load;
  gentle.depth = 0.008;
  const auto runs = thigh_runs(true_thigh(4, 4), gentle);
  const ThighRun& reference = runs.front();
  EXPECT_TRUE(reference.reached_end);
  EXPECT_EQ(reference.error, 0);
  // The load holds the point at its depth, but for an overshoot, and lets it return.
  EXPECT_NEAR(*std::ranges::max_element(reference.u), gentle.depth, 0.1 * gentle.depth);
  EXPECT_LT(std::abs(reference.u.back()), 0.1 * gentle.depth);
  for (const ThighRun& run : runs) {
    if (run.method == "explicit_euler") {
      EXPECT_FALSE(run.reached_end);
      EXPECT_TRUE(std::isnan(run.error));
      continue;
    }
    EXPECT_TRUE(run.reached_end) << run.method;
    EXPECT_EQ(run.u.size(), reference.u.size()) << run.method;
    EXPECT_LT(run.error, 0.2) << run.method;
  }
  EXPECT_TRUE(runs[2].constant);
  EXPECT_FALSE(runs[1].constant);
}

TEST(ThighRuns, WithTheJacobianOfRestAreStableUpToTheDepthThatIsPredicted) {
  const Thigh thigh = true_thigh(4, 4);
  ThighLoad slow = load;
  slow.rise = 1;
  const double depth = constant_jacobian_depths(thigh, load, 0.01, 0.03)[load.point];
  ASSERT_TRUE(std::isfinite(depth));
  // Below it the held point comes to rest; beyond it jumps to and fro with every step.
  const auto jump = [&](double share) {
    slow.depth = share * depth;
    const ThighRun run = thigh_runs(thigh, slow)[2];
    return std::abs(run.u.at(297) - run.u.at(296)) / slow.depth;
  };
  EXPECT_LT(jump(0.97), 1e-9);
  EXPECT_GT(jump(1.05), 0.005);
}

TEST(ThighMotion, RefusesBadInput) {
  const Thigh thigh = true_thigh(2, 2);
  EXPECT_THROW(moving_thigh(thigh, {.mass = 0}), std::invalid_argument);
  EXPECT_THROW(moving_thigh(thigh, {.damping = -1}), std::invalid_argument);
  EXPECT_THROW(moving_thigh(thigh, {.depth = 0}), std::invalid_argument);
  EXPECT_THROW(moving_thigh(thigh, {.rise = std::numeric_limits<double>::quiet_NaN()}),
               std::invalid_argument);
  EXPECT_THROW(moving_thigh(thigh, {.point = 9}), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
