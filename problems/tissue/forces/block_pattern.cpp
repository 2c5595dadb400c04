#include "problems/tissue/forces/block_pattern.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "problems/mesh/at.hpp"

namespace hmax {

BlockPattern::BlockPattern(std::vector<Index> free, const MeshEdges& pairs)
    : free_(std::move(free)), stride_(free_.size(), 0) {
  const auto count = at(free_.empty() ? 0 : *std::max_element(free_.begin(), free_.end()) + 1);
  // Rows by column, counted, filled in and then sorted without the repeated ones.
  std::vector<std::size_t> end(count + 1, 0);
  const auto each_entry = [&](const auto& visit) {
    for (std::size_t j = 0; j < count; ++j) visit(static_cast<Index>(j), static_cast<Index>(j));
    for (const auto& pair : pairs.colwise()) {
      const Index i = free_[at(pair[0])], j = free_[at(pair[1])];
      if (i < 0 || j < 0 || i == j) continue;
      visit(i, j);
      visit(j, i);
    }
  };
  each_entry([&](Index, Index j) { ++end[at(j) + 1]; });
  for (std::size_t j = 0; j < count; ++j) end[j + 1] += end[j];
  std::vector<Index> all(end.back());
  std::vector<std::size_t> next(end.begin(), end.end() - 1);
  each_entry([&](Index i, Index j) { all[next[at(j)]++] = i; });

  rows_.reserve(all.size());
  for (std::size_t j = 0; j < count; ++j) {
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(end[j]);
    const auto to = all.begin() + static_cast<std::ptrdiff_t>(end[j + 1]);
    std::sort(from, to);
    rows_.insert(rows_.end(), from, std::unique(from, to));
    if (rows_.size() > std::numeric_limits<Index>::max() / 9)
      throw std::invalid_argument("the stiffness matrix has more than " +
                                  std::to_string(std::numeric_limits<Index>::max()) +
                                  " entries, more than its indices can count; use a smaller mesh");
    const auto own = std::lower_bound(rows_.begin() + first_.back(), rows_.end(), static_cast<Index>(j));
    lower_.push_back(lower_.back() + static_cast<Index>(rows_.end() - own) - 1);
    first_.push_back(static_cast<Index>(rows_.size()));
  }
  for (std::size_t point = 0; point < free_.size(); ++point)
    if (const Index j = free_[point]; j >= 0) stride_[point] = 3 * (first_[at(j) + 1] - first_[at(j)]);
}

BlockPattern::Index BlockPattern::slot(Index i, Index j) const {
  const Index row = free_[at(i)], column = free_[at(j)];
  if (row < 0 || column < 0) return -1;
  const auto from = rows_.begin() + first_[at(column)], to = rows_.begin() + first_[at(column) + 1];
  const auto place = std::lower_bound(from, to, row);
  return 9 * first_[at(column)] + 3 * static_cast<Index>(place - from);
}

BlockPattern::Index BlockPattern::pair(Index i, Index j) const {
  const Index a = free_[at(i)], b = free_[at(j)], low = std::min(a, b), high = std::max(a, b);
  if (low < 0) return -1;
  const auto to = rows_.begin() + first_[at(low) + 1];
  const auto from = to - (lower_[at(low) + 1] - lower_[at(low)]);
  return lower_[at(low)] + static_cast<Index>(std::lower_bound(from, to, high) - from);
}

void BlockPattern::begin(Index column, Pairs& pairs) const {
  pairs.next.resize(at(columns()));
  for (std::size_t j = 0; j < pairs.next.size(); ++j) {
    Index block = lower_[j];
    if (static_cast<Index>(j) < column) {
      const auto to = rows_.begin() + first_[j + 1], from = to - (lower_[j + 1] - lower_[j]);
      block += static_cast<Index>(std::lower_bound(from, to, column) - from);
    }
    pairs.next[j] = block % pairs.ring;
  }
}

void BlockPattern::skip(Index begin, Index end, Pairs& pairs) const {
  for (std::size_t j = at(begin); j < at(end); ++j) {
    const Index own = first_[j + 1] - (lower_[j + 1] - lower_[j]) - 1;
    for (Index k = first_[j]; k < own; ++k) std::fill_n(pairs.take(pairs.next[at(rows_[at(k)])]), 12, 0.0);
  }
}

void BlockPattern::write(Index begin, Index end, Pairs& pairs, double* values) const {
  for (std::size_t j = at(begin); j < at(end); ++j) {
    const Index from = first_[j], count = first_[j + 1] - from, step = 3 * count;
    const Index own = count - 1 - (lower_[j + 1] - lower_[j]);
    double* const column = values + 9 * static_cast<std::ptrdiff_t>(from);
    double sum[9];
    std::copy_n(pairs.diagonal.data() + 9 * (j - at(begin)), 9, sum);
    const auto put = [&](Index k, const double(&block)[9]) {
      for (Index c = 0; c < 3; ++c)
        for (Index r = 0; r < 3; ++r) {
          column[c * step + 3 * k + r] = block[3 * c + r];
          sum[3 * c + r] -= block[3 * c + r];
        }
    };
    double block[9];
    // Above the diagonal stand the transposed blocks (j, i): in each column the next one.
    for (Index k = 0; k < own; ++k) {
      double* const pair = pairs.take(pairs.next[at(rows_[at(from + k)])]);
      for (Index c = 0; c < 3; ++c)
        for (Index r = 0; r < 3; ++r) block[3 * c + r] = pair[4 * r + c];
      std::fill_n(pair, 12, 0.0);
      put(k, block);
    }
    Index place = pairs.next[j];
    for (Index k = own + 1; k < count; ++k) {
      const double* const pair = pairs.take(place);
      for (Index c = 0; c < 3; ++c)
        for (Index r = 0; r < 3; ++r) block[3 * c + r] = pair[4 * c + r];
      put(k, block);
    }
    // Symmetric but for rounding.
    for (Index c = 0; c < 3; ++c)
      for (Index r = 0; r < 3; ++r) column[c * step + 3 * own + r] = (sum[3 * c + r] + sum[3 * r + c]) / 2;
  }
}

void BlockPattern::clear(Matrix& A) const {
  shape(A);
  std::fill_n(A.valuePtr(), entries(), 0.0);
}

void BlockPattern::shape(Matrix& A) const {
  const Index n = dofs(), columns = n / 3;
  bool same = A.rows() == n && A.cols() == n && A.isCompressed() && A.nonZeros() == entries();
  for (Index j = 0; same && j < columns; ++j) {
    const Index blocks = first_[at(j) + 1] - first_[at(j)];
    for (Index c = 0; c < 3; ++c)
      same = same && A.outerIndexPtr()[3 * j + c] == 9 * first_[at(j)] + 3 * c * blocks;
    // Without a branch for each block: this reads a third of the row numbers of the matrix each time.
    const auto* found = A.innerIndexPtr() + std::ptrdiff_t{9} * first_[at(j)];
    const Index* wanted = rows_.data() + first_[at(j)];
    Index different = 0;
    for (Index k = 0; k < (same ? blocks : 0); ++k)
      different |= found[std::ptrdiff_t{3} * k] ^ (3 * wanted[k]);
    same = same && different == 0;
  }
  if (!same) {
    A.resize(n, n);
    A.resizeNonZeros(entries());
    Index* row = A.innerIndexPtr();
    for (Index j = 0; j < columns; ++j) {
      const Index from = first_[at(j)], to = first_[at(j) + 1];
      for (Index c = 0; c < 3; ++c) {
        A.outerIndexPtr()[3 * j + c] = 9 * from + 3 * c * (to - from);
        for (Index k = from; k < to; ++k)
          for (Index r = 0; r < 3; ++r) *row++ = 3 * rows_[at(k)] + r;
      }
    }
    A.outerIndexPtr()[n] = entries();
  }
}

}  // namespace hmax
