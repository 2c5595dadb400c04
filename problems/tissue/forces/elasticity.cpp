#include "problems/tissue/forces/elasticity.hpp"

#include <cmath>
#include <stdexcept>

#include <Eigen/Dense>

#include "problems/digits.hpp"
#include "problems/tissue/forces/kernels/one_element.hpp"
#include "problems/tissue/forces/kernels/rotation.hpp"

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

Matrix3d cross_matrix(const Vector3d& w) {
  Matrix3d W;
  W << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return W;
}

}  // namespace

Matrix3d cofactor_differential(const Matrix3d& F, const Matrix3d& dF) {
  Matrix3d dC;
  for (int j = 0; j < 3; ++j) {
    const int k = (j + 1) % 3, l = (j + 2) % 3;
    dC.col(j) = dF.col(k).cross(F.col(l)) + F.col(k).cross(dF.col(l));
  }
  return dC;
}

double volume_change(const Matrix3d& H) { return H.trace() + cofactors(H).trace() + H.determinant(); }

Lame lame(double young, double poisson) {
  if (!(young > 0) || !std::isfinite(young))
    throw std::invalid_argument("Young's modulus is " + shortest_digits(young) +
                                " Pa but must be positive and finite");
  if (!(poisson > -1 && poisson < 0.5))
    throw std::invalid_argument("Poisson's ratio is " + shortest_digits(poisson) +
                                " but must lie above -1 and below 0.5; for tissue that keeps its volume take "
                                "0.45, or 0.499 with a model that does not lock");
  return {young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))};
}

SmallStrain::SmallStrain(const Matrix3d& H, const Lame& lame)
    : lame_(lame), strain_((H + H.transpose()) / 2) {}
double SmallStrain::energy() const { return hooke_energy(strain_, lame_); }
Matrix3d SmallStrain::stress() const { return hooke_stress(strain_, lame_); }
Matrix3d SmallStrain::differential(const Matrix3d& dF) const {
  return hooke_stress((dF + dF.transpose()) / 2, lame_);
}

GreenStrain::GreenStrain(const Matrix3d& H, const Lame& lame)
    : lame_(lame),
      F_(Matrix3d::Identity() + H),
      strain_((H + H.transpose() + H.transpose() * H) / 2),
      stress_(hooke_stress(strain_, lame)) {}
double GreenStrain::energy() const { return hooke_energy(strain_, lame_); }
Matrix3d GreenStrain::stress() const { return F_ * stress_; }
Matrix3d GreenStrain::differential(const Matrix3d& dF) const {
  const Matrix3d half = F_.transpose() * dF, change = (half + half.transpose()) / 2;
  return dF * stress_ + F_ * hooke_stress(change, lame_);
}

Corotational::Corotational(const Matrix3d& H, const Lame& lame) : lame_(lame) {
  using Lanes = OneElement<double>;
  double gradient[3][3], W[3][3], R[3][3], strain[3][3], turn[6];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) gradient[i][j] = H(i, j);
  kernel_loops::nearest_rotation<Lanes, double>(gradient, W);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      strain_(i, j) = strain[i][j] = gradient[i][j] - W[i][j];
      R_(i, j) = R[i][j] = i == j ? 1 + W[i][j] : W[i][j];
    }
  trace_ = dot(R_, strain_);
  kernel_loops::turning<Lanes>(R, strain, turn);
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) turn_(i, j) = turn_(j, i) = turn[kernel_loops::symmetric(i, j)];
}
double Corotational::energy() const {
  return lame_.mu * strain_.squaredNorm() + lame_.lambda / 2 * trace_ * trace_;
}
Matrix3d Corotational::stress() const { return 2 * lame_.mu * strain_ + lame_.lambda * trace_ * R_; }
Matrix3d Corotational::differential(const Matrix3d& dF) const {
  // With F = R S and dR = R W, W = -W^T: the skew part of R^T dF is that of W S, so that
  // (tr(S) I - S) w = axis of (R^T dF - dF^T R).
  const Matrix3d A = R_.transpose() * dF;
  const Vector3d axis(A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1));
  const Matrix3d dR = R_ * cross_matrix(turn_ * axis);
  return 2 * lame_.mu * (dF - dR) + lame_.lambda * (A.trace() * R_ + trace_ * dR);
}

StableNeoHookean::StableNeoHookean(const Matrix3d& H, const Lame& lame)
    : mu_(4 * lame.mu / 3),
      lambda_(lame.lambda + 5 * lame.mu / 6),
      square_(2 * H.trace() + H.squaredNorm()),
      volume_(volume_change(H)),
      H_(H),
      F_(Matrix3d::Identity() + H),
      cofactors_(cofactors(F_)) {}
double StableNeoHookean::energy() const {
  // |F|^2 - 3 - 2 (J - 1), which begins with the squares of H.
  const double shear = H_.squaredNorm() - 2 * (cofactors(H_).trace() + H_.determinant());
  return mu_ / 2 * (square_ / 4 - std::log1p(square_ / 4) + 3 * shear / 4) + lambda_ / 2 * volume_ * volume_;
}
Matrix3d StableNeoHookean::stress() const {
  // mu' (1 - 1/(|F|^2 + 1)) F + lambda' (J - a) C with the cofactors C: at F = I the two are 3/4 mu' and
  // cancel.
  const Matrix3d shear = H_ + H_.transpose() - H_.trace() * Matrix3d::Identity() - cofactors(H_);  // F - C
  return mu_ * (3 * shear / 4 + square_ / (4 * (square_ + 4)) * F_) + lambda_ * volume_ * cofactors_;
}
Matrix3d StableNeoHookean::differential(const Matrix3d& dF) const {
  const double n = square_ + 4, excess = volume_ - 3 * mu_ / (4 * lambda_);
  return mu_ * ((1 - 1 / n) * dF + 2 * dot(F_, dF) / (n * n) * F_) +
         lambda_ * (dot(cofactors_, dF) * cofactors_ + excess * cofactor_differential(F_, dF));
}

}  // namespace hmax
