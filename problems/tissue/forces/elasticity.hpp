/// Strain energies of isotropic solids: what a finite element asks of a material at one deformation gradient.
///
/// A law is made from the displacement gradient H = du/dX = F - I, shape (3, 3), and answers with its energy
/// density W [J/m^3], its first Piola-Kirchhoff stress P = dW/dF [Pa] and the differential dP of P along a
/// change dF. F itself would have lost the digits of a small H.
/// All laws have the stress lambda tr(e) I + 2 mu e at small strains e, so that one pair of Lame coefficients
/// serves them all.
#pragma once

#include <Eigen/Core>

#include "problems/cofactors.hpp"
#include "problems/tissue/forces/kernels/tet_law.hpp"

namespace hmax {

/// Lame coefficients [Pa].
struct Lame {
  double lambda = 0;  ///< E nu / ((1 + nu) (1 - 2 nu))
  double mu = 0;      ///< E / (2 (1 + nu)), the shear modulus
};

/// @param young    E [Pa], positive
/// @param poisson  nu [1], above -1 and below 1/2
/// @throws std::invalid_argument  when a coefficient is out of range
Lame lame(double young, double poisson);

/// What a point with the gradient g of its shape function feels of a law, per volume.
template <class Real>
struct AlongSlope {
  Eigen::Matrix<Real, 3, 1> stress;  ///< P g
  Eigen::Matrix<Real, 3, 3> block;   ///< d(P g)/du, its own displacement being u
};

/// The differential of cofactors(F) along dF.
[[nodiscard]] Eigen::Matrix3d cofactor_differential(const Eigen::Matrix3d& F, const Eigen::Matrix3d& dF);
/// J - 1 with the digits of a small H.
[[nodiscard]] double volume_change(const Eigen::Matrix3d& H);

/// Small strain, e = sym(H):   W = mu e:e + lambda/2 tr(e)^2. Linear; wrong when the body turns.
class SmallStrain {
 public:
  static constexpr TetLaw kernel = TetLaw::small_strain;
  SmallStrain(const Eigen::Matrix3d& H, const Lame& lame);
  [[nodiscard]] double energy() const;
  [[nodiscard]] Eigen::Matrix3d stress() const;
  [[nodiscard]] Eigen::Matrix3d differential(const Eigen::Matrix3d& dF) const;
  /// The same at one point in one piece.
  template <class Real>
  [[nodiscard]] static AlongSlope<Real> along(const Eigen::Matrix<Real, 3, 3>& H, const Real& lambda,
                                              const Real& mu, const Eigen::Matrix<Real, 3, 1>& g);

 private:
  Lame lame_;
  Eigen::Matrix3d strain_;
};

/// St. Venant-Kirchhoff, Green's strain E = (H + H^T + H^T H) / 2:   W = mu E:E + lambda/2 tr(E)^2,   P = F
/// S, S = 2 mu E + lambda tr(E) I. Turns freely, but goes soft and gives way under strong compression.
/// @source  [bonet2008nonlinear]
class GreenStrain {
 public:
  GreenStrain(const Eigen::Matrix3d& H, const Lame& lame);
  [[nodiscard]] double energy() const;
  [[nodiscard]] Eigen::Matrix3d stress() const;
  [[nodiscard]] Eigen::Matrix3d differential(const Eigen::Matrix3d& dF) const;
  /// The same at one point in one piece.
  template <class Real>
  [[nodiscard]] static AlongSlope<Real> along(const Eigen::Matrix<Real, 3, 3>& H, const Real& lambda,
                                              const Real& mu, const Eigen::Matrix<Real, 3, 1>& g);

 private:
  Lame lame_;
  Eigen::Matrix3d F_, strain_, stress_;  // stress_: S
};

/// Small strain in the frame of the rotation R nearest to F:   W = mu |F - R|^2 + lambda/2 tr(R^T F - I)^2.
/// The differential includes that of R. R is a rotation also where F inverts; where the two smallest singular
/// values cancel (s2 = -s3) it is not unique, and its differential is taken as zero.
/// @source  [sifakis2012fem]
class Corotational {
 public:
  static constexpr TetLaw kernel = TetLaw::corotational;
  Corotational(const Eigen::Matrix3d& H, const Lame& lame);
  [[nodiscard]] double energy() const;
  [[nodiscard]] Eigen::Matrix3d stress() const;
  [[nodiscard]] Eigen::Matrix3d differential(const Eigen::Matrix3d& dF) const;

 private:
  Lame lame_;
  Eigen::Matrix3d strain_, R_, turn_;  // F - R; turn_: (tr(S) I - S)^-1, see turning() of rotation.hpp
  double trace_;                       // tr(R^T F) - 3
};

/// Stable neo-Hookean solid: finite, with a force that restores, for every F, flat and inverted ones
/// included.
///   W = mu'/2 (|F|^2 - 3) + lambda'/2 (J - a)^2 - mu'/2 log(|F|^2 + 1) - W(I),   J = det F,
///   mu' = 4/3 mu,   lambda' = lambda + 5/6 mu,   a = 1 + 3/4 mu'/lambda'.
/// @source  [smith2018stable]
class StableNeoHookean {
 public:
  static constexpr TetLaw kernel = TetLaw::neo_hookean;
  StableNeoHookean(const Eigen::Matrix3d& H, const Lame& lame);
  [[nodiscard]] double energy() const;
  [[nodiscard]] Eigen::Matrix3d stress() const;
  [[nodiscard]] Eigen::Matrix3d differential(const Eigen::Matrix3d& dF) const;
  /// The same at one point in one piece: J is linear along changes that g^T has on the right.
  /// @tparam Real  double, or Lanes
  template <class Real>
  [[nodiscard]] static AlongSlope<Real> along(const Eigen::Matrix<Real, 3, 3>& H, const Real& lambda,
                                              const Real& mu, const Eigen::Matrix<Real, 3, 1>& g);

 private:
  double mu_, lambda_;
  double square_, volume_;             // |F|^2 - 3, J - 1
  Eigen::Matrix3d H_, F_, cofactors_;  // cofactors_: dJ/dF
};

template <class Real>
AlongSlope<Real> SmallStrain::along(const Eigen::Matrix<Real, 3, 3>& H, const Real& lambda, const Real& mu,
                                    const Eigen::Matrix<Real, 3, 1>& g) {
  AlongSlope<Real> answer;
  answer.stress = g * (lambda * H.trace()) + (H.lazyProduct(g) + H.transpose().lazyProduct(g)) * mu;
  for (Eigen::Index j = 0; j < 3; ++j) answer.block.col(j) = g * ((lambda + mu) * g[j]);
  answer.block.diagonal().array() += mu * g.squaredNorm();
  return answer;
}

template <class Real>
AlongSlope<Real> GreenStrain::along(const Eigen::Matrix<Real, 3, 3>& H, const Real& lambda, const Real& mu,
                                    const Eigen::Matrix<Real, 3, 1>& g) {
  using Vector = Eigen::Matrix<Real, 3, 1>;
  Eigen::Matrix<Real, 3, 3> F = H, B;
  F.diagonal().array() += Real(1);
  for (Eigen::Index j = 0; j < 3; ++j) B.col(j) = F.lazyProduct(F.row(j).transpose());  // F F^T
  const Vector Hg = H.lazyProduct(g), h = g + Hg;
  // 2 E g = (H + H^T F) g, and S g
  const Vector strained = Hg + H.transpose().lazyProduct(h);
  const Real trace =
      H.trace() + Real(0.5) * (H.col(0).squaredNorm() + H.col(1).squaredNorm() + H.col(2).squaredNorm());
  const Vector stressed = g * (lambda * trace) + strained * mu;
  AlongSlope<Real> answer;
  answer.stress = F.lazyProduct(stressed);
  const Real shear = mu * g.squaredNorm();
  for (Eigen::Index j = 0; j < 3; ++j) answer.block.col(j) = h * ((lambda + mu) * h[j]) + B.col(j) * shear;
  answer.block.diagonal().array() += g.dot(stressed);
  return answer;
}

template <class Real>
AlongSlope<Real> StableNeoHookean::along(const Eigen::Matrix<Real, 3, 3>& H, const Real& first_lame,
                                         const Real& second_lame, const Eigen::Matrix<Real, 3, 1>& g) {
  using Vector = Eigen::Matrix<Real, 3, 1>;
  const Real mu = second_lame * Real(4.0 / 3), lambda = first_lame + second_lame * Real(5.0 / 6);
  const Eigen::Matrix<Real, 3, 3> K = cofactors(H);
  const Real trace = H.trace(), square = Real(2) * trace + H.colwise().squaredNorm().sum(),
             n = square + Real(4), volume = trace + K.trace() + H.col(0).dot(K.col(0));
  // C = I + D, D = tr(H) I - H^T + K. Products without a call each: the hot loop of vertex block descent.
  const Vector Hg = H.lazyProduct(g), Dg = g * trace - H.transpose().lazyProduct(g) + K.lazyProduct(g);
  const Vector Fg = g + Hg, Cg = g + Dg;
  const Vector stretched = Fg * (Real(2) * mu / (n * n)), squeezed = Cg * lambda;
  AlongSlope<Real> answer;
  answer.stress = (Hg - Dg) * (Real(0.75) * mu) + Fg * (mu * square / (Real(4) * n)) + squeezed * volume;
  for (Eigen::Index j = 0; j < 3; ++j) answer.block.col(j) = stretched * Fg[j] + squeezed * Cg[j];
  answer.block.diagonal().array() += mu * (Real(1) - Real(1) / n) * g.squaredNorm();
  return answer;
}

}  // namespace hmax
