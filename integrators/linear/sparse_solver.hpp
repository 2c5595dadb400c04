/// Sparse linear equations: the solver that fits the matrix, its analysis made once.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <Eigen/SparseCore>

#include "integrators/linear/linear_solve.hpp"

namespace hmax {

/// Solves A x = b for a sparse A, shape (n, n). Where A is symmetric: L D L^T or, of real numbers, conjugate
/// gradients; else L U with partial pivoting. The pattern is analysed once and again only when it changes.
///
/// automatic: a matrix that serves once or twice is often cheaper by conjugate gradients than by a
/// factorisation, one that is kept for a thousand steps is not. How often it will serve, and how many
/// iterations a solution will take, is expected to be as with the matrix before. Iterations are counted, and
/// when they have cost what the factorisation would have, it is made: never more than twice the best choice.
/// Cost is counted in operations and not in seconds, so that the same input gives the same bits.
///
/// Compiled in sparse_solver.cpp for real and complex numbers of double and long double: what includes this
/// may be compiled with less optimisation, and is compiled sooner. Of long double the factors are those of
/// double, and a solution is refined by its residuals.
template <class Scalar>
class SparseSolver {
 public:
  using Matrix = Eigen::SparseMatrix<Scalar>;
  using Vector = Eigen::Vector<Scalar, Eigen::Dynamic>;

  SparseSolver();
  /// What was moved from can be destroyed or assigned to, no more.
  SparseSolver(SparseSolver&& other) noexcept;
  SparseSolver& operator=(SparseSolver&& other) noexcept;
  ~SparseSolver();

  /// For the factorisations that follow.
  void set(LinearSolve choice);

  /// Factors A, or keeps it for conjugate gradients. A is compressed, shape (n, n).
  /// @returns false when A is singular or not finite; solve() must not be called then
  bool factor(const Matrix& A);

  /// x = A^-1 x, shape (n); NaN where conjugate gradients find that A is singular. With a limit of
  /// iterations x is what they have reached.
  /// @returns iterations of conjugate gradients, 0 where factors solve
  int solve(Eigen::Ref<Vector> x);

  /// Whether A is solved as a symmetric matrix: by conjugate gradients or L D L^T.
  [[nodiscard]] bool is_symmetric() const;

  /// How many eigenvalues of a real symmetric A are negative: by Sylvester's law of inertia the negative
  /// pivots of L D L^T. Empty where no L D L^T was made, as for complex numbers.
  [[nodiscard]] std::optional<std::int64_t> negative_eigenvalues() const;

 private:
  class Solvers;
  std::unique_ptr<Solvers> solvers_;
};

}  // namespace hmax
