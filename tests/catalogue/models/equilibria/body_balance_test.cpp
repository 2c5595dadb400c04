#include "catalogue/models/equilibria/body_balance.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

/// A beam that is pressed beyond the load at which it buckles: one equilibrium is left, whose stiffness has a
/// negative eigenvalue.
TEST(BodyBalance, FindsTheUnstableEquilibriumWhereThereIsNoOther) {
  const Problem beam =
      make_problem("fem_green/press@beam:n=2", {.material = {}, .parameters = {{"force", 0.46}}, .y0 = {}});
  const StaticSolution found = found_equilibrium(beam, 1, {}, [] { return 0.0; });
  EXPECT_FALSE(found.converged);
  EXPECT_TRUE(found.unstable);
  EXPECT_EQ(outcome_of(beam, found), "buckles");
  const StaticModel model = static_model(beam, 1);
  VectorXd left, load;
  model.force(found.q, left);
  model.force(VectorXd::Zero(model.dofs), load);
  EXPECT_LT(left.norm(), 1e-8 * load.norm());
  StaticModel::Matrix K;
  model.stiffness(found.q, K);
  EXPECT_LT(Eigen::MatrixXd(K).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0);
  // Methods that stay on any equilibrium have none to look for.
  EXPECT_FALSE(found_equilibrium(beam, 1, {.leave_saddles = false}, [] { return 0.0; }).unstable);
}

}  // namespace
}  // namespace hmax
