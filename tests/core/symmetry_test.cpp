#include "core/symmetry.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

namespace hmax {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// A circulatory pair, as of a follower force, between unknowns 0 and 1, and a penalty on unknown 2.
Sparse circulatory(double penalty) {
  Eigen::Matrix3d K;
  K << 1, 0.4, 0, -0.4, 1, -1, 0, -1, penalty;
  return K.sparseView();
}

TEST(Symmetry, APenaltyOnOneUnknownHidesNothingOfTheOthers) {
  for (const double penalty : {1.0, 1e5, 1e10, 1e13, 1e16, 1e30})
    EXPECT_EQ(first_asymmetry(circulatory(penalty)), std::make_pair(Eigen::Index{1}, Eigen::Index{0}))
        << penalty;
}

TEST(Symmetry, RoundingOfAssemblyAndOfTextIsNone) {
  Eigen::Matrix3d K;
  K << 3, 1 / 3.0, -1e5, 1 / 3.0 + 1e-11, 2, -1e5, -1e5 * (1 + 2e-11), -1e5, 1e11;
  EXPECT_TRUE(is_symmetric(K.sparseView()));
  K(0, 1) += 1e-3;
  EXPECT_FALSE(is_symmetric(K.sparseView()));
}

TEST(Symmetry, TenDigitsOfTextBesideAPenaltyAreNone) {
  Eigen::Matrix3d K;
  K << 2, -1.000000001, 0, -1.000000000, 2, -1, 0, -1, 1e5;
  EXPECT_TRUE(is_symmetric(K.sparseView()));
}

TEST(Symmetry, DampingOfNothingButRoundingIsNone) {
  Eigen::Matrix3d C;
  C << 1e-15, 3e-16, 0, -2e-16, 2e-15, 0, 0, 0, 5;
  const Sparse noise = C.sparseView(0, 1);
  EXPECT_FALSE(is_symmetric(noise));
  EXPECT_TRUE(is_symmetric(noise, damping_noise));
  C(0, 1) = 0.4;
  EXPECT_FALSE(is_symmetric(Sparse(C.sparseView(0, 1)), damping_noise));
}

TEST(Symmetry, ARowOfNothingButRoundingIsNone) {
  // A bar along x, turned by a quarter of a circle and back: what is left across it is cos(pi / 2).
  const double noise = std::cos(std::numbers::pi / 2);
  Eigen::Matrix2d K;
  K << 1, noise, 2 * noise, noise * noise;
  EXPECT_TRUE(is_symmetric(K.sparseView()));
}

}  // namespace
}  // namespace hmax
