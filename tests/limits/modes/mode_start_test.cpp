#include "limits/modes/mode_start.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace hmax {
namespace {

TEST(StartFromMode, IsTheModeNearestToAnEigenvalueAndAHundredthOfEverythingElse) {
  // y' = k (second difference of y): lambda_j = -4 k sin^2(j pi / (2 (n + 1))), u_j = sin(j p pi / (n + 1)).
  constexpr Eigen::Index n = 40;
  constexpr double k = 100;
  Eigen::MatrixXd J = -2 * k * Eigen::MatrixXd::Identity(n, n);
  J.diagonal(1).setConstant(k);
  J.diagonal(-1).setConstant(k);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(n);
  Linearised near;
  near.point.model = {.t = 0, .y = rest, .J = [J] { return AnyMatrix(J); }};
  const auto eigenvalue = [&](Eigen::Index j) {
    return -4 * k * std::pow(std::sin(static_cast<double>(j) * std::numbers::pi / (2.0 * (n + 1))), 2);
  };
  for (const Eigen::Index j : {Eigen::Index(1), Eigen::Index(17), n}) {
    Eigen::VectorXd mode(n);
    for (Eigen::Index p = 0; p < n; ++p)
      mode[p] = std::sin(static_cast<double>(j * (p + 1)) * std::numbers::pi / (n + 1.0));
    mode.normalize();
    const ModeStart start = start_from_mode(near, rest, eigenvalue(j) * (1 + 1e-6), -eigenvalue(n));
    EXPECT_FALSE(start.defective) << j;
    EXPECT_EQ(start.rest, rest) << j;
    const double size = start.displacement.cwiseAbs().maxCoeff();
    const Eigen::VectorXd others = start.displacement - mode.dot(start.displacement) * mode;
    EXPECT_LT(others.cwiseAbs().maxCoeff(), 0.02 * size) << j;
    EXPECT_GT(others.cwiseAbs().maxCoeff(), 0.001 * size) << j;
  }
}

}  // namespace
}  // namespace hmax
