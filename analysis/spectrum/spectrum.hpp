/// Eigenvalues and eigenvectors of a linear model: all of them, by dense methods.
#pragma once

#include <array>
#include <complex>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/spectrum/linear_model.hpp"
#include "analysis/spectrum/modes.hpp"
#include "core/size_limits.hpp"

namespace hmax {

/// Eigenvalues of a 2 x 2 matrix from trace T and determinant D, lambda = T/2 +- sqrt(T^2/4 - D), the smaller
/// real one as D over the larger so that nothing cancels. Larger real part first, then larger imaginary part.
/// @cost  no allocation
std::array<std::complex<double>, 2> eigenvalues_2x2(const Eigen::Matrix2d& J);

/// The modes of a mechanical part that decouples, in the order of kappa.
/// Each mode is an independent oscillator q'' + gamma q' + kappa q = 0 of the amplitude of its shape.
struct MechanicalModes {
  std::vector<MechanicalMode> modes;
  /// Column i is the shape of mode i, shape (n, n), with shapes^T M shapes = I [kg^-1/2]; empty unless
  /// wanted.
  Eigen::MatrixXd shapes;
};

/// The eigenvalues kappa of M^-1/2 K M^-1/2 and what damping makes of their eigenvectors u,
/// gamma = u^T M^-1/2 C M^-1/2 u. Within an eigenspace of K the eigenvectors of C are taken, so that both are
/// diagonal. Where C = alpha M + beta K, gamma = alpha + beta kappa needs no eigenvectors.
/// Rigid-body modes: |kappa| up to 1e-14 n of the largest counts as 0.
/// @cost  the eigenproblem of a symmetric matrix of n rows; without vectors where C is Rayleigh's and no
/// shapes are wanted
/// @throws std::invalid_argument  unless part.decouples()
MechanicalModes mechanical_modes(const MechanicalPart& part, bool with_shapes = false);

/// All eigenvalues of J.
/// Re lambda < 0 for all: the state is stable; the spectral radius max |lambda| is the fastest rate, which
/// explicit steps have to resolve.
struct Spectrum {
  std::vector<std::complex<double>> lambda;  ///< shape (dim) [1/s]; of growing modulus, without `mechanical`
  /// Where the motion decouples, in the order of kappa: mechanical[i] has lambda[2 i] and lambda[2 i + 1].
  std::vector<MechanicalMode> mechanical;
};

/// Two numbers in closed form; mechanical parts that decouple by their symmetric problem of half the size;
/// with general damping the companion form (0, s I; -M^-1/2 K M^-1/2 / s, -M^-1/2 C M^-1/2), s^2 the size of
/// the stiffness, so that both blocks are of one size [tisseur2001quadratic, 3.4]; everything else as it is.
/// @throws InputError  for more than most_dense_rows, or when the iteration does not converge
Spectrum spectrum_of(const LinearModel& model);

/// All eigenvalues of a dense matrix, of growing modulus. @throws InputError  as spectrum_of
/// @param J  shape (n, n)
std::vector<std::complex<double>> all_eigenvalues(const Eigen::MatrixXd& J);

/// Eigenvectors, in the order of Spectrum::lambda.
/// J = V diag(lambda) V^-1 where J is not defective.
struct Eigenvectors {
  std::vector<std::complex<double>> lambda;  ///< shape (n) [1/s]
  Eigen::MatrixXcd right;                    ///< V, shape (n, n): column i has J v = lambda_i v and |v| = 1
  Eigen::MatrixXcd left;   ///< V^-1: row i has w J = lambda_i w and w v_i = 1; empty when defective
  double condition = 1;    ///< |V| |V^-1| in scaled coordinates (below); infinity when singular
  bool defective = false;  ///< too few eigenvectors to rounding
  std::string note;        ///< a sentence when defective
};

/// Beyond this condition a matrix counts as defective. A double eigenvalue with one eigenvector, critical
/// damping for instance, is known in doubles as two eigenvalues about 1e-8 apart, whose eigenvectors have a
/// condition of some 1e7 to 1e8.
/// Eigenvalues are then known to about epsilon times the condition (Bauer and Fike; Golub and Van Loan,
/// Matrix Computations).
inline constexpr double defective_condition = 1e7;

/// Positions and velocities have no common scale, so the condition of mechanical parts is measured in
/// coordinates whose norm is like energy: where the motion decouples (sqrt|kappa| a, a') of each modal
/// amplitude a, else (s M^1/2 q, M^1/2 v) with the s of spectrum_of.
/// The condition is 1 for undamped motion, and grows as 1 / |lambda_1 - lambda_2| towards critical
/// damping.
/// @throws InputError  as spectrum_of
Eigenvectors eigenvectors_of(const LinearModel& model);

}  // namespace hmax
