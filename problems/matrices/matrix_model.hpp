/// A linear model of matrices from files: M q'' + C q' + K q = 0, or y' = J y.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/coupled_mass.hpp"
#include "problems/any_system.hpp"
#include "problems/matrices/constraint_rows.hpp"
#include "problems/matrices/varying_structure.hpp"

namespace hmax {

/// The pseudo-random numbers of a start that no file gives are up to this [m], or of first order in the unit
/// of y.
inline constexpr double random_start_size = 1e-3;

/// Which files make a model.
struct MatrixFiles {
  std::string stiffness = {}, mass = {}, damping = {};    ///< of second order
  std::string jacobian = {};                              ///< of first order
  std::string initial = {};                               ///< the start; empty: pseudo-random q, at rest
  bool lumped = false;                                    ///< masses are the sums of the rows of M
  bool stiffness_series = false, damping_series = false;  ///< the file names matrices at several times
  bool one_triangle = false;  ///< files hold one triangle of symmetric matrices, whatever their header says
  bool drop_constraints = false;  ///< constraint rows are left out
};

/// What a user should know of the matrices.
struct MatrixFacts {
  Eigen::Index rows = 0;  ///< of the files
  double mass = 0;  ///< sum of the entries of M [kg]; of a body in three dimensions three times its mass
  bool symmetric_K = true, symmetric_C = true, coupled_mass = false, damped = false;
  Eigen::Index massless = 0;     ///< rows that were condensed
  Eigen::Index multipliers = 0;  ///< rows of Lagrange multipliers, eliminated with an unknown each
  std::vector<Eigen::Index>
      redundant;               ///< those of them whose constraint follows from others; rows of the files
  ConstraintRows constraints;  ///< rows of the files, counted from 0
  bool dropped = false;        ///< whether these were left out
  std::size_t repeated = 0;    ///< entries at a place that an earlier one has
  bool look_swapped = false;   ///< K looks like masses, and M like a stiffness
  Eigen::Index free_directions = 0;  ///< translations that strain nothing, for three unknowns a node in turn
};

/// What of the files is left: Lagrange multipliers are eliminated, unknowns without mass condensed,
/// constraint rows left out where that is asked for.
struct MatrixModel {
  MatrixFiles files;
  MatrixFacts facts{};
  Eigen::SparseMatrix<double> K{}, C{};  ///< at t = 0, shape (n, n); C is empty (0, 0) without damping
  /// Where K or C is a series: both at every time; else null.
  std::shared_ptr<const VaryingMatrices> varying = nullptr;
  Eigen::VectorXd mass{};           ///< the diagonal of M, shape (n) [kg]; empty where M couples unknowns
  Eigen::SparseMatrix<double> M{};  ///< where it does, shape (n, n)
  Eigen::SparseMatrix<double> J{};  ///< of first order, shape (n, n)
  Eigen::VectorXd start{};          ///< y(0): (q, q') of shape (2 n), or of first order y of shape (n)
  std::vector<Eigen::Index> unknowns{};  ///< the row in the files of each unknown, counted from 0
  std::vector<std::string> names{};      ///< of the rows of the files, "12.3"; empty where no file tells them
  std::shared_ptr<const CoupledMass>
      coupled{};  ///< M with what it takes to divide by it; null where it is diagonal

  [[nodiscard]] bool is_first_order() const { return !files.jacobian.empty(); }
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(unknowns.size()); }
  /// "unknown 7", "unknown 7 (12.3)"; a row of the files, counted from 0.
  [[nodiscard]] std::string name_of(Eigen::Index row) const;
};

/// Reads and checks the files.
/// @throws std::invalid_argument  for files that cannot be read, shapes that do not agree, unknowns with
/// neither stiffness nor mass, masses that are negative, a mass that is not symmetric, one triangle of a
/// matrix without `one_triangle`, massless unknowns without stiffness, matrices of a series that are not of
/// one model
MatrixModel read_matrix_model(const MatrixFiles& files);

/// The model with its matrices as they are at the time t [s].
MatrixModel frozen(MatrixModel model, double t);

/// The start that `values` of the unknowns of the files make: q, or (q, q').
/// @param values  shape (rows of the files), or of second order (2 rows)
/// @throws std::invalid_argument  for another shape; `what` names the values
Eigen::VectorXd start_from(const MatrixModel& model, const Eigen::VectorXd& values, const std::string& what);

/// The model as a system, with Rayleigh damping alpha M + beta K [1/s], [s] in addition to C.
AnySystem system_of(const MatrixModel& model, double alpha, double beta);

}  // namespace hmax
