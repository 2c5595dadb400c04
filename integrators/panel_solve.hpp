/// Triangular solutions with the factors of a sparse symmetric matrix, column by column where they are
/// alone and panel by panel where they are alike.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// The factors of P A P^T = L D L^T, arranged to be solved with again and again. Columns of L that have the
/// same rows below them make a panel, which is stored as a dense matrix: one list of rows serves them all,
/// and arithmetic runs over numbers that lie side by side. The unknowns of one point of a body in space
/// always share a panel. With a factor of 70,000 entries that takes half the time that it takes by columns.
/// @source [davis2016survey] 9
template <class Scalar>
class PanelSolve {
 public:
  using Index = int;
  using Sparse = Eigen::SparseMatrix<Scalar>;
  using Vector = Eigen::Vector<Scalar, Eigen::Dynamic>;

  /// @param L            strictly lower part, rows ascending in each column, shape (n, n)
  /// @param d            the diagonal of D, shape (n)
  /// @param permutation  P: unknown i of A is unknown permutation[i] of L
  template <class Diagonal, class Permutation>
  void build(const Sparse& L, const Diagonal& d, const Permutation& permutation) {
    const auto n = static_cast<Index>(L.cols());
    const int *starts = L.outerIndexPtr(), *rows = L.innerIndexPtr();
    const auto length = [&](Index j) { return starts[j + 1] - starts[j]; };
    panels_.clear();
    rows_.clear();
    values_.clear();
    Index tallest = 0;
    for (Index first = 0; first < n;) {
      Index last = first;
      while (last + 1 < n && length(last) == length(last + 1) + 1 && rows[starts[last]] == last + 1 &&
             std::equal(rows + starts[last] + 1, rows + starts[last + 1], rows + starts[last + 1]))
        ++last;
      const Index width = last - first + 1, height = length(last);
      panels_.push_back({first, width, height, rows_.size(), values_.size()});
      rows_.insert(rows_.end(), rows + starts[last], rows + starts[last + 1]);
      // The triangle above the panel first, column by column, then the panel.
      for (Index j = first; j <= last; ++j)
        values_.insert(values_.end(), L.valuePtr() + starts[j], L.valuePtr() + starts[j] + (last - j));
      for (Index j = first; j <= last; ++j)
        values_.insert(values_.end(), L.valuePtr() + starts[j] + (last - j), L.valuePtr() + starts[j + 1]);
      tallest = std::max(tallest, height);
      first = last + 1;
    }
    inverse_ = d.cwiseInverse();
    to_.assign(static_cast<std::size_t>(n), 0);
    for (Index i = 0; i < n; ++i)
      to_[i] = permutation.size() > 0 ? static_cast<Index>(permutation.indices()[i]) : i;
    x_.resize(n);
    part_.resize(tallest);
  }

  /// x = A^-1 x, shape (n). No allocation.
  template <class X>
  void solve(X& x) {
    for (std::size_t i = 0; i < to_.size(); ++i) x_[to_[i]] = x[static_cast<Eigen::Index>(i)];
    Scalar* const all = x_.data();
    Scalar* const part = part_.data();
    for (const Panel& panel : panels_) {
      Scalar* const own = all + panel.first;
      const Scalar* value = values_.data() + panel.values;
      for (Index j = 0; j < panel.width; ++j)
        for (Index i = j + 1; i < panel.width; ++i) own[i] -= *value++ * own[j];
      const Index* const rows = rows_.data() + panel.rows;
      const Index m = panel.height;
      if (m == 0) continue;
      std::fill_n(part, m, Scalar(0));
      Index j = 0;
      for (; j + 3 <= panel.width; j += 3, value += 3 * m) {
        const Scalar a = own[j], b = own[j + 1], c = own[j + 2];
        const Scalar *p = value, *q = value + m, *r = value + 2 * m;
        for (Index i = 0; i < m; ++i) part[i] += p[i] * a + q[i] * b + r[i] * c;
      }
      for (; j < panel.width; ++j, value += m) {
        const Scalar a = own[j];
        for (Index i = 0; i < m; ++i) part[i] += value[i] * a;
      }
      for (Index i = 0; i < m; ++i) all[rows[i]] -= part[i];
    }
    x_.array() *= inverse_.array();
    for (auto at = panels_.rbegin(); at != panels_.rend(); ++at) {
      const Panel& panel = *at;
      Scalar* const own = all + panel.first;
      const Index* const rows = rows_.data() + panel.rows;
      const Index m = panel.height, triangle = panel.width * (panel.width - 1) / 2;
      const Scalar* value = values_.data() + panel.values + triangle;
      for (Index i = 0; i < m; ++i) part[i] = all[rows[i]];
      for (Index j = 0; j < panel.width; ++j, value += m) own[j] -= dot(value, part, m);
      value = values_.data() + panel.values + triangle;
      for (Index j = panel.width; j-- > 0;) {
        value -= panel.width - 1 - j;
        for (Index i = j + 1; i < panel.width; ++i) own[j] -= value[i - j - 1] * own[i];
      }
    }
    for (std::size_t i = 0; i < to_.size(); ++i) x[static_cast<Eigen::Index>(i)] = x_[to_[i]];
  }

 private:
  struct Panel {
    Index first, width, height;
    std::size_t rows, values;
  };

  /// In four sums, since one would wait for itself.
  static Scalar dot(const Scalar* a, const Scalar* b, Index n) {
    Scalar sums[4]{};
    Index i = 0;
    for (; i + 4 <= n; i += 4)
      for (Index k = 0; k < 4; ++k) sums[k] += a[i + k] * b[i + k];
    for (; i < n; ++i) sums[0] += a[i] * b[i];
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
  }

  std::vector<Panel> panels_;
  std::vector<Index> rows_, to_;
  std::vector<Scalar> values_;
  Vector inverse_, x_, part_;
};

}  // namespace hmax
