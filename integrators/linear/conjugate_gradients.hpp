/// Conjugate gradients for sparse symmetric positive definite equations, preconditioned by an incomplete
/// block Cholesky factorisation.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/process/leaving.hpp"
#include "integrators/linear/block_structure.hpp"

namespace hmax {

namespace detail {
/// Has the processor fetch what lies so many bytes after a block, or before it. It sees by itself where a
/// loop goes through blocks one after the other, but too late: they are small, and what is done with them is
/// short.
inline void fetch_beside(const void* block, std::ptrdiff_t bytes) {
  // The address may lie outside of the array, which only integers may count to.
  // NOLINTNEXTLINE(performance-no-int-to-ptr)
  __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<std::intptr_t>(block) + bytes));
}
inline constexpr std::ptrdiff_t fetched_ahead = 4096;
}  // namespace detail

/// A symmetric matrix by its lower blocks alone, each B x B and in one piece: half the memory to go through.
template <class Real, int B>
class SymmetricBlocks {
 public:
  using Block = Eigen::Matrix<Real, B, B>;
  using Part = Eigen::Matrix<Real, B, 1>;

  std::vector<int> outer{0}, inner;    ///< strictly lower blocks by rows: starts of rows, and columns in them
  std::vector<Block> lower, diagonal;  ///< A_ij, j < i, as in inner, and A_ii

  /// Makes room for the lower half of a pattern.
  /// @param pattern  of the full matrix, block rows ascending in each column
  /// @returns false when a diagonal block is missing
  bool analyse(const BlockStructure<B>& pattern) {
    const std::size_t n = pattern.outer.size() - 1;
    outer.assign(1, 0);
    inner.clear();
    diagonal.resize(n);
    bool full = true;
    for (std::size_t i = 0; i < n; ++i) {  // by rows: those of the symmetric matrix are its columns
      // Those left of the diagonal block: its lower half.
      const int *from = pattern.inner.data() + pattern.outer[i],
                *to = pattern.inner.data() + pattern.outer[i + 1];
      // The diagonal block, or where it is missing the first one after it.
      const int* own = std::lower_bound(from, to, static_cast<int>(i));
      full = full && own != to && *own == static_cast<int>(i);
      inner.insert(inner.end(), from, own);
      outer.push_back(static_cast<int>(inner.size()));
    }
    lower.resize(inner.size());
    return full;
  }

  /// Takes the values of a compressed A of that pattern, those above the diagonal transposed.
  template <class Matrix>
  void take(const Matrix& A) {
    const Real* const values = A.valuePtr();
    for (std::size_t i = 0; i < diagonal.size(); ++i) {
      const Real* column[B];
      for (int c = 0; c < B; ++c) column[c] = values + A.outerIndexPtr()[B * i + c];
      // The next block of the B columns, transposed: the upper half of A, whose columns are rows of the
      // lower one.
      const auto next = [&](Block& block) {
        for (int c = 0; c < B; ++c, column[c - 1] += B)
          for (int r = 0; r < B; ++r) block(c, r) = column[c][r];
      };
      for (int p = outer[i]; p < outer[i + 1]; ++p) next(lower[p]);
      next(diagonal[i]);
    }
  }

  /// y = A x, shape (n): each block below the diagonal serves twice, as itself and transposed.
  template <class X, class Y>
  void multiply(const X& x, Y& y) const {
    for (std::size_t i = 0; i < diagonal.size(); ++i) {
      const Part own = x.template segment<B>(B * i);
      Part sum = diagonal[i] * own;
      for (int p = outer[i]; p < outer[i + 1]; ++p) {
        detail::fetch_beside(&lower[p], detail::fetched_ahead);
        // y_i += A_ij x_j and y_j += A_ij^T x_i, for j < i
        sum += lower[p] * x.template segment<B>(B * inner[p]);
        y.template segment<B>(B * inner[p]) += lower[p].transpose() * own;
      }
      y.template segment<B>(B * i) = sum;
    }
  }
};

/// L L^T ~ A with blocks only where A has them, A symmetric: L_ij for j < i, and L_ii a Cholesky factor.
///   L_ij = (A_ij - sum_k L_ik L_jk^T) L_jj^-T,   L_ii L_ii^T = A_ii - sum_k L_ik L_ik^T
/// @source [saad2003iterative] 10.3, with blocks for numbers; [manteuffel1980incomplete] for the shift
template <class Real, int B>
class IncompleteCholesky {
 public:
  using Block = Eigen::Matrix<Real, B, B>;
  using Part = Eigen::Matrix<Real, B, 1>;

  /// Takes the pattern of A and lists, for each block (i, j), the pairs L_ik, L_jk whose product it takes
  /// up.
  void analyse(const SymmetricBlocks<Real, B>& A) {
    outer_ = A.outer;
    inner_ = A.inner;
    lower_.resize(inner_.size());
    inverse_.resize(A.diagonal.size());
    products_.clear();
    first_product_.assign(1, 0);
    for (std::size_t i = 0; i + 1 < outer_.size(); ++i)
      for (int p = outer_[i]; p < outer_[i + 1]; ++p) {
        const int j = inner_[p];
        // Rows i and j of L: each column k that both have gives a product.
        for (int a = outer_[i], c = outer_[j]; a < p && c < outer_[j + 1];) {
          if (inner_[a] == inner_[c])
            products_.push_back({a++, c++});
          else
            inner_[a] < inner_[c] ? ++a : ++c;
        }
        first_product_.push_back(products_.size());
      }
  }

  /// Factors A + shift diag(A) with the first shift of 0, 1e-3, 2e-3, 4e-3, ... below 1 that works, else
  /// the block diagonal of A alone.
  /// @returns false when a diagonal block of A is not positive definite
  bool factor(const SymmetricBlocks<Real, B>& A) {
    // What is left out may leave too little of a pivot, and then L grows without bound: A with a stronger
    // diagonal has a factor that does not.
    for (Real shift = 0; shift < 1; shift = std::max(Real(1e-3), 2 * shift))
      if (factor(A, shift)) return true;
    for (std::size_t i = 0; i < inverse_.size(); ++i)
      if (!invert(A.diagonal[i], inverse_[i])) return false;
    std::fill(lower_.begin(), lower_.end(), Block::Zero());
    return true;
  }

  /// z = (L L^T)^-1 r, shape (n), by forward and backward substitution with blocks.
  template <class Vector>
  void apply(const Vector& r, Vector& z) const {
    const int n = static_cast<int>(inverse_.size());
    for (int i = 0; i < n; ++i) {
      // L z = r
      Part sum = r.template segment<B>(B * i);
      for (int p = outer_[i]; p < outer_[i + 1]; ++p) {
        detail::fetch_beside(&lower_[p], detail::fetched_ahead);
        sum.noalias() -= lower_[p] * z.template segment<B>(B * inner_[p]);
      }
      z.template segment<B>(B * i).noalias() = inverse_[i] * sum;
    }
    for (int i = n - 1; i >= 0; --i) {
      // L^T z_new = z, in place
      const Part x = inverse_[i].transpose() * z.template segment<B>(B * i);
      z.template segment<B>(B * i) = x;
      // From the last block to the first, as the rows: memory is gone through in one direction.
      for (int p = outer_[i + 1]; p-- > outer_[i];) {
        detail::fetch_beside(&lower_[p], -detail::fetched_ahead);
        z.template segment<B>(B * inner_[p]).noalias() -= lower_[p].transpose() * x;
      }
    }
  }

 private:
  /// The factor of A + shift diag A, row by row of blocks. @returns false where too little of a pivot is
  /// left
  bool factor(const SymmetricBlocks<Real, B>& A, Real shift) {
    for (std::size_t i = 0; i < inverse_.size(); ++i) {
      Block d = (1 + shift) * A.diagonal[i];
      for (int p = outer_[i]; p < outer_[i + 1]; ++p) {
        Block b = A.lower[p];
        // b = A_ij - sum_k L_ik L_jk^T, then L_ij = b L_jj^-T
        for (std::size_t k = first_product_[p]; k < first_product_[p + 1]; ++k)
          b.noalias() -= lower_[products_[k].own] * lower_[products_[k].other].transpose();
        lower_[p].noalias() = b * inverse_[inner_[p]].transpose();
        d.noalias() -= lower_[p] * lower_[p].transpose();
      }
      if (!invert(d, inverse_[i])) return false;
    }
    return true;
  }

  /// The inverse of the Cholesky factor L of d: L L^T = d.
  /// @returns false where d is not positive definite or the inverse not finite
  static bool invert(const Block& d, Block& inverse) {
    using std::sqrt;
    Block L;
    inverse.setZero();
    // Column c of L below the diagonal; the diagonal as 1 / L_cc.
    for (int c = 0; c < B; ++c) {
      Real pivot = d(c, c);
      for (int k = 0; k < c; ++k) pivot -= L(c, k) * L(c, k);
      if (!(pivot > 0)) return false;
      inverse(c, c) = 1 / sqrt(pivot);
      for (int r = c + 1; r < B; ++r) {
        Real entry = d(r, c);
        for (int k = 0; k < c; ++k) entry -= L(r, k) * L(c, k);
        L(r, c) = entry * inverse(c, c);
      }
    }
    // Forward substitution L X = I below the diagonal.
    for (int c = 0; c < B; ++c)
      for (int r = c + 1; r < B; ++r) {
        Real sum = 0;
        for (int k = c; k < r; ++k) sum += L(r, k) * inverse(k, c);
        inverse(r, c) = -sum * inverse(r, r);
      }
    return inverse.allFinite();
  }

  struct Product {
    int own, other;
  };
  std::vector<int> outer_, inner_;          ///< strictly lower blocks by rows
  std::vector<Block> lower_;                ///< L below its diagonal
  std::vector<Block> inverse_;              ///< of the diagonal blocks of L
  std::vector<Product> products_;           ///< of blocks of L that meet in one
  std::vector<std::size_t> first_product_;  ///< of each block
};

/// A x = b for a sparse symmetric positive definite A, shape (n, n), by preconditioned conjugate gradients.
/// Blocks of 3 x 3 are taken where the pattern has them. Nothing is allocated but when the pattern changes.
/// @source [saad2003iterative] algorithm 9.1
template <class Real>
class ConjugateGradients {
 public:
  using Matrix = Eigen::SparseMatrix<Real>;
  using Vector = Eigen::Vector<Real, Eigen::Dynamic>;

  /// Keeps a copy of A and makes its preconditioner.
  /// @param known  A has the pattern of the matrix that was prepared before
  /// @returns false when A has diagonal blocks that are not positive definite
  /// @cost  one incomplete factorisation, or a few where the pivots need a shift
  bool prepare(const Matrix& A, bool known = false) {
    if (known) {
      std::copy_n(A.valuePtr(), A.nonZeros(), A_.valuePtr());
    } else {
      A_ = A;
      A_.makeCompressed();
      BlockStructure<3> threes;
      by_three_ = threes.read(A_);
      if (by_three_) {
        full_ = three_.analyse(threes);
      } else {
        BlockStructure<1> ones;
        full_ = ones.read(A_) && one_.analyse(ones);
      }
      for (Vector* v : {&r_, &z_, &p_, &q_}) v->resize(A.rows());
    }
    return full_ && (by_three_ ? three_.take(A_) : one_.take(A_));
  }

  /// The copy of A.
  [[nodiscard]] const Matrix& matrix() const { return A_; }

  struct End {
    bool solved;  ///< |b - A x| <= tolerance |b|
    int iterations;
  };

  /// Begins at x = 0 and ends at |b - A x| <= tolerance |b|, in Euclidean norms, of the residual that the
  /// iteration updates.
  /// @param most  iterations at most; 0: as many as it takes, with a bound that only rounding reaches
  /// @param x  shape (n)
  /// @returns solved = false also where A shows p^T A p <= 0, so that it is not positive definite
  End solve(const Vector& b, Eigen::Ref<Vector> x, double tolerance, int most) {
    return by_three_ ? iterate(three_, b, x, tolerance, most) : iterate(one_, b, x, tolerance, most);
  }

 private:
  /// A and its preconditioner, in blocks of one size.
  template <int Size>
  struct Parts {
    SymmetricBlocks<Real, Size> A;
    IncompleteCholesky<Real, Size> factor;

    /// @returns false when a diagonal block is missing
    bool analyse(const BlockStructure<Size>& pattern) {
      const bool full = A.analyse(pattern);
      factor.analyse(A);
      return full;
    }
    /// @returns false when a diagonal block is not positive definite
    template <class Matrix>
    bool take(const Matrix& values) {
      A.take(values);
      return factor.factor(A);
    }
  };

  /// With M = L L^T, from x = 0, r = b, p = z = M^-1 r, until |r| <= tolerance |b|:
  ///   alpha = r.z / p.Ap,   x += alpha p,   r_new = r - alpha A p,   z_new = M^-1 r_new,
  ///   p = z_new + (r_new.z_new / r.z) p.
  template <int Size>
  End iterate(const Parts<Size>& parts, const Vector& b, Eigen::Ref<Vector> x, double tolerance, int most) {
    r_ = b;
    x.setZero();
    const Real goal = static_cast<Real>(tolerance) * r_.norm();
    if (!(r_.norm() > 0)) return {r_.norm() == 0, 0};
    // In exact arithmetic n iterations suffice; rounding may take more.
    const int limit =
        most > 0 ? most : static_cast<int>(std::min<Eigen::Index>(10 * b.size() + 100, 100'000));
    parts.factor.apply(r_, z_);
    p_ = z_;
    Real rz = r_.dot(z_);
    for (int k = 1; k <= limit; ++k) {
      leave_when_asked();
      parts.A.multiply(p_, q_);
      // p^T A p
      const Real curvature = p_.dot(q_);
      if (!(curvature > 0) || !(rz > 0)) return {false, k};
      const Real step = rz / curvature;
      x += step * p_;
      r_ -= step * q_;
      if (r_.norm() <= goal) return {true, k};
      parts.factor.apply(r_, z_);
      const Real next = r_.dot(z_);
      p_ = z_ + (next / rz) * p_;
      rz = next;
    }
    return {false, limit};
  }

  Matrix A_;
  bool by_three_ = false, full_ = false;
  Parts<3> three_;
  Parts<1> one_;
  /// r = b - A x, z = M^-1 r, the direction p, and q = A p, shape (n).
  Vector r_, z_, p_, q_;
};

/// Compiled in sparse_solver.cpp: a test would compile it with less optimisation, for the solvers of the
/// program too.
extern template class ConjugateGradients<double>;

}  // namespace hmax
