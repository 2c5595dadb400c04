#include "studies/organ_rates.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "bench/micro/plain_tissue.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {
namespace {

TEST(ModelCosts, HavePlainLoopsBesideTheKernels) {
  const std::vector<ModelCost> all = model_costs({"phantom"}, "male_normal");
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].model, "mass_spring");
  EXPECT_EQ(all[1].model, "fem_green");
  for (const ModelCost& cost : all) {
    EXPECT_GT(cost.force, 0);
    EXPECT_GT(cost.plain, 0);
    EXPECT_GT(cost.step, cost.force);
  }
}

/// The plain loops are the same forces, or their times would say nothing.
TEST(PlainForces, AreThoseOfTheBody) {
  const Problem problem = make_problem(tissue_id("fem_green", "phantom", "gravity"),
                                       {.material = "male_normal", .parameters = {{"g", 0}}});
  const TissueBody& body = *problem.body;
  const TissueMaterial& material = body.settings().materials.front();
  Eigen::VectorXd q(body.dofs());
  for (Eigen::Index i = 0; i < q.size(); ++i) q[i] = 1e-3 * std::sin(static_cast<double>(i));
  Eigen::VectorXd expected(q.size());
  body.force(0, q, Eigen::VectorXd::Zero(q.size()), expected);
  const Eigen::Matrix3Xd x = body.positions(0, q);
  Eigen::Matrix3Xd f = Eigen::Matrix3Xd::Zero(3, x.cols());
  plain::Green(body.mesh(), lame(material.young, material.poisson)).force(x.data(), f.data());
  Eigen::Index dof = 0;
  for (const TetMesh::Index point : body.free_points()) {
    EXPECT_LT((f.col(point) - expected.segment<3>(dof)).norm(), 1e-9 * expected.norm());
    dof += 3;
  }
}

TEST(ConstantJacobians, RunFurtherSpringsAt150Hz) {
  const std::vector<ConstantJacobian> all = constant_jacobians({"phantom"}, "male_normal");
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].springs, 230);
  EXPECT_GT(all[2].springs, 400);
  EXPECT_NEAR(all[2].asked, 150, 1e-9);
  for (const ConstantJacobian& each : all) EXPECT_TRUE(each.reached_end) << each.model;
}

}  // namespace
}  // namespace hmax
