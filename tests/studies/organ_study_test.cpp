#include "studies/organ_study.hpp"

#include <gtest/gtest.h>

#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"

namespace hmax {
namespace {

StaticModel pressed_phantom() {
  return static_model(
      make_problem(tissue_id("fem_green", "phantom", "press"), {.parameters = {{"force", 0.2}}}), 1);
}

TEST(TurnedBodies, HaveEnergyWithSmallStrainAlone) {
  for (const TurnedBody& body : turned_bodies("phantom")) {
    EXPECT_EQ(body.angle.back(), 90);
    if (body.model != "fem_cauchy") {
      for (const double energy : body.energy) EXPECT_NEAR(energy, 0, 1e-10) << body.model;
      continue;
    }
    // At 90 degrees two strains are -1: mu (1 + 1) + lambda (1 + 1)^2 / 2 with nu = 0.3.
    const double mu = 1 / 2.6, lambda = 0.3 / (1.3 * 0.4);
    EXPECT_NEAR(body.energy.back(), 2 * mu + 2 * lambda, 1e-9);
  }
}

TEST(PressedVolumes, AreKeptTheBetterTheCloserPoissonsRatioIsToOneHalf) {
  const std::vector<PressedVolume> rows = pressed_volumes("phantom", 0.004);
  ASSERT_EQ(rows.size(), 4U);
  for (const PressedVolume& row : rows) EXPECT_NEAR(row.displacement, 0.004, 1e-5) << row.model << row.nu;
  EXPECT_GT(rows[1].lost, rows[2].lost);
  EXPECT_GT(rows[2].lost, rows[3].lost);
  EXPECT_GT(rows[3].lost, 0);
}

TEST(InnerTolerances, CostSweepsAndSaveIterationsOfNewtonsMethod) {
  const std::vector<InnerTolerance> rows = inner_tolerances(pressed_phantom(), 1.4);
  ASSERT_EQ(rows.size(), 10U);
  for (const InnerTolerance& row : rows) EXPECT_TRUE(row.converged) << row.tolerance;
  const auto &modified = rows[1], &modified_tight = rows[4], &newton = rows[6], &newton_tight = rows[9];
  EXPECT_GE(modified_tight.iterations + 2,
            modified.iterations);  // a solution that is far better saves next to none
  EXPECT_GT(modified_tight.sweeps, 2 * modified.sweeps);
  EXPECT_LT(newton_tight.iterations, newton.iterations);
}

/// 3 + 2 iterations of 5 and 7 sweeps: seconds = 4 iterations + 2 sweeps by construction.
TEST(AccurateSolutions, TellWhenFewerIterationsPay) {
  const auto row = [](StaticMethod method, double tolerance, int iterations, std::int64_t sweeps) {
    return InnerTolerance{method,     tolerance, true,
                          iterations, sweeps,    4.0 * iterations + 2.0 * static_cast<double>(sweeps)};
  };
  const AccurateSolution found = accurate_solution(
      {row(StaticMethod::modified_newton, 0.1, 9, 1), row(StaticMethod::newton, 0.1, 9, 230),
       row(StaticMethod::newton, 1e-2, 5, 240), row(StaticMethod::newton, 1e-4, 4, 350)});
  EXPECT_NEAR(found.iteration, 2, 1e-9);
  EXPECT_NEAR(found.needed, (350.0 - 230) / (9 - 4), 1e-9);
}

TEST(LoadedIterations, GrowWithTheLoadAndMoreSoOfTheModifiedMethod) {
  const std::vector<LoadedIterations> all = loaded_iterations("phantom", "male_normal", {0.05, 0.4});
  ASSERT_EQ(all.size(), 2U);
  for (const LoadedIterations& at : all) EXPECT_GT(at.modified, at.newton);
  EXPECT_GT(all[1].modified * all[0].newton, all[0].modified * all[1].newton);
}

TEST(FrameBudgets, LeaveLessErrorWithMoreIterations) {
  const std::vector<FrameBudget> budgets = frame_budgets(pressed_phantom(), 30);
  ASSERT_EQ(budgets.size(), 3U);
  EXPECT_LT(budgets[1].error, 0.01 * budgets[0].error);
  EXPECT_LT(budgets[0].error, 0.1);
}

TEST(LinearSolutions, AreOfEveryDegreeOfFreedom) {
  const LinearSolutions found = linear_solutions(pressed_phantom());
  EXPECT_GT(found.dofs, 100);
  EXPECT_EQ(found.inverse_bytes, 8.0 * static_cast<double>(found.dofs) * static_cast<double>(found.dofs));
}

}  // namespace
}  // namespace hmax
