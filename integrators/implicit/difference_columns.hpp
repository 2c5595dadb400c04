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
template <class Matrix, class Column>
class ResolvedDifferences {
 public:
  using Real = typename Eigen::NumTraits<typename Column::Scalar>::Real;

  /// @param J        differences with the increments `delta`, shape (n, n)
  /// @param f        at the state, shape (n)
  /// @param delta    shape (n)
  /// @param trusted  share of an entry below which rounding is small
  ResolvedDifferences(Matrix& J, const Column& f, Real trusted) : J_(J), trusted_(trusted) {
    rounding_ = 2 * std::numeric_limits<Real>::epsilon() * f.cwiseAbs().template cast<Real>();
  }

  /// @param size  of the state: the largest |y_j|
  /// @param take  take(j, delta, column): the differences of column j with this increment; false where f is
  /// not finite
  /// @returns the number of columns that were taken
  template <class Increments, class Take>
  int resolve(Increments& delta, Real size, const Take& take) {
    if (!rounding_.allFinite()) return 0;
    // With increments that are small beside the state f hides little: the usual case, which ends here.
    noise_ = rounding_ * delta.template cast<Real>().cwiseInverse().transpose();
    measure();
    int taken = 0;
    Column column = J_.col(0);
    constexpr int most = 12;
    for (Eigen::Index j = 0; j < J_.cols(); ++j) {
      const Real first = delta[j];
      for (int rung = 0; rung < most && is_hidden(j); ++rung) {
        const Real next = std::min<Real>(1000 * delta[j], largest_increment(first, size));
        if (!(next > delta[j]) || !take(j, next, column)) break;
        delta[j] = next;
        ++taken;
        for (Eigen::Index i = 0; i < J_.rows(); ++i)
          if (is_hidden(i, j)) {
            J_(i, j) = column[i];
            noise_(i, j) = rounding_[i] / delta[j];
          }
        measure();
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
  void measure() {
    rows_.setZero(J_.rows());
    columns_.setZero(J_.cols());
    for (Eigen::Index j = 0; j < J_.cols(); ++j)
      for (Eigen::Index i = 0; i < J_.rows(); ++i) {
        const Real size = std::abs(J_(i, j));
        if (!(size > 8 * noise_(i, j))) continue;
        rows_[i] = std::max(rows_[i], size);
        columns_[j] = std::max(columns_[j], size);
      }
  }
  [[nodiscard]] bool is_hidden(Eigen::Index i, Eigen::Index j) const {
    // Of a row that nothing is known of the column decides, and the other way round.
    const Real beside = rows_[i] > 0 && columns_[j] > 0 ? std::min(rows_[i], columns_[j]) : Real(0);
    return noise_(i, j) > trusted_ * beside && noise_(i, j) > trusted_ * std::abs(J_(i, j));
  }
  [[nodiscard]] bool is_hidden(Eigen::Index j) const {
    for (Eigen::Index i = 0; i < J_.rows(); ++i)
      if (is_hidden(i, j)) return true;
    return false;
  }

  Matrix& J_;
  Real trusted_;
  Eigen::Vector<Real, Eigen::Dynamic> rounding_, rows_, columns_;
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> noise_;
};

}  // namespace hmax::detail
