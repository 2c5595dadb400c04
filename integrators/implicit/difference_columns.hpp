/// Differences of f that rounding hides, taken again with larger increments.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>

namespace hmax::detail {

/// Larger Jacobians are left as they are: the search is made for each column.
inline constexpr Eigen::Index most_resolved_columns = 200;

/// What rounding makes of a difference: entry (i, j) is known to 2 eps |f_i| / delta_j.
/// A column is taken again with an increment a thousand times as large while that is not small beside the
/// entries of the row and of the column that stand out of rounding. Entries that were known before stay as
/// they were, so that a larger increment brings no curvature into them. Beside f of 1e10 and a state of 0,
/// whose size says nothing, this finds what acts. Of a row that depends on nothing there is nothing to find:
/// increments stay beside the state, see largest_increment().
/// @tparam Column  a vector of the type of f
template <class Column>
class ResolvedDifferences {
 public:
  using Real = typename Eigen::NumTraits<typename Column::Scalar>::Real;

  /// @param trusted  share of an entry below which rounding is small
  explicit ResolvedDifferences(Real trusted) : trusted_(trusted) {}

  /// Takes memory for n columns, so that resolve() takes none.
  void resize(Eigen::Index n) {
    if (n > most_resolved_columns) return;
    rounding_.resize(n);
    rows_.resize(n);
    columns_.resize(n);
    noise_.resize(n, n);
    column_.resize(n);
  }

  /// @param J      differences with the increments `delta`, shape (n, n)
  /// @param f      at the state, shape (n)
  /// @param delta  shape (n)
  /// @param size   of the state: the largest |y_j|
  /// @param take   take(j, delta, column): the differences of column j with this increment; false where f is
  /// not finite
  /// @returns the number of columns that were taken
  template <class Matrix, class Increments, class Take>
  int resolve(Matrix& J, const Column& f, Increments& delta, Real size, const Take& take) {
    rounding_ = 2 * std::numeric_limits<Real>::epsilon() * f.cwiseAbs().template cast<Real>();
    if (!rounding_.allFinite()) return 0;
    // With increments that are small beside the state f hides little: the usual case, which ends here.
    for (Eigen::Index j = 0; j < J.cols(); ++j) noise_.col(j) = rounding_ / Real(delta[j]);
    measure(J);
    int taken = 0;
    constexpr int most = 12;
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      const Real first = delta[j];
      for (int rung = 0; rung < most && is_hidden(J, j); ++rung) {
        const Real next = std::min<Real>(1000 * delta[j], largest_increment(first, size));
        if (!(next > delta[j]) || !take(j, next, column_)) break;
        delta[j] = next;
        ++taken;
        for (Eigen::Index i = 0; i < J.rows(); ++i)
          if (is_hidden(J, i, j)) {
            J(i, j) = column_[i];
            noise_(i, j) = rounding_[i] / delta[j];
          }
        measure(J);
      }
    }
    return taken;
  }

 private:
  /// With the increment that is enough rounding is small beside the largest entry that is known. It stays
  /// between a thousandth of the state, beyond which f changes by what is hidden in less than its 12th digit,
  /// and a thousand times the state, beyond which f may be defined nowhere. A state of 0 has no size: there
  /// increments grow by 6 decades, or to what the rates make of it in a nanosecond.
  [[nodiscard]] Real largest_increment(Real first, Real size) const {
    const Real soon = Real(1e-9) * rounding_.maxCoeff() / (2 * std::numeric_limits<Real>::epsilon());
    if (!(size > 0)) return std::max(Real(1e6) * first, soon);
    const Real known = rows_.maxCoeff();
    const Real enough = known > 0 ? rounding_.maxCoeff() / (trusted_ * known) : Real(0);
    return std::clamp(enough, size / 1000, 1000 * std::max(size, soon));
  }
  /// The largest entries of rows and columns that are more than rounding.
  template <class Matrix>
  void measure(const Matrix& J) {
    rows_.setZero();
    columns_.setZero();
    for (Eigen::Index j = 0; j < J.cols(); ++j)
      for (Eigen::Index i = 0; i < J.rows(); ++i) {
        const Real size = std::abs(J(i, j));
        if (!(size > 8 * noise_(i, j))) continue;
        rows_[i] = std::max(rows_[i], size);
        columns_[j] = std::max(columns_[j], size);
      }
  }
  template <class Matrix>
  [[nodiscard]] bool is_hidden(const Matrix& J, Eigen::Index i, Eigen::Index j) const {
    // Of a row that nothing is known of the column decides, and the other way round.
    const Real beside = rows_[i] > 0 && columns_[j] > 0 ? std::min(rows_[i], columns_[j]) : Real(0);
    return noise_(i, j) > trusted_ * beside && noise_(i, j) > trusted_ * std::abs(J(i, j));
  }
  template <class Matrix>
  [[nodiscard]] bool is_hidden(const Matrix& J, Eigen::Index j) const {
    for (Eigen::Index i = 0; i < J.rows(); ++i)
      if (is_hidden(J, i, j)) return true;
    return false;
  }

  Real trusted_;
  Column column_;
  Eigen::Vector<Real, Eigen::Dynamic> rounding_, rows_, columns_;
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> noise_;
};

}  // namespace hmax::detail
