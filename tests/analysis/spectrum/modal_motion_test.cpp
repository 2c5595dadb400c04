#include "analysis/spectrum/modal_motion.hpp"

#include <gtest/gtest.h>

#include "integrators/implicit/radau.hpp"
#include "integrators/integrate.hpp"
#include "tests/integrators/motion.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

/// A linear chain with alpha M + beta K for its damping, and a constant force at every mass.
struct PulledChain {
  using State = VectorXd;
  Eigen::MatrixXd K, C;
  VectorXd m, f;

  PulledChain(double alpha, double beta, double tie) {
    const Chain<VectorXd> chain{5, 7, 0, 0, 0};
    m = chain.mass();
    chain.stiffness(0, VectorXd::Zero(5), VectorXd::Zero(5), K);
    K(0, 0) += tie;
    C = beta * K;
    C.diagonal() += alpha * m;
    f = VectorXd::LinSpaced(5, -1, 2);
  }
  [[nodiscard]] Eigen::Index dim() const { return 10; }
  void rhs(double, const State& y, State& dydt) const {
    dydt << y.tail(5), (f - K * y.head(5) - C * y.tail(5)).cwiseQuotient(m);
  }
};

TEST(ModalMotion, IsTheMotionThatIntegrationFinds) {
  // Damped and not, tied to the wall and free to drift away.
  for (const auto& [alpha, beta, tie] :
       {std::array{0.0, 0.0, 0.0}, {0.4, 0.0, 0.0}, {0.3, 0.1, 0.0}, {0.2, 0.01, -7.0}, {0.0, 0.0, -7.0}}) {
    const PulledChain chain(alpha, beta, tie);
    const VectorXd y0 = VectorXd::LinSpaced(10, -0.5, 0.5);
    const ModalMotion motion(mechanical_part(chain.m, chain.K, chain.C), chain.f, y0);
    EXPECT_LT((motion.at(0) - y0).norm(), 1e-13);
    VectorXd y = y0;
    const auto end = integrate(RadauIIA5<VectorXd, Eigen::MatrixXd>{}, chain, Span<double>{0, 3}, y,
                               FixedStep<double>(1.0 / 512));
    ASSERT_EQ(end.outcome, Outcome::reached_end);
    EXPECT_LT((motion.at(3) - y).norm(), 1e-9) << alpha << ' ' << beta << ' ' << tie;
  }
}

TEST(ModalMotion, RefusesDampingThatCouplesTheModes) {
  const PulledChain chain(0, 0, 0);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(5, 5);
  C(1, 1) = 1;
  EXPECT_THROW(ModalMotion(mechanical_part(chain.m, chain.K, C), chain.f, VectorXd::Zero(10)),
               std::invalid_argument);
}

}  // namespace
}  // namespace hmax
