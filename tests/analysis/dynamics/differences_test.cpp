#include "analysis/dynamics/differences.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

TEST(Differences, AreSharpToRoundingOnSmoothFunctions) {
  const VectorFunction g = [](const VectorXd& y) -> VectorXd {
    return Vector2d(std::sin(y(0)) * y(1), std::exp(0.3 * y(0)) + y(1) * y(1) * y(1));
  };
  for (const double scale : {0.5, 3.0, 20.0}) {
    const Vector2d y(0.7, -1.2);
    const MatrixXd J = differenced_jacobian(g, y, Vector2d(scale, scale));
    EXPECT_NEAR(J(0, 0), std::cos(0.7) * -1.2, 2e-12) << scale;
    EXPECT_NEAR(J(0, 1), std::sin(0.7), 2e-12) << scale;
    EXPECT_NEAR(J(1, 0), 0.3 * std::exp(0.21), 2e-12) << scale;
    EXPECT_NEAR(J(1, 1), 3 * 1.44, 2e-12) << scale;
  }
}

TEST(Differences, SeeAFastFunctionThroughAWideScale) {
  const VectorFunction g = [](const VectorXd& y) -> VectorXd {
    return VectorXd::Constant(1, std::sin(100 * y(0)));
  };
  EXPECT_NEAR(differenced_jacobian(g, VectorXd::Constant(1, 0.01), VectorXd::Ones(1))(0, 0),
              100 * std::cos(1.0), 1e-8);
}

TEST(Differences, StayWithinTheDomain) {
  const VectorFunction g = [](const VectorXd& y) -> VectorXd {
    return VectorXd::Constant(1, std::sqrt(y(0)));
  };
  // The first increments lead below zero.
  EXPECT_NEAR(differenced_jacobian(g, VectorXd::Constant(1, 0.01), VectorXd::Ones(1))(0, 0), 5, 1e-6);
  EXPECT_TRUE(std::isnan(differenced_jacobian(g, VectorXd::Constant(1, -1), VectorXd::Ones(1))(0, 0)));
}

TEST(Differences, HaveAsManyRowsAsTheFunction) {
  const VectorFunction g = [](const VectorXd& y) -> VectorXd { return VectorXd::Constant(3, y.sum()); };
  const MatrixXd J = differenced_jacobian(g, Vector2d(1, 2), Vector2d(1, 1));
  ASSERT_EQ(J.rows(), 3);
  ASSERT_EQ(J.cols(), 2);
  EXPECT_TRUE(J.isOnes(1e-12));
}

}  // namespace
}  // namespace hmax
