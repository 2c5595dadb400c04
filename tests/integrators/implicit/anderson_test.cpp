#include "integrators/implicit/anderson.hpp"

#include <array>

#include <gtest/gtest.h>

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// G(w) = M w + b with eigenvalues of M of up to 3: the plain iteration diverges, GMRES ends after n steps.
TEST(AndersonMixing, ConvergesOnALinearMapThatDivergesByItself) {
  const VectorXd diagonal = (VectorXd(6) << -3, -1.5, 0.2, 0.5, 2, 3).finished();
  MatrixXd M = diagonal.asDiagonal();
  M(0, 3) = 0.7;
  M(4, 1) = -0.4;
  const VectorXd b = VectorXd::LinSpaced(6, 1, 2);
  const VectorXd exact = (MatrixXd::Identity(6, 6) - M).partialPivLu().solve(b);
  std::array<VectorXd, 2> w{VectorXd::Zero(3), VectorXd::Zero(3)};
  AndersonMixing<VectorXd, 2> mixing;
  const auto together = [&] { return (VectorXd(6) << w[0], w[1]).finished(); };
  for (int k = 0; k < 12; ++k) {
    const VectorXd d = M * together() + b - together();
    mixing.step(w, {d.head(3), d.tail(3)});
  }
  EXPECT_LT((together() - exact).norm(), 1e-9 * exact.norm());
}

TEST(AndersonMixing, TakesThePlainStepWhereNothingIsRemembered) {
  std::array<VectorXd, 1> w{VectorXd::Ones(2)};
  AndersonMixing<VectorXd, 1> mixing;
  mixing.step(w, {VectorXd::Constant(2, 0.5)});
  EXPECT_EQ(w[0], VectorXd::Constant(2, 1.5));
  mixing.forget();
  mixing.step(w, {VectorXd::Constant(2, 0.25)});
  EXPECT_EQ(w[0], VectorXd::Constant(2, 1.75));
}

}  // namespace
}  // namespace hmax
