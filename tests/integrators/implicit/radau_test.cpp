/// Radau IIA where simplified Newton iterations do not solve its stage equations.
#include "integrators/implicit/radau.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// x'' = s^2 (-x - k x^3) in y = (x, x' / s): the solution is a function of s t.
struct HardSpring {
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  double k, s;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& dydt) const {
    dydt[0] = s * y[1];
    dydt[1] = s * (-y[0] - k * y[0] * y[0] * y[0]);
  }
  void jacobian(double, const State& y, Jacobian& J) const {
    J.resize(2, 2);
    J << 0, s, -s * (1 + 3 * k * y[0] * y[0]), 0;
  }
};

TEST(Radau, StagesOfTheLastResortAreSolvedAsWellInShortSteps) {
  // Both springs make the same step, s h = 1, and powers of two change no digit.
  const auto step = [](double k, double s, const Eigen::VectorXd& y) {
    const HardSpring spring{k, s};
    RadauIIA5<Eigen::VectorXd, Eigen::MatrixXd> radau;
    Eigen::VectorXd y_new = y;
    radau.init(spring, 0, y);
    EXPECT_EQ(radau.attempt(spring, 0, y, 1 / s, y_new), StepStatus::ok) << s;
    EXPECT_GT(radau.work().newton, 110) << "continuation was enough";
    return y_new;
  };
  struct Start {
    double k, x, v;
  };
  for (const auto& [k, x, v] : {Start{1089.92, 0.906723, -49.74085}, Start{26.37798, 2.651022, -8.123143},
                                Start{1.965426, -0.1845689, -99.50115}}) {
    const Eigen::VectorXd y = Eigen::Vector2d(x, v), slow = step(k, 1, y);
    for (const int power : {20, 33, -20}) {
      const Eigen::VectorXd y_new = step(k, std::ldexp(1.0, power), y);
      EXPECT_LT((y_new - slow).norm(), 1e-12 * slow.norm()) << k << " 2^" << power;
    }
  }
}

}  // namespace
}  // namespace hmax
