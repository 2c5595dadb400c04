/// The rotation of an element, whatever became of it.
#include "problems/tissue/forces/kernels/rotation.hpp"

#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "problems/tissue/forces/kernels/one_element.hpp"

namespace hmax {
namespace {

using Eigen::Matrix3d;

/// @tparam Real  that is computed with
template <class Real>
Matrix3d rotation_of(const Matrix3d& F) {
  Real H[3][3], W[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) H[i][j] = static_cast<Real>(i == j ? F(i, j) - 1 : F(i, j));
  kernel_loops::nearest_rotation<OneElement<Real>, Real>(H, W);
  Matrix3d R = Matrix3d::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R(i, j) += static_cast<double>(W[i][j]);
  return R;
}

void expect_rotation(const Matrix3d& R, double rounding) {
  EXPECT_LT((R.transpose() * R - Matrix3d::Identity()).norm(), rounding);
  EXPECT_GT(R.determinant(), 0);
}

/// U V^T of the singular vectors, the least turned over where that is a reflection, and how far another
/// rotation is from being as good, over the largest singular value.
std::pair<Matrix3d, double> from_singular_vectors(const Matrix3d& F) {
  const Eigen::JacobiSVD<Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d U = svd.matrixU();
  const double sign = (U * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  U.col(2) *= sign;
  const Eigen::Vector3d s = svd.singularValues();
  return {U * svd.matrixV().transpose(), (s[1] + sign * s[2]) / s[0]};
}

TEST(NearestRotation, IsThatOfSingularVectorsAlsoWhereElementsInvertOrAreFlat) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::size_t inverted = 0;
  for (int n = 0; n < 20'000; ++n) {
    const double size = std::pow(10.0, n % 7 - 3);
    Matrix3d F;
    for (double& entry : F.reshaped()) entry = size * normal(random);
    if (n % 5 == 0) F.col(2) = 2 * F.col(0) + 1e-6 * F.col(2);
    inverted += F.determinant() < 0 ? 1 : 0;
    const auto [R, gap] = from_singular_vectors(F);
    const Matrix3d found = rotation_of<double>(F);
    expect_rotation(found, 1e-14);
    EXPECT_LT((found - R).norm() * gap, 1e-14 + 1e-15 / size) << F;
    expect_rotation(rotation_of<float>(F), 1e-5);
  }
  EXPECT_GT(inverted, 8'000U);
}

TEST(NearestRotation, IsOneOfTheBestWhereSeveralAre) {
  // Of the singular values s1 >= s2 >= s3 the trace of R^T F is s1 + s2 + s3, s1 + s2 - s3 of a reflection.
  std::mt19937_64 random(4);
  const auto turn = [&] {
    std::normal_distribution<double> normal;
    return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
        .normalized()
        .toRotationMatrix();
  };
  for (const Eigen::Vector3d& s :
       {Eigen::Vector3d{0, 0, 0}, Eigen::Vector3d{1, 0, 0}, Eigen::Vector3d{1, 1, 0},
        Eigen::Vector3d{1, 1, -1}, Eigen::Vector3d{2, 1, -1}, Eigen::Vector3d{1, 1, 1},
        Eigen::Vector3d{2, 1, 1}, Eigen::Vector3d{1e-9, 1e-9, 1e-9}, Eigen::Vector3d{1e60, 1e60, -1e60}})
    for (int n = 0; n < 50; ++n) {
      const Matrix3d U = n == 0 ? Matrix3d::Identity() : turn(), V = n == 0 ? Matrix3d::Identity() : turn();
      const Matrix3d F = U * s.asDiagonal() * V.transpose(), R = rotation_of<double>(F);
      expect_rotation(R, 1e-14);
      EXPECT_NEAR((R.transpose() * F).trace(), s.sum(), 1e-14 * s.norm() + 1e-15) << s.transpose();
    }
}

TEST(NearestRotation, KeepsTheDigitsOfSmallStrains) {
  // F - R of H is sym(H) but for its square.
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (const double size : {1e-5, 1e-9, 1e-13}) {
    double H[3][3], W[3][3];
    for (auto& row : H)
      for (double& entry : row) entry = size * normal(random);
    kernel_loops::nearest_rotation<OneElement<double>, double>(H, W);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(H[i][j] - W[i][j], (H[i][j] + H[j][i]) / 2, size * (20 * size + 1e-15));
  }
}

}  // namespace
}  // namespace hmax
