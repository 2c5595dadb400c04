/// Whether a linear step map makes anything grow, from its products alone.
#pragma once

#include <complex>
#include <functional>

#include <Eigen/Core>

#include "analysis/spectrum/arnoldi.hpp"

namespace hmax {

struct GrowthSettings {
  /// |E| of the products: eigenvalues are those of J + E.
  double error = 0;
  /// The same in the direction of a vector, relative to its length; asked for few of them. Empty: as `error`.
  std::function<double(const Eigen::VectorXd& v)> error_along = {};
};

/// The growth of the fastest motion.
struct ProductGrowth {
  bool grows = false;
  /// False: multipliers crowd at modulus 1, and growth of less than `tolerance` a step may be there unseen.
  bool resolved = true;
  std::complex<double>
      multiplier{};  ///< that grows, or the largest one that is known; infinite beyond the range of numbers
  double tolerance = 0;      ///< of |multiplier|
  Eigen::VectorXd motion{};  ///< moduli of its eigenvector, shape (n)
};

/// The tolerance of the modulus of a multiplier of J + E: 4 |E| condition, at most 10 sqrt|E|, which is what
/// E makes of a double multiplier with one eigenvector, as that of a rigid motion: 1 becomes 1 +- sqrt(E).
/// (Golub and Van Loan, Matrix Computations)
double multiplier_tolerance(double error, double condition);

/// By Arnoldi iteration with J, and where that does not decide with J^8, in which what grows stands out among
/// multipliers of modulus 1. A multiplier grows where its modulus exceeds 1 by more than its tolerance and
/// what is left of its residual.
ProductGrowth growth_of_products(const LinearOperator& J, Eigen::Index n, const GrowthSettings& settings);

}  // namespace hmax
