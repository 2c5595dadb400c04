/// The eigenvalues of a step that continue the modes of a model.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/differences.hpp"
#include "analysis/dynamics/shown_mode.hpp"
#include "core/mass_matrix.hpp"

namespace hmax {

/// What the derivative of a step has of modes.
struct StepModes {
  std::vector<ShownMode> modes;
  /// A state from which steps oscillate as each mode shows, (q, v) from where they settle, with q of length 1
  /// in the norm of M; the shape of the model at rest where they keep it, or do not oscillate. Shape (2 dofs,
  /// modes).
  Eigen::MatrixXd starts;
  bool linear =
      true;  ///< false: what two small disturbances become together is not the sum, and no mode is found
  /// The eigenvalue of largest modulus, as far as it was found: above 1 motions grow.
  std::complex<double> largest{};
};

/// On the plane of each mode where steps do not mix it with others, else by Arnoldi iteration with the
/// derivative of a step about its settled state, whose slow motions are those that decay least.
/// @param step   as settled_state()
/// @param q      where it settles, shape (dofs)
/// @param sizes  displacements as large as those that matter, shape (dofs), not zero: q itself, where it is
/// not
/// @param h      [s]
/// @param mass   M, shape (dofs, dofs) [kg]
/// @param shapes of the modes, columns of length 1 in the norm of M, shape (dofs, modes)
/// @param modes  their omega and zeta
/// @param watch  called before each step; may throw
StepModes shown_modes(const VectorFunction& step, const Eigen::VectorXd& q, const Eigen::VectorXd& sizes,
                      double h, const MassMatrix<double>& mass, const Eigen::MatrixXd& shapes,
                      const std::vector<ShownMode>& modes, const std::function<void()>& watch = {});

}  // namespace hmax
