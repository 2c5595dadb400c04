#include "core/dense_solvers.hpp"

#include <gtest/gtest.h>

namespace hmax {
namespace {

using Eigen::MatrixXd;

TEST(ConditionOf, IsThatOfSingularValuesAtAnyScale) {
  // A rotation by 3-4-5 of diag(1000, 1).
  const MatrixXd A = (MatrixXd(2, 2) << 600, -0.8, 800, 0.6).finished();
  for (const double scale : {1.0, 1e160, 1e-170}) {
    EXPECT_NEAR(condition_of(scale * A), 1000, 1e-9);
    EXPECT_NEAR(condition_of(scale * MatrixXd::Identity(3, 3)), 1, 1e-14);
  }
}

TEST(ConditionOf, OfSingularMatricesIsHuge) {
  EXPECT_GT(condition_of(MatrixXd::Zero(2, 2)), 1e16);
  EXPECT_GT(condition_of(MatrixXd::Ones(2, 2)), 1e15);
  const MatrixXd A = (MatrixXd(3, 3) << 0.1, 0.7, 0.3, 0.3, 0.2, 0.6, 0.4, 0.9, 0.9).finished();
  EXPECT_GT(condition_of(A), 1e15);
}

TEST(LargestEigenvalueOf, IsTheOneFarthestToTheRight) {
  EXPECT_NEAR(largest_eigenvalue_of((MatrixXd(2, 2) << -2, 1, 1, -2).finished()), -1, 1e-14);
}

}  // namespace
}  // namespace hmax
