/// The linear systems of a static solution, by the solver that was chosen.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "analysis/static_solution.hpp"
#include "integrators/sparse_solver.hpp"

namespace hmax {

/// Solves K d = r by the chosen solver, whatever K is kept for.
class Inner {
 public:
  using Matrix = StaticModel::Matrix;

  /// @param settings  must outlive this
  explicit Inner(const StaticSettings& settings);

  /// Of sor and conjugate gradients.
  void set_tolerance(double tolerance);
  /// @returns false when K is singular
  bool take(const Matrix& K);
  /// Whether K has negative eigenvalues, or is so near to singular that its factors do not tell. What
  /// iterates finds out where it solves no more.
  [[nodiscard]] bool is_indefinite() const;
  /// @returns false when the solver gave up
  bool solve(const Eigen::VectorXd& r, Eigen::VectorXd& d);
  [[nodiscard]] std::int64_t iterations() const { return iterations_; }
  /// A solver that factors, which where it can is the one that has looked at the pattern already: what was
  /// taken is gone then.
  SparseSolver<double>& factors();

 private:
  const StaticSettings& settings_;
  SparseSolver<double> solver_;
  std::optional<SparseSolver<double>> factors_;
  Matrix K_;
  double tolerance_ = 0;
  std::int64_t iterations_ = 0;
};

}  // namespace hmax
