/// The linear equations of implicit methods: matrices that are dense or sparse, known at compile time or
/// chosen at run time, factored once and solved often.
#pragma once

#include <cmath>
#include <memory>
#include <type_traits>
#include <variant>

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>

namespace hmax {

namespace detail {
template <class Matrix, class Scalar>
struct WithScalar {
  using type = Eigen::Matrix<Scalar, Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime>;
};
template <class From, int Options, class Index, class Scalar>
struct WithScalar<Eigen::SparseMatrix<From, Options, Index>, Scalar> {
  using type = Eigen::SparseMatrix<Scalar, Options, Index>;
};
template <class... Matrices, class Scalar>
struct WithScalar<std::variant<Matrices...>, Scalar> {
  using type = std::variant<typename WithScalar<Matrices, Scalar>::type...>;
};

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

/// The same kind of matrix with another scalar: complex where a method needs complex shifts.
template <class Matrix, class Scalar>
using with_scalar = typename detail::WithScalar<Matrix, Scalar>::type;

/// A = I - s J. Its scalar may be complex where that of J is real.
/// @param J  shape (n, n), dense, sparse or a variant of both
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

/// A = diag(m) + c C + k K: the matrix of a second-order method, with m the lumped masses, shape (n).
template <class Vector, class Matrix, class Real>
void set_combination(const Vector& m, Real c, const Matrix& C, Real k, const Matrix& K, Matrix& A) {
  if constexpr (detail::is_variant<Matrix>) {
    std::visit(
        [&]<class Alternative>(const Alternative& held) {
          set_combination(m, c, std::get<Alternative>(C), k, held, detail::alternative<Alternative>(A));
        },
        K);
  } else if constexpr (std::is_base_of_v<Eigen::SparseMatrixBase<Matrix>, Matrix>) {
    Matrix mass(m.size(), m.size());
    mass.setIdentity();
    mass.diagonal() = m;
    A = mass + c * C + k * K;
  } else {
    A = c * C + k * K;
    A.diagonal() += m;
  }
}

/// An LU factorisation of A, shape (n, n): dense with partial pivoting, sparse with a fill-reducing ordering
/// that is analysed once and again only when the number of entries changes.
template <class Matrix>
class LinearSolver {
 public:
  using Scalar = typename Matrix::Scalar;
  static constexpr bool is_sparse = std::is_base_of_v<Eigen::SparseMatrixBase<Matrix>, Matrix>;

  LinearSolver() = default;
  /// A copy is a solver without a factorisation: factors belong to one run.
  LinearSolver(const LinearSolver&) {}
  LinearSolver& operator=(const LinearSolver&) { return *this; }
  LinearSolver(LinearSolver&&) noexcept = default;
  LinearSolver& operator=(LinearSolver&&) noexcept = default;
  ~LinearSolver() = default;

  /// @returns false when A is singular or not finite; solve() must not be called then
  bool factor(const Matrix& A) {
    if constexpr (is_sparse) {
      if (!lu_) lu_ = std::make_unique<Factors>();
      if (analysed_ != A.nonZeros()) {
        lu_->analyzePattern(A);
        analysed_ = A.nonZeros();
      }
      for (Eigen::Index i = 0; i < A.nonZeros(); ++i)
        if (!std::isfinite(std::abs(A.valuePtr()[i]))) return false;
      lu_->factorize(A);
      return lu_->info() == Eigen::Success;
    } else {
      if (!A.allFinite()) return false;
      lu_.compute(A);
      const auto pivots = lu_.matrixLU().diagonal().cwiseAbs();
      return pivots.allFinite() && pivots.minCoeff() > 0;
    }
  }

  /// x = A^-1 x, shape (n). Dense: allocates nothing after the first solution of this size.
  template <class Vector>
  void solve(Vector& x) {
    if constexpr (is_sparse) {
      x = lu_->solve(x).eval();
    } else if constexpr (Matrix::RowsAtCompileTime == 1) {
      x /= lu_.matrixLU()(0, 0);
    } else {
      permuted_ = lu_.permutationP() * x;
      lu_.matrixLU().template triangularView<Eigen::UnitLower>().solveInPlace(permuted_);
      lu_.matrixLU().template triangularView<Eigen::Upper>().solveInPlace(permuted_);
      x = permuted_;
    }
  }

 private:
  template <bool Sparse, class M>
  struct Choose {
    using type = Eigen::PartialPivLU<M>;
  };
  template <class M>
  struct Choose<true, M> {
    using type = Eigen::SparseLU<M, Eigen::COLAMDOrdering<typename M::StorageIndex>>;
  };
  using Factors = typename Choose<is_sparse, Matrix>::type;
  std::conditional_t<is_sparse, std::unique_ptr<Factors>, Factors> lu_;
  Eigen::Matrix<Scalar, Matrix::RowsAtCompileTime, 1> permuted_;
  Eigen::Index analysed_ = -1;
};

/// The same for a matrix that is dense or sparse by choice at run time.
template <class... Matrices>
class LinearSolver<std::variant<Matrices...>> {
 public:
  bool factor(const std::variant<Matrices...>& A) {
    return std::visit(
        [&]<class Matrix>(const Matrix& held) {
          return detail::alternative<LinearSolver<Matrix>>(solver_).factor(held);
        },
        A);
  }
  template <class Vector>
  void solve(Vector& x) {
    std::visit([&](auto& solver) { solver.solve(x); }, solver_);
  }

 private:
  std::variant<LinearSolver<Matrices>...> solver_;
};

}  // namespace hmax
