/// Conjugate gradients for sparse symmetric positive definite equations, preconditioned by an incomplete
/// block Cholesky factorisation.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// A sparse symmetric matrix seen as blocks of B x B, which bodies in space have with B = 3: the entries are
/// read where they stand, since the B columns of a block have one pattern and its rows stand side by side.
template <int B>
struct BlockStructure {
  std::vector<int> outer, inner;  ///< of the blocks: starts of block columns, and block rows in them

  /// Takes the pattern of a compressed A.
  /// @returns false when it is not made of such blocks
  template <class Matrix>
  bool read(const Matrix& A) {
    if (A.cols() % B != 0) return false;
    outer.assign(1, 0);
    inner.clear();
    const int *starts = A.outerIndexPtr(), *rows = A.innerIndexPtr();
    for (Eigen::Index b = 0; b < A.cols() / B; ++b) {
      const int first = starts[B * b], length = starts[B * b + 1] - first;
      if (length % B != 0) return false;
      for (int c = 1; c < B; ++c)
        if (starts[B * b + c + 1] - starts[B * b + c] != length ||
            !std::equal(rows + first, rows + first + length, rows + starts[B * b + c]))
          return false;
      for (int p = first; p < first + length; p += B) {
        if (rows[p] % B != 0) return false;
        for (int r = 1; r < B; ++r)
          if (rows[p + r] != rows[p] + r) return false;
        inner.push_back(rows[p] / B);
      }
      outer.push_back(static_cast<int>(inner.size()));
    }
    return true;
  }

  /// y = A x for a symmetric A of this structure, shape (n): by columns, which are its rows.
  template <class Matrix, class X, class Y>
  void multiply(const Matrix& A, const X& x, Y& y) const {
    const auto* values = A.valuePtr();
    const auto* from = x.data();
    for (std::size_t b = 0; b + 1 < outer.size(); ++b) {
      decltype(values) column[B];
      typename Y::Scalar total[B] = {};
      for (int c = 0; c < B; ++c) column[c] = values + A.outerIndexPtr()[B * b + c];
      for (int k = outer[b]; k < outer[b + 1]; ++k) {
        const auto* part = from + B * inner[k];
        for (int c = 0; c < B; ++c) {
          auto dot = column[c][0] * part[0];
          for (int r = 1; r < B; ++r) dot += column[c][r] * part[r];
          total[c] += dot;
          column[c] += B;
        }
      }
      for (int c = 0; c < B; ++c) y[B * b + c] = total[c];
    }
  }
};

/// L L^T ~ A with blocks only where A has them, A symmetric.
/// @source [saad2003iterative] 10.3, with blocks for numbers
template <class Real, int B>
class IncompleteCholesky {
 public:
  using Block = Eigen::Matrix<Real, B, B>;
  using Part = Eigen::Matrix<Real, B, 1>;

  /// Makes room for the lower half of the pattern.
  void analyse(const BlockStructure<B>& pattern) {
    const std::size_t n = pattern.outer.size() - 1;
    outer_.assign(1, 0);
    inner_.clear();
    source_.clear();
    for (std::size_t i = 0; i < n; ++i) {  // by rows: those of the symmetric matrix are its columns
      for (int p = pattern.outer[i]; p < pattern.outer[i + 1]; ++p)
        if (pattern.inner[p] < static_cast<int>(i)) {
          inner_.push_back(pattern.inner[p]);
          source_.push_back(p - pattern.outer[i]);
        }
      outer_.push_back(static_cast<int>(inner_.size()));
    }
    lower_.resize(inner_.size());
    inverse_.resize(n);
    diagonal_.assign(n, -1);
    for (std::size_t i = 0; i < n; ++i)
      for (int p = pattern.outer[i]; p < pattern.outer[i + 1]; ++p)
        if (pattern.inner[p] == static_cast<int>(i)) diagonal_[i] = p - pattern.outer[i];
  }

  /// @returns false when A has no diagonal, or one that is not positive definite
  template <class Matrix>
  bool factor(const Matrix& A) {
    const int n = static_cast<int>(inverse_.size());
    for (int i = 0; i < n; ++i) {
      if (diagonal_[i] < 0) return false;
      const Block whole = block(A, i, diagonal_[i]);
      Block d = whole;
      for (int p = outer_[i]; p < outer_[i + 1]; ++p) {
        const int j = inner_[p];
        Block b = block(A, i, source_[p]);
        int a = outer_[i], c = outer_[j];
        while (a < p && c < outer_[j + 1]) {
          if (inner_[a] == inner_[c])
            b.noalias() -= lower_[a++] * lower_[c++].transpose();
          else
            inner_[a] < inner_[c] ? ++a : ++c;
        }
        lower_[p].noalias() = b * inverse_[j].transpose();
        d.noalias() -= lower_[p] * lower_[p].transpose();
      }
      // What was left out may have left too little: the block of A itself is safe.
      if (!invert(d, inverse_[i]) && !invert(whole, inverse_[i])) return false;
    }
    return true;
  }

  /// z = (L L^T)^-1 r, shape (n).
  template <class Vector>
  void apply(const Vector& r, Vector& z) const {
    const int n = static_cast<int>(inverse_.size());
    for (int i = 0; i < n; ++i) {
      Part sum = r.template segment<B>(B * i);
      for (int p = outer_[i]; p < outer_[i + 1]; ++p)
        sum.noalias() -= lower_[p] * z.template segment<B>(B * inner_[p]);
      z.template segment<B>(B * i).noalias() = inverse_[i] * sum;
    }
    for (int i = n - 1; i >= 0; --i) {
      const Part x = inverse_[i].transpose() * z.template segment<B>(B * i);
      z.template segment<B>(B * i) = x;
      for (int p = outer_[i]; p < outer_[i + 1]; ++p)
        z.template segment<B>(B * inner_[p]).noalias() -= lower_[p].transpose() * x;
    }
  }

 private:
  /// The block (i, j) of the lower half: the transposed one above the diagonal, the k-th of block column i.
  template <class Matrix>
  static Block block(const Matrix& A, int i, int k) {
    Block out;
    for (int c = 0; c < B; ++c) {
      const Real* column = A.valuePtr() + A.outerIndexPtr()[B * i + c] + B * k;
      for (int r = 0; r < B; ++r) out(c, r) = column[r];
    }
    return out;
  }

  /// The inverse of the Cholesky factor of d.
  static bool invert(const Block& d, Block& inverse) {
    const Eigen::LLT<Block> llt(d);
    if (llt.info() != Eigen::Success) return false;
    inverse.setIdentity();
    llt.matrixL().solveInPlace(inverse);
    return inverse.allFinite();
  }

  std::vector<int> outer_, inner_;  // strictly lower blocks by rows
  std::vector<int> source_;         // where each stands in its block row of A
  std::vector<int> diagonal_;       // the same for the diagonal
  std::vector<Block> lower_;        // L below its diagonal
  std::vector<Block> inverse_;      // of the diagonal blocks of L
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
  /// @returns false when A has diagonal blocks that are not positive definite
  bool prepare(const Matrix& A) {
    if (!same_pattern(A)) {
      A_ = A;
      A_.makeCompressed();
      by_three_ = three_.pattern.read(A_);
      if (by_three_)
        three_.factor.analyse(three_.pattern);
      else if (one_.pattern.read(A_))
        one_.factor.analyse(one_.pattern);
      for (Vector* v : {&r_, &z_, &p_, &q_}) v->resize(A.rows());
    } else {
      std::copy_n(A.valuePtr(), A.nonZeros(), A_.valuePtr());
    }
    return by_three_ ? three_.factor.factor(A_) : one_.factor.factor(A_);
  }

  [[nodiscard]] const Matrix& matrix() const { return A_; }

  struct End {
    bool solved;  ///< |b - A x| <= tolerance |b|
    int iterations;
  };

  /// @param most  iterations at most; 0: as many as it takes, with a bound that only rounding reaches
  template <class B, class X>
  End solve(const B& b, X& x, double tolerance, int most) {
    return by_three_ ? iterate(three_, b, x, tolerance, most) : iterate(one_, b, x, tolerance, most);
  }

 private:
  template <int Size>
  struct Parts {
    BlockStructure<Size> pattern;
    IncompleteCholesky<Real, Size> factor;
  };

  [[nodiscard]] bool same_pattern(const Matrix& A) const {
    return A.rows() == A_.rows() && A.nonZeros() == A_.nonZeros() &&
           std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.outerSize() + 1, A_.outerIndexPtr()) &&
           std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), A_.innerIndexPtr());
  }

  template <int Size, class B, class X>
  End iterate(const Parts<Size>& parts, const B& b, X& x, double tolerance, int most) {
    r_ = b;
    x.setZero(b.size());
    const Real goal = static_cast<Real>(tolerance) * r_.norm();
    if (!(r_.norm() > 0)) return {r_.norm() == 0, 0};
    const int limit =
        most > 0 ? most : static_cast<int>(std::min<Eigen::Index>(10 * b.size() + 100, 100'000));
    parts.factor.apply(r_, z_);
    p_ = z_;
    Real rz = r_.dot(z_);
    for (int k = 1; k <= limit; ++k) {
      parts.pattern.multiply(A_, p_, q_);
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
  bool by_three_ = false;
  Parts<3> three_;
  Parts<1> one_;
  Vector r_, z_, p_, q_;
};

}  // namespace hmax
