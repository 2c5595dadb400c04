/// The largest eigenvalues of K u = kappa M u with an M that couples, without dividing by it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "analysis/spectrum/lanczos.hpp"
#include "core/coupled_mass.hpp"
#include "core/mass_matrix.hpp"

namespace hmax {

struct PencilPairs {
  std::vector<double> values;  ///< the largest first; at least one, converged or not
  Eigen::MatrixXd vectors;     ///< orthonormal in M, shape (n, values)
  double residual = 0;         ///< |A u - kappa M u| in the norm of M^-1 of the last of them, at most
  Eigen::Index products = 0;
  bool converged = false;  ///< false: fewer than were asked for
};

/// The largest eigenvalues of A u = kappa M u for a symmetric A, with their multiplicities, by Davidson's
/// method with restarts [davidson1975iterative]: the best vector of a space, the residual r = A u - kappa M
/// u, and D^-1 r as the next direction, where D = diag(M) is close to M. A step takes one product with each
/// matrix, where Lanczos iteration would divide by M. It begins with the same vector in every run.
/// @param A              y = A x
/// @param tolerance      of |r| in the norm of M^-1, relative to kappa: an eigenvalue is as near as that
/// @param most_products  in all; then those that have converged are taken
/// @cost    room for some 60 vectors and 2 `count` more
PencilPairs largest_pencil_eigenpairs(const SymmetricOperator& A, const CoupledMass& M, Eigen::Index count,
                                      double tolerance = 1e-10, Eigen::Index most_products = 5000);

/// The largest eigenvalue of A u = kappa M u, by Lanczos iteration where M is diagonal.
/// @param A  of an M that couples; else M^-1/2 A M^-1/2, as is what MassScaledProduct::unscaled() gives
/// @return   u in these coordinates, of length 1 in the norm of M
LanczosPair largest_eigenpair(const SymmetricOperator& A, const MassMatrix<double>& M,
                              const LanczosSettings& settings);

}  // namespace hmax
