#include "integrators/linear/sparse_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/SparseLU>

#include "core/process/leaving.hpp"
#include "core/size_limits.hpp"
#include "integrators/linear/conjugate_gradients.hpp"
#include "integrators/linear/panel_factor.hpp"

namespace hmax {

template <class Scalar>
class SparseSolver<Scalar>::Solvers {
 public:
  using Real = typename Eigen::NumTraits<Scalar>::Real;
  /// Of complex matrices only direct ones.
  static constexpr bool may_iterate = !Eigen::NumTraits<Scalar>::IsComplex;

  void set(LinearSolve choice) { choice_ = choice; }

  bool factor(const Matrix& A) {
    // The analysis stays while the pattern does.
    const bool known = same_as_analysed(A);
    if (!known) analyse(A);
    // How often the matrix before was used: the guess for this one.
    const double solutions = solutions_;
    solutions_ = 0;
    work_left_ = never;
    symmetric_ = symmetric_pattern_ && has_symmetric_values(A);
    iterates_ = false;
    if (!symmetric_) return factor_general(A);
    if constexpr (may_iterate) {
      iterates_ = choice_.by == LinearSolve::By::conjugate_gradients;
      if (choice_.by == LinearSolve::By::automatic) {
        // Expected cost of the iterations against that of the factorisation; what is left of it is paid off
        // by pay().
        work_left_ = factorisation_work(A) - iterations_to_prepare * iteration_work(A);
        iterates_ = iteration_work(A) * std::max(solutions, 1.0) * expected_iterations_ < work_left_;
      }
      if (iterates_) {
        const bool prepared = gradients_.prepare(A, std::exchange(gradients_known_, true));
        if (prepared) return true;
      }
      iterates_ = false;
    }
    // L D L^T first; factors that do not solve a test equation give way to L U with pivoting.
    symmetric_ = factor_symmetric(A);
    return symmetric_ || factor_general(A);
  }

  int solve(Eigen::Ref<Vector> x) {
    ++solutions_;
    int iterations = 0;
    if constexpr (may_iterate) {
      if (iterates_) {
        const int most = choice_.iterations > 0 ? choice_.iterations : 0;
        scratch_ = x;
        const auto end = gradients_.solve(scratch_, x, choice_.tolerance, most);
        iterations = end.iterations;
        expected_iterations_ = iterations;
        if (end.solved || most > 0) {
          pay(iterations);
          return iterations;
        }
        // Not positive definite, or rounding in the way: a factorisation tells.
        x = scratch_;
        iterates_ = false;
        symmetric_ = factor_symmetric(gradients_.matrix());
        if (!symmetric_ && !factor_general(gradients_.matrix())) {
          x.setConstant(std::numeric_limits<Scalar>::quiet_NaN());
          return iterations;
        }
      }
    }
    if (symmetric_) {
      panels_.solve(x);
      return iterations;
    }
    scratch_ = lu_->solve(x);
    x = scratch_;
    return iterations;
  }

  [[nodiscard]] bool is_symmetric() const { return symmetric_; }

  [[nodiscard]] std::optional<std::int64_t> negative_eigenvalues() const {
    if constexpr (may_iterate)
      if (symmetric_ && !iterates_)
        return std::ranges::count_if(panels_.pivots(), [](Scalar d) { return d < 0; });
    return std::nullopt;
  }

 private:
  /// The work that pays a factorisation where none is to be made.
  static constexpr double never = std::numeric_limits<double>::infinity();
  static constexpr double iterations_to_prepare = 4;  ///< that take as long as the preconditioner
  using Lu = Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>>;

  /// |x| of real numbers; of complex ones the sum of the sizes of their parts, which needs no root.
  static Real size_of(const Scalar& x) {
    if constexpr (Eigen::NumTraits<Scalar>::IsComplex)
      return std::abs(x.real()) + std::abs(x.imag());
    else
      return std::abs(x);
  }

  /// Whether all entries are finite; the sum of the parts of a complex entry may overflow, which counts as
  /// infinite.
  static bool is_finite(const Matrix& A) {
    int wrong = 0;  // in every number the same, so that several are looked at at once
    for (Eigen::Index i = 0; i < A.nonZeros(); ++i)
      wrong |= !(size_of(A.valuePtr()[i]) <= std::numeric_limits<Real>::max());
    return wrong == 0;
  }

  /// Whether A has the pattern that was analysed.
  [[nodiscard]] bool same_as_analysed(const Matrix& A) const {
    return outer_.size() == static_cast<std::size_t>(A.outerSize()) + 1 &&
           inner_.size() == static_cast<std::size_t>(A.nonZeros()) &&
           std::equal(outer_.begin(), outer_.end(), A.outerIndexPtr()) &&
           std::equal(inner_.begin(), inner_.end(), A.innerIndexPtr());
  }

  /// Remembers the pattern, and for each entry of the upper triangle where the one across it stands.
  void analyse(const Matrix& A) {
    solutions_ = 0;
    expected_iterations_ = 20;
    outer_.assign(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1);
    inner_.assign(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
    panels_known_ = gradients_known_ = false;
    lu_.reset();
    symmetric_pattern_ = true;
    across_.clear();
    std::vector<int> next(outer_.begin(), outer_.end() - 1);
    // Columns in order: the entries (i, j) of row i come in order of j, as those of column i do.
    for (int j = 0; j < static_cast<int>(A.cols()) && symmetric_pattern_; ++j)
      for (int p = outer_[j]; p < outer_[j + 1]; ++p) {
        const int i = inner_[p];
        const int q = next[i]++;
        // The entry (j, i) is missing.
        if (q >= outer_[i + 1] || inner_[q] != j) {
          symmetric_pattern_ = false;
          break;
        }
        if (i <= j) across_.push_back({p, q});
      }
  }

  /// Whether |a_ij - a_ji| <= 64 eps max |a_ij| for all entries. False also when something is not finite.
  [[nodiscard]] bool has_symmetric_values(const Matrix& A) const {
    const Scalar* values = A.valuePtr();
    // Four at a time: one maximum would wait for itself. A maximum overlooks NaN, a sum does not.
    constexpr std::size_t lanes = 4;
    Real largest[lanes]{}, apart[lanes]{}, sum[lanes]{};
    const auto look = [&](std::size_t p, std::size_t lane) {
      // a_ij and a_ji
      const Scalar upper = values[across_[p].upper], lower = values[across_[p].lower];
      const Real difference = size_of(upper - lower);
      largest[lane] = std::max(largest[lane], size_of(upper));
      apart[lane] = std::max(apart[lane], difference);
      sum[lane] += difference;
    };
    std::size_t p = 0;
    for (; p + lanes <= across_.size(); p += lanes)
      for (std::size_t lane = 0; lane < lanes; ++lane) look(p + lane, lane);
    for (; p < across_.size(); ++p) look(p, 0);
    return std::ranges::all_of(sum, [](Real x) { return std::isfinite(x); }) &&
           std::ranges::max(apart) <= 64 * std::numeric_limits<Real>::epsilon() * std::ranges::max(largest);
  }

  /// The plan of L D L^T, once for each pattern.
  void analyse_symmetric(const Matrix& A) {
    if (!panels_known_) panels_.analyse(A);
    panels_known_ = true;
  }

  /// L D L^T. An indefinite A, or a complex one, has to pass a test equation, since there is no pivoting.
  /// @returns false where a pivot is zero or the factors do not solve
  bool factor_symmetric(const Matrix& A) {
    analyse_symmetric(A);
    return panels_.factor(A) && (is_positive_definite() || solves(A));
  }

  /// Such matrices need no pivoting: all d_i > 0.
  [[nodiscard]] bool is_positive_definite() const {
    if constexpr (may_iterate)
      return std::ranges::all_of(panels_.pivots(), [](Scalar d) { return d > 0; });
    else
      return false;
  }

  /// Tries the factors, made without pivoting, on b = (1, ..., 2):
  ///   |b - A x| <= 1e4 eps (|A| |x| + |b|) in Euclidean and Frobenius norms.
  bool solves(const Matrix& A) {
    // No component is zero, so that every row of the factors takes part.
    const Vector b = Vector::LinSpaced(A.rows(), Scalar(1), Scalar(2));
    scratch_ = b;
    panels_.solve(scratch_);
    const Real size = A.norm() * scratch_.norm() + b.norm();
    return (b - A * scratch_).norm() <= 1e4 * std::numeric_limits<Real>::epsilon() * size;
  }

  /// L U with partial pivoting; the order of columns is analysed once for each pattern.
  /// @returns false where A is singular or not finite
  bool factor_general(const Matrix& A) {
    if (!is_finite(A)) return false;
    if (!lu_) {
      lu_ = std::make_unique<Lu>();
      lu_->analyzePattern(A);
    }
    lu_->factorize(A);
    return lu_->info() == Eigen::Success;
  }

  /// Operations of L D L^T; infinite for more than most_factored_often unknowns, where the factors of a
  /// body in space take too long.
  double factorisation_work(const Matrix& A) {
    if (A.rows() > most_factored_often) return std::numeric_limits<double>::infinity();
    analyse_symmetric(A);
    return panels_.work();
  }

  /// Operations of a factorisation that take as long as an iteration, which does four for each entry of A
  /// but not so many at once.
  static double iteration_work(const Matrix& A) { return 16.0 * static_cast<double>(A.nonZeros()); }

  /// Takes iterations off the work that a factorisation would be. When nothing is left, A is factored.
  void pay([[maybe_unused]] int iterations) {
    if constexpr (may_iterate) {
      work_left_ -= iteration_work(gradients_.matrix()) * iterations;
      if (work_left_ > 0) return;
      work_left_ = never;
      iterates_ = !factor_symmetric(gradients_.matrix());
    }
  }

  LinearSolve choice_;
  /// Places of a_ij and a_ji in the values of A.
  struct Pair {
    int upper, lower;
  };
  std::vector<int> outer_, inner_;  ///< the pattern that was analysed
  std::vector<Pair> across_;        ///< its entries on both sides of the diagonal
  /// The pattern is symmetric; the matrix is, and is solved as such; conjugate gradients solve it.
  bool symmetric_pattern_ = false, symmetric_ = false, iterates_ = false;
  bool panels_known_ = false, gradients_known_ = false;  ///< whether each has the pattern that is analysed
  double work_left_ = never;                             ///< until a factorisation pays
  double solutions_ = 0;                                 ///< with this matrix so far
  double expected_iterations_ = 20;                      ///< of a solution
  PanelFactor<Scalar> panels_;
  /// L U, made when a matrix needs it.
  std::unique_ptr<Lu> lu_;
  /// Holds a copy of the matrix while it iterates.
  ConjugateGradients<Real> gradients_;
  Vector scratch_;
};

namespace {

/// The type of double that goes with a scalar of long double.
template <class Scalar>
using Narrow = std::conditional_t<Eigen::NumTraits<Scalar>::IsComplex, std::complex<double>, double>;

/// Of long double: factors in double, and solutions that residuals in long double refine until the next
/// correction would be below their rounding, or one is no smaller than half the one before.
template <class Scalar>
class Refined {
 public:
  using Matrix = Eigen::SparseMatrix<Scalar>;
  using Vector = Eigen::Vector<Scalar, Eigen::Dynamic>;
  using Real = typename Eigen::NumTraits<Scalar>::Real;

  void set(LinearSolve choice) {
    choice_ = choice;
    factors_.set(choice);
  }

  bool factor(const Matrix& A) {
    A_ = A;
    return factors_.factor(A.template cast<Narrow<Scalar>>());
  }

  int solve(Eigen::Ref<Vector> x) {
    const Vector b = x;
    x.setZero();
    int iterations = 0;
    // Corrections shrink by a ratio that the first two tell.
    for (Real before = std::numeric_limits<Real>::infinity();;) {
      correction_ = (b - A_ * x).template cast<Narrow<Scalar>>();
      iterations += factors_.solve(correction_);
      const Real size = static_cast<Real>(correction_.norm()), ratio = size / before;
      // What is not finite is passed on.
      if (!(ratio >= Real(0.5))) x += correction_.template cast<Scalar>();
      const bool known =
          std::isfinite(before) && ratio * size <= std::numeric_limits<Real>::epsilon() * x.norm();
      // Of conjugate gradients with a limit: what so many have reached.
      if (known || size == 0 || !(ratio < Real(0.5)) || choice_.iterations > 0) return iterations;
      before = size;
    }
  }

  [[nodiscard]] bool is_symmetric() const { return factors_.is_symmetric(); }
  [[nodiscard]] std::optional<std::int64_t> negative_eigenvalues() const {
    return factors_.negative_eigenvalues();
  }

 private:
  LinearSolve choice_;
  SparseSolver<Narrow<Scalar>> factors_;
  Matrix A_;
  Eigen::Vector<Narrow<Scalar>, Eigen::Dynamic> correction_;
};

}  // namespace

template <>
class SparseSolver<long double>::Solvers : public Refined<long double> {};
template <>
class SparseSolver<std::complex<long double>>::Solvers : public Refined<std::complex<long double>> {};

template <class Scalar>
SparseSolver<Scalar>::SparseSolver() : solvers_(std::make_unique<Solvers>()) {}
template <class Scalar>
SparseSolver<Scalar>::SparseSolver(SparseSolver&& other) noexcept = default;
template <class Scalar>
SparseSolver<Scalar>& SparseSolver<Scalar>::operator=(SparseSolver&& other) noexcept = default;
template <class Scalar>
SparseSolver<Scalar>::~SparseSolver() = default;

template <class Scalar>
void SparseSolver<Scalar>::set(LinearSolve choice) {
  solvers_->set(choice);
}

template <class Scalar>
bool SparseSolver<Scalar>::factor(const Matrix& A) {
  leave_when_asked();
  return solvers_->factor(A);
}

template <class Scalar>
int SparseSolver<Scalar>::solve(Eigen::Ref<Vector> x) {
  leave_when_asked();
  return solvers_->solve(x);
}

template <class Scalar>
bool SparseSolver<Scalar>::is_symmetric() const {
  return solvers_->is_symmetric();
}

template <class Scalar>
std::optional<std::int64_t> SparseSolver<Scalar>::negative_eigenvalues() const {
  return solvers_->negative_eigenvalues();
}

template class ConjugateGradients<double>;
template class SparseSolver<double>;
template class SparseSolver<long double>;
template class SparseSolver<std::complex<double>>;
template class SparseSolver<std::complex<long double>>;

}  // namespace hmax
