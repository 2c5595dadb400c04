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

 private:
  double mu_, lambda_;
  double square_, volume_;             // |F|^2 - 3, J - 1
  Eigen::Matrix3d H_, F_, cofactors_;  // cofactors_: dJ/dF
};

}  // namespace hmax
