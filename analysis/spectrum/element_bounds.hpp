/// Bounds of the fastest mode of a structure from its elements alone, and which element owns a mode.
#pragma once

#include <functional>
#include <span>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// A stiffness matrix as the sum of those of elements on points of three degrees of freedom: calls
/// visit(points, K) for each, always in one order, with the numbers of its points (-1 for one that is held)
/// and its symmetric K without negative eigenvalues, shape (3 points, 3 points).
/// K = sum_e L_e^T K_e L_e, where L_e picks the 3 p degrees of freedom of an element with p points.
using ElementVisitor =
    std::function<void(std::span<const Eigen::Index>, const Eigen::Ref<const Eigen::MatrixXd>&)>;
using ElementSum = std::function<void(const ElementVisitor& visit)>;

/// Upper bounds of the largest eigenvalue kappa of M^-1 K [1/s^2]. A step limited by 2 / sqrt(kappa) is too
/// small by sqrt(bound / kappa) with them.
/// With h_max = 2 / sqrt(kappa) of central differences all three give safe steps; they cost a pass over the
/// elements or the matrix instead of an eigenvalue iteration.
struct StiffnessBounds {
  /// The largest of the elements, each with its share of the lumped masses: no sum of elements is faster than
  /// the fastest of them [irons1971bound].
  /// max_e of the largest eigenvalue of M_e^-1 K_e, where sum_e M_e = M: by the quotient of Rayleigh, u^T
  /// K u = sum_e u_e^T K_e u_e <= max_e kappa_e sum_e u_e^T M_e u_e.
  double element = 0;
  /// max over points of the largest eigenvalue of sum_e p_e K_e(a, a) / m_a, with p_e the number of points of
  /// e: a matrix of p x p blocks without negative eigenvalues is at most p times its diagonal blocks.
  double nodal = 0;
  /// max over rows of sum_j |K_ij| / (m_i m_j)^(1/2) (Gershgorin).
  /// No eigenvalue of a symmetric matrix exceeds its largest sum of moduli in a row.
  double gershgorin = 0;
};

/// Points that are held (-1) take part in no bound: their rows and columns are left out.
/// @param mass     of the points, shape (points) [kg]
/// @param weights  what the elements share the mass of a point by, one each, all positive, such as their own
/// masses; empty:
///                 the traces of their stiffness there
/// @param K        their sum, shape (3 points, 3 points) [N/m]
StiffnessBounds stiffness_bounds(const ElementSum& elements, const Eigen::VectorXd& mass,
                                 std::span<const double> weights, const Eigen::SparseMatrix<double>& K);

/// Where a mode lives.
struct ModeOwner {
  Eigen::Index element = 0;   ///< with the largest share of strain energy
  double share = 0;           ///< u_e^T K_e u_e / u^T K u
  Eigen::Index elements = 0;  ///< how many have nine tenths of it together
  double moving_points = 0;   ///< 1 / sum of squares of the points' shares of kinetic energy
};

/// Strain energy u_e^T K_e u_e / 2 of each element, kinetic energy m_a |u_a|^2 of each point; the inverse
/// sum of squares is n where n points share it equally.
/// @param mass   of the points, shape (points) [kg]
/// @param shape  of the mode, shape (3 points)
ModeOwner owner_of(const ElementSum& elements, const Eigen::VectorXd& mass, const Eigen::VectorXd& shape);

}  // namespace hmax
