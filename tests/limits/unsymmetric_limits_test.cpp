/// Limits of models without symmetric matrices that are too large for all of their modes.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "problems/linear_structure.hpp"

namespace hmax {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr int pairs = 1002;    // 4008 states
constexpr double turning = 3;  // [rad/s]
double omega_of(int k) { return 100 * std::exp(-k / 50.0); }

Sparse from(const Triplets& entries) {
  Sparse matrix(2 * pairs, 2 * pairs);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Pendulums on a turning table: x'' - 2 W y' + w^2 x = 0, y'' + 2 W x' + w^2 y = 0, whose eigenvalues are
/// i (+-W +- (W^2 + w^2)^1/2).
Linearised pendulums(double spin) {
  Triplets K, C;
  for (int k = 0; k < pairs; ++k) {
    for (int i = 0; i < 2; ++i) K.emplace_back(2 * k + i, 2 * k + i, omega_of(k) * omega_of(k));
    C.emplace_back(2 * k, 2 * k + 1, -2 * spin);
    C.emplace_back(2 * k + 1, 2 * k, 2 * spin);
  }
  Problem problem{.id = "pendulums",
                  .y0 = Eigen::VectorXd::Zero(4 * pairs),
                  .t_end = 1,
                  .system = linear_structure(from(K), Eigen::VectorXd::Ones(2 * pairs), from(C))};
  return linearised(problem, 0, problem.y0);
}

TEST(LargeUnsymmetricModels, HaveTheStepFromWhichTheirFastestModesAreUnstable) {
  const Linearised near = pendulums(turning);
  const Prediction row = predict(find_method("rk4"), near);
  EXPECT_FALSE(row.h_max);
  EXPECT_EQ(row.bound, Bound::unknown);
  const double fastest = turning + std::hypot(turning, omega_of(0));
  ASSERT_TRUE(row.unstable_from);
  EXPECT_NEAR(*row.unstable_from * fastest, std::sqrt(8), 1e-6);
  EXPECT_NE(row.note.find("they are unstable from"), std::string::npos) << row.note;
}

TEST(LargeUnsymmetricModels, AreNotForMethodsWhoseStepsCoupleTheModes) {
  const Prediction row = predict(find_method("symplectic_euler"), pendulums(turning));
  EXPECT_FALSE(row.h_max);
  EXPECT_FALSE(row.unstable_from);
  EXPECT_NE(row.note.find("not symmetric"), std::string::npos) << row.note;
}

TEST(LargeUnsymmetricModels, HaveAllModesWhereTheyAreSymmetricAfterAll) {
  const Prediction row = predict(find_method("rk4"), pendulums(0));
  ASSERT_TRUE(row.h_max);
  EXPECT_NEAR(*row.h_max * omega_of(0), std::sqrt(8), 1e-9);
}

}  // namespace
}  // namespace hmax
