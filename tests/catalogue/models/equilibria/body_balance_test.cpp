#include "catalogue/models/equilibria/body_balance.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

/// A beam that is pressed beyond the load at which it buckles: one equilibrium is left, whose stiffness has a
/// negative eigenvalue.
TEST(BodyBalance, FindsTheUnstableEquilibriumWhereThereIsNoOther) {
  const Problem beam = make_problem("fem_green/press@beam:n=2", {.parameters = {{"force", 0.46}}});
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

/// Slender beams whose straight equilibrium is a saddle with a least eigenvalue far below the mean diagonal.
TEST(BodyBalance, FindsTheStableEquilibriumBesideASaddle) {
  for (const auto& [model, force] : {std::pair{"fem_green", 0.15},
                                     {"fem_green", 0.3},
                                     {"fem_corotational", 0.4},
                                     {"fem_neo_hookean", 0.15},
                                     {"fem_neo_hookean", 0.3},
                                     {"fem_neo_hookean", 0.6}}) {
    const Problem beam =
        make_problem(fmt::format("{}/press@beam:n=2,length=0.2,width=0.02,height=0.02", model),
                     {.parameters = {{"E", 5e4}, {"nu", 0.3}, {"force", force}}});
    const StaticSolution found = found_equilibrium(beam, 1, {}, [] { return 0.0; });
    ASSERT_TRUE(found.converged) << model << ' ' << force << found.note;
    EXPECT_LE(found.iterations, 200) << model << ' ' << force;
    const StaticModel balance = static_model(beam, 1);
    VectorXd left, load;
    balance.force(found.q, left);
    balance.force(VectorXd::Zero(balance.dofs), load);
    EXPECT_LT(left.norm(), 2e-9 * load.norm()) << model << ' ' << force;
    StaticModel::Matrix K;
    balance.stiffness(found.q, K);
    EXPECT_GT(Eigen::MatrixXd(K).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0)
        << model << ' ' << force;
  }
}

/// Full gravity on a ball so soft that elements at its support invert, though each pushes back.
TEST(BodyBalance, FindsTheEquilibriumBeyondInversionOfElementsThatPushBack) {
  const auto ball = [](const char* model) { return make_problem(model, {.parameters = {{"E", 1500}}}); };
  const auto no_clock = [] { return 0.0; };
  const Problem soft = ball("fem_neo_hookean@ball:n=4");
  const StaticSolution found = found_equilibrium(soft, 1, {}, no_clock);
  ASSERT_TRUE(found.barred);
  EXPECT_EQ(outcome_of(soft, found), "collapsed");
  const StaticSolution beyond = beyond_inversion(soft, 1, {}, no_clock, found);
  EXPECT_EQ(outcome_of(soft, beyond), "inverted");
  EXPECT_FALSE(beyond.converged);
  EXPECT_LT(soft.body->least_volume(0, beyond.q).first, 0);
  const StaticModel model = static_model(soft, 1);
  VectorXd left, load;
  model.force(beyond.q, left);
  model.force(VectorXd::Zero(model.dofs), load);
  EXPECT_LT(left.norm(), 1e-8 * load.norm());
  EXPECT_LT(model.energy(beyond.q), model.energy(found.q));
  EXPECT_GT(beyond.history.size(), found.history.size());
  // Green's strain has no force that restores them, so that nothing is beyond.
  const Problem green = ball("fem_green@ball:n=4");
  const StaticSolution crushed = found_equilibrium(green, 1, {}, no_clock);
  ASSERT_TRUE(crushed.barred);
  EXPECT_EQ(outcome_of(green, beyond_inversion(green, 1, {}, no_clock, crushed)), "collapsed");
}

}  // namespace
}  // namespace hmax
