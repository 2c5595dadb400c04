#include "problems/tissue/elasticity.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Dense>

#include "problems/digits.hpp"

namespace hmax {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double dot(const Matrix3d& A, const Matrix3d& B) { return A.cwiseProduct(B).sum(); }

/// mu e:e + lambda/2 tr(e)^2.
double hooke_energy(const Matrix3d& e, const Lame& lame) {
  return lame.mu * e.squaredNorm() + lame.lambda / 2 * e.trace() * e.trace();
}

/// 2 mu e + lambda tr(e) I.
Matrix3d hooke_stress(const Matrix3d& e, const Lame& lame) {
  return 2 * lame.mu * e + lame.lambda * e.trace() * Matrix3d::Identity();
}

/// The rotation nearest to F: Newton's iteration R <- (R + R^-T) / 2 where F does not invert, which doubles
/// the digits each time [higham2008functions, 8], and singular vectors where it does or is nearly flat.
Matrix3d nearest_rotation(const Matrix3d& F) {
  const double size = F.norm();
  if (F.determinant() > 1e-3 * size * size * size) {
    Matrix3d R = F;
    for (int i = 0; i < 30; ++i) {
      const Matrix3d next = (R + R.inverse().transpose()) / 2;
      const double change = (next - R).norm();
      R = next;
      if (change < 1e-9) return (R + R.inverse().transpose()) / 2;
    }
  }
  const Eigen::JacobiSVD<Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  return U * svd.matrixV().transpose();
}

Matrix3d cross_matrix(const Vector3d& w) {
  Matrix3d W;
  W << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return W;
}

/// Columns f2 x f3, f3 x f1, f1 x f2: the derivative of the determinant of (f1, f2, f3).
Matrix3d cofactors(const Matrix3d& F) {
  Matrix3d C;
  for (int j = 0; j < 3; ++j) C.col(j) = F.col((j + 1) % 3).cross(F.col((j + 2) % 3));
  return C;
}

/// W(I) of the stable neo-Hookean solid without its volume term.
constexpr double stretch_at_rest = 4;  // |I|^2 + 1

}  // namespace

Lame lame(double young, double poisson) {
  if (!(young > 0) || !std::isfinite(young))
    throw std::invalid_argument("Young's modulus is " + shortest_digits(young) +
                                " Pa but must be positive and finite");
  if (!(poisson > -1 && poisson < 0.5))
    throw std::invalid_argument("Poisson's ratio is " + shortest_digits(poisson) +
                                " but must lie above -1 and below 0.5; tissue that keeps its volume has 0.45 "
                                "to 0.499");
  return {young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))};
}

SmallStrain::SmallStrain(const Matrix3d& F, const Lame& lame)
    : lame_(lame), strain_((F + F.transpose()) / 2 - Matrix3d::Identity()) {}
double SmallStrain::energy() const { return hooke_energy(strain_, lame_); }
Matrix3d SmallStrain::stress() const { return hooke_stress(strain_, lame_); }
Matrix3d SmallStrain::differential(const Matrix3d& dF) const {
  return hooke_stress((dF + dF.transpose()) / 2, lame_);
}

GreenStrain::GreenStrain(const Matrix3d& F, const Lame& lame)
    : lame_(lame),
      F_(F),
      strain_((F.transpose() * F - Matrix3d::Identity()) / 2),
      stress_(hooke_stress(strain_, lame)) {}
double GreenStrain::energy() const { return hooke_energy(strain_, lame_); }
Matrix3d GreenStrain::stress() const { return F_ * stress_; }
Matrix3d GreenStrain::differential(const Matrix3d& dF) const {
  const Matrix3d half = F_.transpose() * dF, change = (half + half.transpose()) / 2;
  return dF * stress_ + F_ * hooke_stress(change, lame_);
}

Corotational::Corotational(const Matrix3d& F, const Lame& lame)
    : lame_(lame), F_(F), R_(nearest_rotation(F)), trace_(dot(R_, F) - 3) {
  const Matrix3d stretch = R_.transpose() * F, S = (stretch + stretch.transpose()) / 2;
  const Matrix3d sums = S.trace() * Matrix3d::Identity() - S;
  bool unique = false;
  sums.computeInverseWithCheck(turn_, unique, 1e-12 * std::pow(sums.norm(), 3));
  if (!unique) turn_.setZero();
}
double Corotational::energy() const {
  return lame_.mu * (F_ - R_).squaredNorm() + lame_.lambda / 2 * trace_ * trace_;
}
Matrix3d Corotational::stress() const { return 2 * lame_.mu * (F_ - R_) + lame_.lambda * trace_ * R_; }
Matrix3d Corotational::differential(const Matrix3d& dF) const {
  // With F = R S and dR = R W, W = -W^T: the skew part of R^T dF is that of W S, so that
  // (tr(S) I - S) w = axis of (R^T dF - dF^T R).
  const Matrix3d A = R_.transpose() * dF;
  const Vector3d axis(A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1));
  const Matrix3d dR = R_ * cross_matrix(turn_ * axis);
  return 2 * lame_.mu * (dF - dR) + lame_.lambda * (A.trace() * R_ + trace_ * dR);
}

StableNeoHookean::StableNeoHookean(const Matrix3d& F, const Lame& lame)
    : mu_(4 * lame.mu / 3),
      lambda_(lame.lambda + 5 * lame.mu / 6),
      excess_(F.determinant() - 1 - 3 * mu_ / (4 * lambda_)),
      square_(F.squaredNorm()),
      F_(F),
      cofactors_(cofactors(F)) {}
double StableNeoHookean::energy() const {
  const double at_rest = -3 * mu_ / (4 * lambda_);
  return mu_ / 2 * (square_ - 3 - std::log((square_ + 1) / stretch_at_rest)) +
         lambda_ / 2 * (excess_ * excess_ - at_rest * at_rest);
}
Matrix3d StableNeoHookean::stress() const {
  return mu_ * (1 - 1 / (square_ + 1)) * F_ + lambda_ * excess_ * cofactors_;
}
Matrix3d StableNeoHookean::differential(const Matrix3d& dF) const {
  Matrix3d dC;
  for (int j = 0; j < 3; ++j) {
    const int k = (j + 1) % 3, l = (j + 2) % 3;
    dC.col(j) = dF.col(k).cross(F_.col(l)) + F_.col(k).cross(dF.col(l));
  }
  const double n = square_ + 1;
  return mu_ * ((1 - 1 / n) * dF + 2 * dot(F_, dF) / (n * n) * F_) +
         lambda_ * (dot(cofactors_, dF) * cofactors_ + excess_ * dC);
}

}  // namespace hmax
