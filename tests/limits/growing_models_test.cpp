/// Models of which a mode grows by itself: the limit of the others, and what the model does.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "limits/largest_stable_step.hpp"
#include "limits/predict.hpp"
#include "limits/verification.hpp"

namespace hmax {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double real_limit_of_rk4 = 2.785293563405282, imaginary_limit_of_rk4 = 2.8284271247461903;

/// y' = J y
struct First {
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  static constexpr bool autonomous = true;
  Eigen::MatrixXd J;
  [[nodiscard]] Eigen::Index dim() const { return J.rows(); }
  void rhs(double, const State& y, State& dydt) const { dydt = J * y; }
  void jacobian(double, const State&, Jacobian& out) const { out = J; }
};

TEST(GrowingModel, HasTheLimitOfItsOtherModesAndATimeScale) {
  First system{Eigen::Vector3d(1e-3, -14000, -1).asDiagonal()};
  const StepAnswer answer = largest_stable_step("rk4", system, Eigen::VectorXd::Zero(3));
  EXPECT_EQ(answer.bound, Bound::stability);
  EXPECT_NEAR(answer.h_max, real_limit_of_rk4 / 14000, 1e-12);
  ASSERT_TRUE(answer.limiting);
  EXPECT_NEAR(answer.limiting->lambda.real(), -14000, 1e-9);
  EXPECT_NE(answer.status.find("grows as exp(0.001 t)"), std::string::npos) << answer.status;
  EXPECT_NE(answer.status.find("doubling in 693.1 s"), std::string::npos) << answer.status;
}

TEST(GrowingModel, IsVerifiedWhereRunsDoNotSeeItsGrowth) {
  const auto row_of = [](double growth) {
    const Problem problem{.id = "first",
                          .y0 = Eigen::VectorXd::Zero(3),
                          .t_end = 1,
                          .system = AnySystem(First{Eigen::Vector3d(growth, -14000, -1).asDiagonal()})};
    const Linearised near = linearised(problem);
    Prediction row = predict(find_method("rk4"), near);
    verify(row, find_method("rk4"), problem, near);
    return row;
  };
  const Prediction slow = row_of(1e-3);
  ASSERT_TRUE(slow.observed);
  EXPECT_TRUE(slow.observed->confirms()) << slow.note;
  const Prediction fast = row_of(100);
  EXPECT_FALSE(fast.observed);
  EXPECT_NEAR(fast.h_max.value(), real_limit_of_rk4 / 14000, 1e-12);
  EXPECT_NE(fast.note.find("not verified"), std::string::npos) << fast.note;
}

TEST(GrowingModel, OfManyUnknownsHasTheLimitOfTheCurveOfTheOthers) {
  // Eigenvalues 4 sin^2(k pi / 2 (n + 1)) - 1e-4: the slowest few are negative.
  constexpr int n = 2000;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2 - 1e-4);
    if (i > 0) entries.emplace_back(i, i - 1, -1);
    if (i + 1 < n) entries.emplace_back(i, i + 1, -1);
  }
  Sparse K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  const double s = std::sin(n * std::numbers::pi / (2 * (n + 1))), largest = 4 * s * s - 1e-4;
  const StepAnswer answer = largest_stable_step("rk4", K, Eigen::VectorXd::Ones(n));
  EXPECT_EQ(answer.bound, Bound::stability);
  EXPECT_NEAR(answer.h_max, imaginary_limit_of_rk4 / std::sqrt(largest), 1e-6);
  EXPECT_NE(answer.status.find("the model itself grows"), std::string::npos) << answer.status;
}

TEST(GrowingModel, HasALimitAlsoWhereTheStepsCoupleItsModes) {
  // Of symplectic Euler with these modes h^2 kappa + 2 h gamma = 4 for the fast one; C couples both a little.
  Eigen::Matrix2d K, C;
  K << -1e-4, 0, 0, 100;
  C << 0.3, 0.1, 0.1, 0.4;
  const StepAnswer answer = largest_stable_step("symplectic_euler", K, Eigen::VectorXd::Ones(2), C);
  EXPECT_EQ(answer.bound, Bound::stability);
  // det(4 I - 2 h C - h^2 K) = 0
  const auto determinant = [&](double h) {
    return (4 * Eigen::Matrix2d::Identity() - 2 * h * C - h * h * K).determinant();
  };
  EXPECT_NEAR(determinant(answer.h_max), 0, 1e-6);
  EXPECT_GT(determinant(0.99 * answer.h_max), 0);
}

TEST(RoundedMatrices, HaveRigidBodyModesAndNoGrowth) {
  // A free chain of three masses, written with eight digits: eigenvalues -3.3e-9, 0.333, 1.
  Eigen::Matrix3d K;
  K << 0.33333333, -0.33333333, 0, -0.33333333, 0.66666665, -0.33333333, 0, -0.33333333, 0.33333333;
  for (const char* method : {"rk4", "symplectic_euler"}) {
    const StepAnswer answer = largest_stable_step(method, K, Eigen::VectorXd::Ones(3));
    EXPECT_EQ(answer.bound, Bound::stability) << method;
    EXPECT_NEAR(answer.h_max, method[0] == 'r' ? imaginary_limit_of_rk4 : 2, 1e-7) << method;
    EXPECT_EQ(answer.status.find("grows"), std::string::npos) << answer.status;
  }
  // The same with a negative stiffness beyond half a unit of the last digit of each entry is growth.
  K(1, 1) = 0.66666656;
  EXPECT_NE(largest_stable_step("rk4", K, Eigen::VectorXd::Ones(3)).status.find("grows"), std::string::npos);
}

TEST(RoundedMatrices, KeepANegativeStiffnessThatTheDigitsOfItsEntriesShow) {
  // Seven digits: kappa = -0.1 is known to 5e-8, though it is less than 5e-7 of the largest; exp(0.316 t).
  const Eigen::Matrix2d K{{250000.5, 0}, {0, -0.1}};
  for (const char* method : {"rk4", "symplectic_euler"})
    EXPECT_NE(largest_stable_step(method, K, Eigen::VectorXd::Ones(2)).status.find("grows"),
              std::string::npos)
        << method;
}

}  // namespace
}  // namespace hmax
