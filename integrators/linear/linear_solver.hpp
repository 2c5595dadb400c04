/// The linear equations of implicit methods: matrices that are dense or sparse, known at compile time or
/// chosen at run time, factored once and solved often.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>
#include <variant>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/structure_operator.hpp"
#include "integrators/linear/block_structure.hpp"
#include "integrators/linear/blocked_lu.hpp"
#include "integrators/linear/sparse_solver.hpp"
#include "integrators/mechanical.hpp"

namespace hmax {

namespace detail {
/// Type of I - s J by type of J: dense stays dense, sparse stays sparse, parts become ShiftedMechanical,
/// operators ShiftedOperator, a variant becomes the variant of those.
template <class Matrix, class Scalar>
struct WithScalar {
  using type = Eigen::Matrix<Scalar, Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime>;
};
template <class From, int Options, class Index, class Scalar>
struct WithScalar<Eigen::SparseMatrix<From, Options, Index>, Scalar> {
  using type = Eigen::SparseMatrix<Scalar, Options, Index>;
};
template <class Real, class Scalar>
struct WithScalar<MechanicalJacobian<Real>, Scalar> {
  using type = ShiftedMechanical<Scalar>;
};
template <class Scalar>
struct WithScalar<OperatorJacobian, Scalar> {
  using type = ShiftedOperator;
};
template <class... Matrices, class Scalar>
struct WithScalar<std::variant<Matrices...>, Scalar> {
  using type = std::variant<typename WithScalar<Matrices, Scalar>::type...>;
};

/// Whether T is a std::variant.
template <class T>
inline constexpr bool is_variant = false;
template <class... T>
inline constexpr bool is_variant<std::variant<T...>> = true;

/// The alternative of `target` that matches `wanted`, made when another one is there.
template <class Wanted, class... T>
Wanted& alternative(std::variant<T...>& target) {
  if (auto* there = std::get_if<Wanted>(&target)) return *there;
  return target.template emplace<Wanted>();
}
}  // namespace detail

/// The type of I - s J for a J of type Matrix and an s of type Scalar, which may be complex where J is real.
template <class Matrix, class Scalar>
using with_scalar = typename detail::WithScalar<Matrix, Scalar>::type;

/// A = I - s J. Its scalar may be complex where that of J is real.
/// @param J  shape (n, n): dense, sparse, parts or operators (integrators/mechanical.hpp), or a variant of
/// these
/// @param s  the shift, h gamma of a stage [s] where J is in 1/s
/// @param A  keeps its memory where it has the size of J; dense: no allocation then
template <class Matrix, class Scalar>
void set_shifted(const Matrix& J, Scalar s, with_scalar<Matrix, Scalar>& A) {
  if constexpr (detail::is_variant<Matrix>) {
    std::visit(
        [&]<class Alternative>(const Alternative& held) {
          set_shifted(held, s, detail::alternative<with_scalar<Alternative, Scalar>>(A));
        },
        J);
  } else if constexpr (std::is_base_of_v<Eigen::SparseMatrixBase<Matrix>, Matrix>) {
    with_scalar<Matrix, Scalar> identity(J.rows(), J.cols());
    identity.setIdentity();
    A = identity - s * J.template cast<Scalar>();
  } else {
    A = (-s) * J.template cast<Scalar>();
    A.diagonal().array() += Scalar(1);
  }
}

/// A = M + c C + k K: the matrix of a second-order method, with m the lumped masses, shape (n), or a sparse M
/// for sparse C and K; operators are of masses of one. C, K and A have shape (n, n); of variants, C must hold
/// the same alternative as K.
/// @throws std::bad_variant_access  where it does not
template <class Mass, class Matrix, class Real>
void set_combination(const Mass& m, Real c, const Matrix& C, Real k, const Matrix& K, Matrix& A) {
  if constexpr (detail::is_variant<Matrix>) {
    std::visit(
        [&]<class Alternative>(const Alternative& held) {
          set_combination(m, c, std::get<Alternative>(C), k, held, detail::alternative<Alternative>(A));
        },
        K);
  } else if constexpr (std::is_same_v<Matrix, OperatorSum>) {
    A = {K, static_cast<double>(c), static_cast<double>(k)};
  } else if constexpr (std::is_base_of_v<Eigen::SparseMatrixBase<Matrix>, Matrix>) {
    set_sparse_combination<Real, typename Matrix::Scalar>(m, c, C, k, K, A);
  } else {
    A = c * C + k * K;
    if constexpr (std::is_base_of_v<Eigen::SparseMatrixBase<Mass>, Mass>)
      A += Matrix(m.template cast<typename Matrix::Scalar>());
    else
      A.diagonal() += m;
  }
}

/// A matrix for a member that will be sized later: zero where the size is fixed, since a stepper is copied
/// into its run and numbers without a value must not be.
template <class Matrix>
Matrix blank_matrix() {
  if constexpr (requires { requires Matrix::SizeAtCompileTime != Eigen::Dynamic; })
    return Matrix::Zero();
  else
    return Matrix();
}

/// An LU factorisation of a dense A, shape (n, n), with partial pivoting. The equations of a few unknowns are
/// solved here: Eigen's general routines would spend more time on their blocks and temporaries than on the
/// arithmetic (two unknowns of dynamic size, factored once and solved eight times: 70 instead of 250 ns).
/// @tparam Matrix  Eigen matrix of real or complex numbers, fixed or dynamic size
template <class Matrix>
class DenseLu {
 public:
  using Scalar = typename Matrix::Scalar;
  using Real = typename Eigen::NumTraits<Scalar>::Real;

  /// The only call that allocates, but for a fixed size beyond 16; factor() makes it when n has changed.
  void resize(Eigen::Index n) {
    factors_.resize(n, n);
    if constexpr (may_be_large) {
      if (!is_small(n)) return large_.resize(n);
    }
    pivots_.resize(n);
  }

  /// P A = L U.
  /// @returns false when A is singular or not finite; solve() must not be called then
  bool factor(const Matrix& A) {
    if (A.rows() != factors_.rows()) resize(A.rows());
    if constexpr (may_be_large) {
      if (!is_small(A.rows())) return large_.factor(A);
    }
    // Up to 16 unknowns: our own elimination.
    factors_ = A;
    // One unknown: A is its own factor.
    if constexpr (fixed == 1) return is_pivot(A(0, 0));
    return A.rows() == 2 ? eliminate_two() : eliminate();
  }

  /// x = A^-1 x, shape (n): row exchanges and forward substitution with L, then backward substitution with
  /// U.
  template <class Vector>
  void solve(Vector& x) {
    if constexpr (fixed == 1) {
      x /= factors_(0, 0);
      return;
    }
    if constexpr (may_be_large) {
      if (!is_small(factors_.rows())) return large_.solve(x);
    }
    // L z = P x
    const Eigen::Index n = size();
    const Scalar* column = factors_.data();
    for (Eigen::Index k = 0; k + 1 < n; ++k, column += n) {
      std::swap(x[k], x[pivots_[k]]);
      for (Eigen::Index i = k + 1; i < n; ++i) x[i] -= column[i] * x[k];
    }
    // U x = z, the diagonal holding 1 / u_kk
    for (Eigen::Index k = n; k-- > 0; column -= n) {
      x[k] *= column[k];
      for (Eigen::Index i = 0; i < k; ++i) x[i] -= column[i] * x[k];
    }
  }

 private:
  /// largest_small: unknowns up to which eliminate() is used.
  static constexpr Eigen::Index fixed = Matrix::RowsAtCompileTime, largest_small = 16;
  /// Blocks pay off where several numbers fill a register, which those of long double do not.
  static constexpr bool may_be_large =
      std::is_same_v<Real, double> && (fixed == Eigen::Dynamic || fixed > largest_small);
  static constexpr bool is_small(Eigen::Index n) { return n <= largest_small; }
  [[nodiscard]] Eigen::Index size() const { return fixed == Eigen::Dynamic ? factors_.rows() : fixed; }

  /// Gaussian elimination by columns. Multipliers stand below the diagonal and stay where they arose; on the
  /// diagonal stand the reciprocals of the pivots. What is not finite spreads through the eliminated rows
  /// into a pivot, so pivots are all that needs a look.
  bool eliminate() {
    const Eigen::Index n = size();
    Scalar* column = factors_.data();
    for (Eigen::Index k = 0; k < n; ++k, column += n) {
      // The largest entry on or below the diagonal.
      Eigen::Index pivot = k;
      for (Eigen::Index i = k + 1; i < n; ++i)
        if (std::abs(column[i]) > std::abs(column[pivot])) pivot = i;
      if (!is_pivot(column[pivot])) return false;
      pivots_[k] = pivot;
      std::swap(column[k], column[pivot]);
      column[k] = Scalar(1) / column[k];
      // l_ik = a_ik / u_kk
      for (Eigen::Index i = k + 1; i < n; ++i) column[i] *= column[k];
      for (Eigen::Index j = k + 1; j < n; ++j) {
        Scalar* other = factors_.data() + j * n;
        std::swap(other[k], other[pivot]);
        // a_ij -= l_ik u_kj
        for (Eigen::Index i = k + 1; i < n; ++i) other[i] -= column[i] * other[k];
      }
    }
    return true;
  }

  /// The same for two unknowns, without loops.
  bool eliminate_two() {
    // A = (f_0, f_2; f_1, f_3), by columns.
    Scalar* const f = factors_.data();
    const bool exchange = std::abs(f[1]) > std::abs(f[0]);
    const Scalar a = exchange ? f[1] : f[0], b = exchange ? f[3] : f[2];
    const Scalar reciprocal = Scalar(1) / a, multiplier = (exchange ? f[0] : f[1]) * reciprocal;
    const Scalar last = (exchange ? f[2] : f[3]) - multiplier * b;
    pivots_[0] = exchange;
    pivots_[1] = 1;
    f[0] = reciprocal;
    f[1] = multiplier;
    f[2] = b;
    f[3] = Scalar(1) / last;
    return is_pivot(a) && is_pivot(last);
  }

  /// Whether x can be divided by: neither zero nor subnormal, infinite or NaN.
  static bool is_pivot(Scalar x) {
    const Real size = std::abs(x);
    return size >= std::numeric_limits<Real>::min() && size <= std::numeric_limits<Real>::max();
  }

  using Pivots = Eigen::Matrix<Eigen::Index, Matrix::RowsAtCompileTime, 1>;
  /// In the place of BlockedLu where the size is fixed and small.
  struct Nothing {};

  /// L below the diagonal, U above it, 1 / u_kk on it.
  Matrix factors_ = blank_matrix<Matrix>();
  /// Row pivots_[k] was exchanged with row k in step k.
  Pivots pivots_ = blank_matrix<Pivots>();
  [[no_unique_address]] std::conditional_t<may_be_large, BlockedLu<Scalar>, Nothing> large_;
};

/// Solves A x = b, shape (n, n): dense by LU with partial pivoting, sparse by what fits the matrix.
/// @tparam Matrix  dense or sparse Eigen matrix, ShiftedMechanical, an operator, or a variant of these
template <class Matrix>
class LinearSolver {
 public:
  static constexpr bool is_sparse = std::is_base_of_v<Eigen::SparseMatrixBase<Matrix>, Matrix>;

  LinearSolver() = default;
  /// A copy is a solver without a factorisation: factors belong to one run.
  LinearSolver(const LinearSolver& other) : choice_(other.choice_) {}
  LinearSolver& operator=(const LinearSolver& other) {
    choice_ = other.choice_;
    return *this;
  }
  LinearSolver(LinearSolver&&) noexcept = default;
  LinearSolver& operator=(LinearSolver&&) noexcept = default;
  ~LinearSolver() = default;

  /// How symmetric sparse equations are solved.
  void set(LinearSolve choice) { choice_ = choice; }

  /// Makes room for dense equations of n unknowns, so that factor() allocates nothing.
  void resize(Eigen::Index n) {
    if constexpr (!is_sparse) solver_.resize(n);
  }

  /// @returns false when A is singular or not finite; solve() must not be called then
  bool factor(const Matrix& A) {
    if constexpr (is_sparse) {
      if (!solver_) solver_ = std::make_unique<SparseSolver<typename Matrix::Scalar>>();
      solver_->set(choice_);
      return solver_->factor(A);
    } else {
      return solver_.factor(A);
    }
  }

  /// Whether the A that was factored is sparse and symmetric, and solved as such.
  [[nodiscard]] bool is_symmetric() const {
    if constexpr (is_sparse)
      return solver_ && solver_->is_symmetric();
    else
      return false;
  }

  /// x = A^-1 x, shape (n). Dense: allocates nothing.
  /// @returns iterations of conjugate gradients, 0 where factors solve
  template <class Vector>
  int solve(Vector& x) {
    if constexpr (is_sparse) {
      return solver_->solve(x);
    } else {
      solver_.solve(x);
      return 0;
    }
  }

 private:
  /// Sparse solvers are made when the first matrix comes: they are large.
  template <bool Sparse, class M>
  struct Choose {
    using type = DenseLu<M>;
  };
  template <class M>
  struct Choose<true, M> {
    using type = std::unique_ptr<SparseSolver<typename M::Scalar>>;
  };
  typename Choose<is_sparse, Matrix>::type solver_;
  LinearSolve choice_;
};

/// (I - s J)(q, v) = (b, d) of a mechanical system, by its n velocities:
///   (M + s C + s^2 K) v = M d - s K b,   q = b + s v.
template <class Scalar>
class LinearSolver<ShiftedMechanical<Scalar>> {
 public:
  using Vector = Eigen::Vector<Scalar, Eigen::Dynamic>;

  /// How the reduced equations are solved, where they are symmetric.
  void set(LinearSolve choice) { solver_.set(choice); }

  /// Factors M + s C + s^2 K.
  /// @returns false when it is singular or not finite; solve() must not be called then
  bool factor(const ShiftedMechanical<Scalar>& A) {
    // K is needed until the last solve: copied, since a matrix may move between factor() and solve().
    s_ = A.s;
    mass_ = A.mass;
    if (!detail::copy_sparse(A.stiffness, stiffness_)) in_space_ = blocks_.read(stiffness_);
    return solver_.factor(A.reduced);
  }

  /// x = (b, d) in, (I - s J)^-1 (b, d) out, shape (2 n).
  /// @returns iterations of conjugate gradients, 0 where factors solve
  template <class X>
  int solve(X& x) {
    const Eigen::Index n = mass_.size();
    moved_ = x.head(n);
    velocity_.resize(n);
    // K b; by blocks of 3 x 3 where K has them and is symmetric, since multiply() reads columns as rows.
    if (in_space_ && solver_.is_symmetric())  // K then is, as M and C are
      blocks_.multiply(stiffness_, moved_, velocity_);
    else
      velocity_.noalias() = stiffness_ * moved_;
    // M d - s K b
    if (mass_.is_diagonal())
      velocity_ = mass_.diagonal().template cast<Scalar>().cwiseProduct(x.tail(n)) - s_ * velocity_;
    else
      velocity_ = mass_.times(Vector(x.tail(n))) - s_ * velocity_;
    const int iterations = solver_.solve(velocity_);
    x.tail(n) = velocity_;
    // q = b + s v
    x.head(n) = moved_ + s_ * velocity_;
    return iterations;
  }

 private:
  Scalar s_{};
  /// M and K of the last factor(), shape (n, n).
  MassMatrix<typename Eigen::NumTraits<Scalar>::Real> mass_;
  Eigen::SparseMatrix<typename Eigen::NumTraits<Scalar>::Real> stiffness_;
  BlockStructure<3> blocks_;  ///< of K, if that is made of them
  bool in_space_ = false;     ///< K is made of blocks
  LinearSolver<Eigen::SparseMatrix<Scalar>> solver_;
  Vector moved_, velocity_;
};

/// (I + c C + k K) x = b by the structure whose operators these are, in its own way.
template <>
class LinearSolver<OperatorSum> {
 public:
  void set(LinearSolve /*choice*/) {}
  bool factor(const OperatorSum& A) {
    inverse_ = A.structure->inverse(A.c, A.k);
    return inverse_ != nullptr;
  }
  /// x = (I + c C + k K)^-1 x, shape (n).
  /// @returns iterations
  int solve(Eigen::VectorXd& x) { return inverse_->apply(x.data()); }

 private:
  std::shared_ptr<StructureOperator::Inverse> inverse_;
};

/// (I - s J)(q, v) = (b, d) as of a mechanical system, with masses of one:
///   (I + s C + s^2 K) v = d - s K b,   q = b + s v.
template <>
class LinearSolver<ShiftedOperator> {
 public:
  void set(LinearSolve /*choice*/) {}
  bool factor(const ShiftedOperator& A) {
    A_ = A.reduced;
    return solver_.factor(A_);
  }
  /// x = (b, d) in, (I - s J)^-1 (b, d) out, shape (2 n).
  /// @returns iterations
  /// @throws ComplexEquations  for numbers that are no double
  template <class X>
  int solve(X& x) {
    if constexpr (std::is_same_v<typename X::Scalar, double>) {
      const Eigen::Index n = x.size() / 2;
      velocity_.resize(n);
      A_.structure->stiffness_times(x.data(), velocity_.data());
      velocity_ = x.tail(n) - A_.c * velocity_;
      const int iterations = solver_.solve(velocity_);
      x.tail(n) = velocity_;
      x.head(n) += A_.c * velocity_;
      return iterations;
    } else {
      throw ComplexEquations();
    }
  }

 private:
  OperatorSum A_;
  LinearSolver<OperatorSum> solver_;
  Eigen::VectorXd velocity_;
};

/// The same for a matrix whose kind is chosen at run time. A change of kind makes a new solver.
template <class... Matrices>
class LinearSolver<std::variant<Matrices...>> {
 public:
  void set(LinearSolve choice) { choice_ = choice; }
  /// @returns false when A is singular or not finite; solve() must not be called then
  bool factor(const std::variant<Matrices...>& A) {
    return std::visit(
        [&]<class Matrix>(const Matrix& held) {
          LinearSolver<Matrix>& solver = detail::alternative<LinearSolver<Matrix>>(solver_);
          solver.set(choice_);
          return solver.factor(held);
        },
        A);
  }
  /// x = A^-1 x, shape (n).
  /// @returns iterations of conjugate gradients, 0 where factors solve
  template <class Vector>
  int solve(Vector& x) {
    return std::visit([&](auto& solver) { return solver.solve(x); }, solver_);
  }

 private:
  std::variant<LinearSolver<Matrices>...> solver_;
  LinearSolve choice_;
};

}  // namespace hmax
