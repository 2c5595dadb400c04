#include "analysis/spectrum/block_product.hpp"

#include <cstddef>

#include "core/parallel_for.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Sparse = Eigen::SparseMatrix<double>;

/// Whether A consists of whole blocks of 3 x 3.
/// Columns 3 j, 3 j + 1 and 3 j + 2 must have the same rows, which must come in aligned groups of three.
/// Costs one pass over the pattern.
bool consists_of_blocks(const Sparse& A) {
  if (A.rows() % 3 != 0) return false;
  // outer[j] is where column j begins in inner (row numbers) and values.
  const int* outer = A.outerIndexPtr();
  const int* inner = A.innerIndexPtr();
  for (Index j = 0; j < A.cols(); j += 3) {
    const int length = outer[j + 1] - outer[j];
    if (length % 3 != 0 || outer[j + 2] - outer[j + 1] != length || outer[j + 3] - outer[j + 2] != length)
      return false;
    for (int k = 0; k < length; ++k) {
      const int row = inner[outer[j] + k];
      // Each group of three begins at a multiple of three and goes on without a gap.
      if (k % 3 == 0 ? row % 3 != 0 : row != inner[outer[j] + k - 1] + 1) return false;
      if (inner[outer[j + 1] + k] != row || inner[outer[j + 2] + k] != row) return false;
    }
  }
  return true;
}

}  // namespace

// An uncompressed matrix is copied first, since the passes need contiguous rows.
SymmetricProduct::SymmetricProduct(const Sparse& matrix, const Eigen::VectorXd& scale) : n_(matrix.rows()) {
  Sparse compressed;
  if (!matrix.isCompressed()) {
    compressed = matrix;
    compressed.makeCompressed();
  }
  const Sparse& A = matrix.isCompressed() ? matrix : compressed;
  blocks_ = consists_of_blocks(A);
  // Columns of a symmetric matrix are its rows.
  const int* outer = A.outerIndexPtr();
  const int* inner = A.innerIndexPtr();
  const double* values = A.valuePtr();
  // s_row A_row,column s_column
  const auto scaled = [&](Index row, int entry) { return scale[row] * values[entry] * scale[inner[entry]]; };
  values_.reserve(static_cast<std::size_t>(A.nonZeros()));
  if (!blocks_) {
    first_.assign(outer, outer + n_ + 1);
    column_.assign(inner, inner + A.nonZeros());
    for (Index row = 0; row < n_; ++row)
      for (int entry = outer[row]; entry < outer[row + 1]; ++entry) values_.push_back(scaled(row, entry));
    return;
  }
  first_.push_back(0);
  for (Index row = 0; row < n_; row += 3) {
    for (int k = 0; k < outer[row + 1] - outer[row]; k += 3) {
      column_.push_back(inner[outer[row] + k]);
      // Entry `entry` of the stored column row + r is that of the same row of A: A is symmetric.
      for (Index r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) values_.push_back(scaled(row + r, outer[row + r] + k + c));
    }
    first_.push_back(static_cast<int>(column_.size()));
  }
}

// One pass over the values in the order in which they are stored; 2 operations for each stored number.
void SymmetricProduct::apply(const double* in, double* out) const {
  parallel_rows(first_.size() - 1, column_.size(), [&](std::size_t begin, std::size_t end) {
    blocks_ ? apply_blocks(in, out, begin, end) : apply_entries(in, out, begin, end);
  });
}

void SymmetricProduct::apply_entries(const double* in, double* out, std::size_t begin,
                                     std::size_t end) const {
  const double* value = values_.data() + first_[begin];
  for (std::size_t row = begin; row < end; ++row) {
    double sum = 0;
    for (int k = first_[row]; k < first_[row + 1]; ++k)
      sum += *value++ * in[column_[static_cast<std::size_t>(k)]];
    out[row] = sum;
  }
}

void SymmetricProduct::apply_blocks(const double* in, double* out, std::size_t begin, std::size_t end) const {
  const double* value = values_.data() + 9 * static_cast<std::size_t>(first_[begin]);
  for (std::size_t row = begin; row < end; ++row) {
    double a = 0, b = 0, c = 0;
    for (int k = first_[row]; k < first_[row + 1]; ++k, value += 9) {
      const double* from = in + column_[static_cast<std::size_t>(k)];
      const double x0 = from[0], x1 = from[1], x2 = from[2];
      // Row by row of a block; parentheses fix the order of the sums.
      a += (value[0] * x0 + value[1] * x1) + value[2] * x2;
      b += (value[3] * x0 + value[4] * x1) + value[5] * x2;
      c += (value[6] * x0 + value[7] * x1) + value[8] * x2;
    }
    out[3 * row] = a;
    out[3 * row + 1] = b;
    out[3 * row + 2] = c;
  }
}

}  // namespace hmax
