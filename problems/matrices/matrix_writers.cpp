#include "problems/matrices/matrix_writers.hpp"

#include "core/own_files.hpp"
#include "problems/digits.hpp"
#include "problems/matrix_entries.hpp"

namespace hmax {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

bool is_exactly_symmetric(const Sparse& matrix) {
  if (matrix.rows() != matrix.cols()) return false;
  const Sparse difference = matrix - Sparse(matrix.transpose());
  bool equal = true;
  each_entry(difference, [&](Eigen::Index, Eigen::Index, double value) { equal = equal && value == 0; });
  return equal;
}

template <class Number>
void append(std::string& text, Number number, char behind) {
  append_digits(text, number);
  text += behind;
}

}  // namespace

std::string matrix_market_text(const Sparse& matrix, const std::string& comment) {
  const bool symmetric = is_exactly_symmetric(matrix);
  const auto is_written = [&](Eigen::Index i, Eigen::Index j) { return !symmetric || i >= j; };
  Eigen::Index count = 0;
  each_entry(matrix, [&](Eigen::Index i, Eigen::Index j, double) { count += is_written(i, j) ? 1 : 0; });
  std::string text = std::string("%%MatrixMarket matrix coordinate real ") +
                     (symmetric ? "symmetric" : "general") + "\n% " + comment + ", " + std::string(own_mark) +
                     "\n";
  append(text, matrix.rows(), ' ');
  append(text, matrix.cols(), ' ');
  append(text, count, '\n');
  each_entry(matrix, [&](Eigen::Index i, Eigen::Index j, double value) {
    if (!is_written(i, j)) return;
    append(text, i + 1, ' ');
    append(text, j + 1, ' ');
    append(text, value, '\n');
  });
  return text;
}

}  // namespace hmax
