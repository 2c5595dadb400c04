/// Sparse matrices made of small dense blocks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

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
    // starts[j]: first entry of column j; rows[p]: row of entry p.
    const int *starts = A.outerIndexPtr(), *rows = A.innerIndexPtr();
    for (Eigen::Index b = 0; b < A.cols() / B; ++b) {
      const int first = starts[B * b], length = starts[B * b + 1] - first;
      if (length % B != 0) return false;
      // The B columns of a block column have one pattern.
      for (int c = 1; c < B; ++c)
        if (starts[B * b + c + 1] - starts[B * b + c] != length ||
            !std::equal(rows + first, rows + first + length, rows + starts[B * b + c]))
          return false;
      // Their rows come in groups b B, b B + 1, ..., b B + B - 1.
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

  /// y = A x for a symmetric A of this structure, shape (n): by columns, which are its rows. A may have
  /// another scalar than x; y is sized by the caller.
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
        // total_c += sum_r A(r, c) x_r of one block
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

}  // namespace hmax
