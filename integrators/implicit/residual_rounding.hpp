/// What rounding of f leaves of the corrections of Newton's method, estimated from the Jacobian.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <variant>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "integrators/mechanical.hpp"
#include "integrators/state.hpp"
#include "integrators/system.hpp"

namespace hmax {

namespace detail {
/// out = |J| x with the absolute values of J, shape (n).
template <class Derived, class Vector>
void absolute_product(const Eigen::MatrixBase<Derived>& J, const Vector& x, Vector& out) {
  // By columns: Eigen would make a matrix of the absolute values first.
  out.setZero();
  for (Eigen::Index j = 0; j < J.cols(); ++j) out += x[j] * J.col(j).cwiseAbs();
}
/// Sparse J, column by column.
template <class Scalar, int Options, class Index, class Vector>
void absolute_product(const Eigen::SparseMatrix<Scalar, Options, Index>& J, const Vector& x, Vector& out) {
  using std::abs;
  out.setZero(J.rows());
  for (Eigen::Index j = 0; j < J.outerSize(); ++j)
    for (typename Eigen::SparseMatrix<Scalar, Options, Index>::InnerIterator entry(J, j); entry; ++entry)
      out[entry.row()] += abs(entry.value()) * x[entry.col()];
}
/// |J| (q, v) = (v, M^-1 (|K| q + |C| v)) for q, v >= 0: M has positive entries. Of one that couples its
/// diagonal is taken, which is as large as M to a factor of about two.
template <class Real, class Vector>
void absolute_product(const MechanicalJacobian<Real>& J, const Vector& x, Vector& out) {
  const Eigen::Index n = J.mass.size();
  using Half = Eigen::Vector<Real, Eigen::Dynamic>;
  const Half q = x.head(n), v = x.tail(n);
  Half of_K, of_C;
  absolute_product(J.stiffness, q, of_K);
  absolute_product(J.damping, v, of_C);
  out.head(n) = v;
  out.tail(n) = (of_K + of_C).cwiseQuotient(J.mass.diagonal());
}
/// Operators show no entries: their largest eigenvalues in place of |K| and |C|.
template <class Vector>
void absolute_product(const OperatorJacobian& J, const Vector& x, Vector& out) {
  using Real = real_of<Vector>;
  const Eigen::Index n = x.size() / 2;
  out.head(n) = x.tail(n);
  out.tail(n) = static_cast<Real>(J.structure->largest_stiffness()) * x.head(n) +
                static_cast<Real>(J.structure->largest_damping()) * x.tail(n);
}
/// The kind of J that the variant holds.
template <class... Matrices, class Vector>
void absolute_product(const std::variant<Matrices...>& J, const Vector& x, Vector& out) {
  std::visit([&](const auto& held) { absolute_product(held, x, out); }, J);
}
}  // namespace detail

/// The correction (I - s J)^-1 s df that rounding of f makes of a stage equation that is solved, where
///   |df_i| <= eps (|f_i| + sum_j |J_ij| (|Y_j| + |z_j| + |X_j|))
/// is the rounding of f in a point whose numbers are known to eps, and X are the larger numbers that f adds
/// to its state (OffsetSystem). Signs alternate without order, as those of rounding do. Corrections that are
/// at most `margin` times as large are taken for rounding: on bodies they vary by a factor of 3 about the
/// estimate.
/// @tparam StateT  Eigen column vector, shape (n)
template <class StateT>
class ResidualRounding {
 public:
  using State = StateT;
  using Real = real_of<State>;
  /// Factor on the estimate below which a correction counts as rounding.
  static constexpr Real margin = 8;
  /// Share of the numbers of the state (|Y| or |X|) above which a correction is no rounding.
  static constexpr Real most_of_state = Real(0.1);

  /// Takes |X| where the system has an offset; forgets the correction.
  template <System Sys>
  void init(const Sys& system) {
    offset_.setZero(system.dim());
    if constexpr (OffsetSystem<Sys>)
      if (has_offset(system)) system.offset(offset_);
    numbers_ = correction_ = offset_;
    id_ = 0;
  }

  /// The norm of that correction; 0 where it is larger than most_of_state.
  /// @param system    whose f that is
  /// @param estimate  whether it is worth a product and a solution to know it: else 0 unless it is known for
  ///                  this matrix and numbers of the size of Y
  /// @param J         the Jacobian with the number `id`, as in Linearisation
  /// @param z         s f(Y), shape (n)
  /// @param norm      of corrections, as NewtonNorm
  /// @param solve     solve(x) makes x = (I - s J)^-1 x
  template <System Sys, class Matrix, class Norm, class Solve>
  Real operator()(const Sys& system, bool estimate, const Matrix& J, std::int64_t id, Real s, const State& Y,
                  const State& z, const Norm& norm, const Solve& solve) {
    const Real size = norm.largest(system, Y);
    if (id != id_ || s != s_ || size > 2 * size_ || size < size_ / 2) {
      if (!estimate) return 0;
      id_ = id;
      s_ = s;
      size_ = size;
      make(J, Y, z);
      solve(correction_);
      // Where f is rounded to more than its state nothing is known: an iterate has run away.
      const Real known = most_of_state * std::max(size, norm.largest(system, offset_));
      if (!(norm.largest(system, correction_) <= known)) correction_.setZero();
    }
    return std::sqrt(norm.squared(system, correction_, Y));
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) { visit(id_, s_, size_, correction_); }

 private:
  /// margin s df in correction_.
  template <class Matrix>
  void make(const Matrix& J, const State& Y, const State& z) {
    using std::abs;
    // numbers_ = |X| + |Y| + |z|, then margin eps (|s| |J| numbers_ + |z|) with z = s f.
    numbers_ = offset_;
    for (Eigen::Index i = 0; i < Y.size(); ++i) numbers_[i] += abs(Y[i]) + abs(z[i]);
    correction_ = numbers_;
    detail::absolute_product(J, numbers_, correction_);
    constexpr Real unit = margin * std::numeric_limits<Real>::epsilon();
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      // The high bits of a product with the golden ratio are without order.
      const bool up = (static_cast<std::uint64_t>(i + 1) * 0x9E3779B97F4A7C15u >> 63) != 0;
      correction_[i] = (up ? unit : -unit) * (abs(s_) * correction_[i] + abs(z[i]));
    }
  }

  /// |X|, the sizes of the numbers that f reads, and the correction, shape (n).
  State offset_ = blank_state<State>(), numbers_ = offset_, correction_ = offset_;
  /// Of which matrix and size of Y the correction is.
  std::int64_t id_ = 0;
  /// s of the matrix, and max |Y| for which the correction was estimated.
  Real s_ = 0, size_ = 0;
};

}  // namespace hmax
