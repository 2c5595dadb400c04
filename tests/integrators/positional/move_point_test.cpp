/// How a point is moved, beside the solvers of Eigen.
#include "integrators/positional/move_point.hpp"

#include <limits>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace hmax {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Q diag(modes) Q^T with a random Q.
Matrix3d with_modes(const Vector3d& modes, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Matrix3d Q = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                         .normalized()
                         .toRotationMatrix();
  const Matrix3d H = Q * modes.asDiagonal() * Q.transpose();
  return H.selfadjointView<Eigen::Lower>();
}

/// The step at h = 1 without mass.
Vector3d moved(const Matrix3d& H, const Vector3d& r) {
  // What is above the diagonal is not read.
  Matrix3d K = H;
  K.triangularView<Eigen::StrictlyUpper>().fill(std::numeric_limits<double>::quiet_NaN());
  const Matrix3d C = Matrix3d::Zero();
  const Vector3d away = Vector3d::Zero();
  Vector3d f = r, move;
  move_of_point(0, 1, f.data(), K.data(), C.data(), away.data(), move.data());
  return move;
}

TEST(MovePoint, SolvesDefiniteEquationsAsCholesky) {
  std::mt19937_64 random(3);
  for (const double smallest : {1.0, 1e-3, 1e-9})
    for (int i = 0; i < 100; ++i) {
      const Matrix3d H = with_modes({smallest, 2, 30}, random);
      const Vector3d r = Vector3d::Random(), wanted = H.llt().solve(r);
      EXPECT_EQ(moved(H, r), wanted);  // to the last bit
    }
}

TEST(MovePoint, TakesEigenvaluesByTheirAmounts) {
  std::mt19937_64 random(4);
  for (const Vector3d& modes : {Vector3d{-1, 2, 30},
                                {-1, -1, -1},
                                {-5, 5, 5},
                                {-40, 1e-3, 2},
                                {-1e9, 1e-3, 2},
                                {-3, 0, 2},
                                {0, 0, -7}})
    for (int i = 0; i < 100; ++i) {
      const Matrix3d H = with_modes(modes, random);
      const Vector3d r = Vector3d::Random();
      const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(H);
      const double least = 1e-12 * H.norm();
      const Vector3d amounts = solver.eigenvalues().cwiseAbs().cwiseMax(least);
      const Vector3d x = moved(H, r);
      // |H| x = r, to the rounding of H.
      const Vector3d back =
          solver.eigenvectors() * amounts.asDiagonal() * solver.eigenvectors().transpose() * x;
      EXPECT_LT((back - r).norm(), 1e-14 * (H.norm() * x.norm() + r.norm())) << modes.transpose();
      EXPECT_GT(x.dot(r), 0) << "a way down";
    }
}

TEST(MovePoint, KeepsMatricesThatAreDiagonal) {
  const Matrix3d H = Vector3d{4, -2, 0}.asDiagonal();
  const Vector3d x = moved(H, {1, 1, 0});
  EXPECT_EQ(x, Vector3d(0.25, 0.5, 0));
}

TEST(MovePoint, AddsInertiaAndDamping) {
  std::mt19937_64 random(5);
  const double mass = 0.3, h = 0.02;
  for (int i = 0; i < 20; ++i) {
    const Matrix3d K = with_modes({20, 300, 400}, random), C = with_modes({1, 2, 0.1}, random);
    const Vector3d f = Vector3d::Random(), away = Vector3d::Random();
    Matrix3d left = K;
    Vector3d force = f, move;
    move_of_point(mass, h, force.data(), left.data(), C.data(), away.data(), move.data());
    const Matrix3d H = K + C / h + mass / (h * h) * Matrix3d::Identity();
    EXPECT_LT((H * move - (f - mass / (h * h) * away)).norm(), 1e-12 * (H.norm() * move.norm()));
  }
}

}  // namespace
}  // namespace hmax
