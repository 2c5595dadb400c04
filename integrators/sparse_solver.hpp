/// Sparse linear equations: the solver that fits the matrix, its analysis made once.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>

#include "integrators/conjugate_gradients.hpp"
#include "integrators/panel_solve.hpp"

namespace hmax {

/// How sparse symmetric equations are solved.
struct LinearSolve {
  enum class By {
    automatic,           ///< conjugate gradients until their work would have paid for a factorisation
    direct,              ///< a factorisation, whatever it costs
    conjugate_gradients  ///< always
  };
  By by = By::automatic;
  double tolerance = 1e-10;  ///< of conjugate gradients: |residual| <= tolerance |right-hand side|
  int iterations = 0;        ///< at most so many, as simulators that truncate do; 0: until it is solved

  bool operator==(const LinearSolve&) const = default;
};

/// Solves A x = b for a sparse A, shape (n, n). Where A is symmetric: L D L^T or conjugate gradients; else L
/// U with partial pivoting. The pattern is analysed once and again only when it changes.
///
/// automatic: a matrix that serves once or twice is cheaper by conjugate gradients than by a factorisation,
/// one that is kept for a thousand steps is not. Which it will be is not known, so iterations are counted,
/// and when they have cost what the factorisation would have, it is made: never more than twice the best
/// choice. Work is counted in multiplications and not in seconds, so that the same input gives the same bits.
template <class Scalar>
class SparseSolver {
 public:
  using Matrix = Eigen::SparseMatrix<Scalar>;
  using Real = typename Eigen::NumTraits<Scalar>::Real;
  using Vector = Eigen::Vector<Scalar, Eigen::Dynamic>;
  static constexpr bool may_be_symmetric = !Eigen::NumTraits<Scalar>::IsComplex;

  void set(LinearSolve choice) { choice_ = choice; }

  /// @returns false when A is singular or not finite; solve() must not be called then
  bool factor(const Matrix& A) {
    if (!is_finite(A)) return false;
    const bool known = same_as_analysed(A);
    if (!known) analyse(A);
    if constexpr (may_be_symmetric) {
      if (symmetric_pattern_ && has_symmetric_values(A)) {
        symmetric_ = true;
        iterates_ = choice_.by == LinearSolve::By::conjugate_gradients ||
                    (choice_.by == LinearSolve::By::automatic && A.rows() >= smallest_to_iterate);
        if (iterates_ && gradients_.prepare(A)) {
          work_left_ = choice_.by == LinearSolve::By::automatic ? factorisation_work(A) : -1;
          return true;
        }
        iterates_ = false;
        if (factor_symmetric(A)) return true;
      }
      symmetric_ = false;
    }
    return factor_general(A);
  }

  /// x = A^-1 x, shape (n).
  template <class X>
  void solve(X& x) {
    if constexpr (may_be_symmetric) {
      if (symmetric_ && iterates_) {
        const int most = choice_.iterations > 0 ? choice_.iterations : 0;
        scratch_ = x;
        const auto end = gradients_.solve(scratch_, x, choice_.tolerance, most);
        iterations_ = end.iterations;
        if (end.solved || most > 0) {
          pay(end.iterations);
          return;
        }
        // Not positive definite, or rounding in the way: a factorisation tells.
        x = scratch_;
        if (!factor_symmetric(gradients_.matrix())) {
          symmetric_ = false;
          factor_general(gradients_.matrix());
        }
        iterates_ = false;
      }
      if (symmetric_) return panels_.solve(x);
    }
    scratch_ = lu_->solve(x);
    x = scratch_;
  }

  [[nodiscard]] bool is_symmetric() const { return symmetric_; }

  /// Of the last solution by conjugate gradients.
  [[nodiscard]] int iterations() const { return iterations_; }

 private:
  /// Below this a factorisation is always cheap.
  static constexpr Eigen::Index smallest_to_iterate = 150;
  struct Ldlt : Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::AMDOrdering<int>> {
    /// Multiplications of one factorisation, from the lengths of its columns.
    [[nodiscard]] double work() const {
      return (this->m_nonZerosPerCol.template cast<double>().array() + 1).square().sum();
    }
  };
  using Lu = Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>>;

  static bool is_finite(const Matrix& A) {
    for (Eigen::Index i = 0; i < A.nonZeros(); ++i)
      if (!std::isfinite(std::abs(A.valuePtr()[i]))) return false;
    return true;
  }

  [[nodiscard]] bool same_as_analysed(const Matrix& A) const {
    return outer_.size() == static_cast<std::size_t>(A.outerSize()) + 1 &&
           inner_.size() == static_cast<std::size_t>(A.nonZeros()) &&
           std::equal(outer_.begin(), outer_.end(), A.outerIndexPtr()) &&
           std::equal(inner_.begin(), inner_.end(), A.innerIndexPtr());
  }

  /// Remembers the pattern, and for each entry where the one across the diagonal stands.
  void analyse(const Matrix& A) {
    outer_.assign(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1);
    inner_.assign(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
    ldlt_.reset();
    lu_.reset();
    if constexpr (may_be_symmetric) {
      symmetric_pattern_ = true;
      across_.assign(inner_.size(), 0);
      std::vector<int> next(outer_.begin(), outer_.end() - 1);
      // Columns in order: the entries (i, j) of row i come in order of j, as those of column i do.
      for (int j = 0; j < static_cast<int>(A.cols()) && symmetric_pattern_; ++j)
        for (int p = outer_[j]; p < outer_[j + 1]; ++p) {
          const int i = inner_[p];
          const int q = next[i]++;
          if (q >= outer_[i + 1] || inner_[q] != j) {
            symmetric_pattern_ = false;
            break;
          }
          across_[p] = q;
        }
    }
  }

  [[nodiscard]] bool has_symmetric_values(const Matrix& A) const {
    const Scalar* values = A.valuePtr();
    Real largest = 0, apart = 0;
    for (std::size_t p = 0; p < across_.size(); ++p) {
      largest = std::max(largest, std::abs(values[p]));
      apart = std::max(apart, std::abs(values[p] - values[across_[p]]));
    }
    return apart <= 64 * std::numeric_limits<Real>::epsilon() * largest;
  }

  void analyse_symmetric(const Matrix& A) {
    if (ldlt_) return;
    ldlt_ = std::make_unique<Ldlt>();
    ldlt_->analyzePattern(A);
  }

  bool factor_symmetric(const Matrix& A) {
    analyse_symmetric(A);
    ldlt_->factorize(A);
    if (ldlt_->info() != Eigen::Success) return false;
    const auto& d = ldlt_->vectorD();
    if (!d.allFinite() || !(d.cwiseAbs().minCoeff() > 0)) return false;
    panels_.build(ldlt_->matrixL().nestedExpression(), d, ldlt_->permutationP());
    return true;
  }

  bool factor_general(const Matrix& A) {
    if (!lu_) {
      lu_ = std::make_unique<Lu>();
      lu_->analyzePattern(A);
    }
    lu_->factorize(A);
    return lu_->info() == Eigen::Success;
  }

  /// Infinite where the factors of a body in space do not fit into memory.
  double factorisation_work(const Matrix& A) {
    if (A.rows() > largest_to_factor) return std::numeric_limits<double>::infinity();
    analyse_symmetric(A);
    return ldlt_->work();
  }

  /// An iteration counts four multiplications for each entry of A: the product and its preconditioner.
  void pay(int iterations) {
    if (work_left_ < 0) return;
    work_left_ -= 4.0 * static_cast<double>(gradients_.matrix().nonZeros()) * iterations;
    if (work_left_ > 0) return;
    work_left_ = -1;
    iterates_ = !factor_symmetric(gradients_.matrix());
  }

  static constexpr Eigen::Index largest_to_factor = 60'000;

  LinearSolve choice_;
  std::vector<int> outer_, inner_, across_;
  int iterations_ = 0;
  bool symmetric_pattern_ = false, symmetric_ = false, iterates_ = false;
  double work_left_ = -1;  // until a factorisation pays; negative: never
  std::unique_ptr<Ldlt> ldlt_;
  PanelSolve<Scalar> panels_;
  std::unique_ptr<Lu> lu_;
  ConjugateGradients<Real> gradients_;
  Vector scratch_;
};

}  // namespace hmax
