/// Derivatives of f as methods ask for them: the system's own where it has them, differences where not.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/SparseCore>

#include "integrators/implicit/difference_columns.hpp"
#include "integrators/linear/linear_solver.hpp"
#include "integrators/state.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// When a method takes a new Jacobian.
struct JacobianUpdate {
  static constexpr int automatic = -1, frozen = 0;
  /// automatic: the method's own rule; frozen: that of the start, for the whole run; K >= 1: at the start of
  /// every K-th step, so that 1 is the exact one.
  int every = automatic;

  bool operator==(const JacobianUpdate&) const = default;
};

namespace detail {
/// The increment of a forward difference of a quantity of size |y|: sqrt(eps) max(|y|, scale), which
/// balances truncation O(delta) and rounding O(eps / delta).
template <class Real>
Real difference_increment(Real y, Real scale) {
  using std::abs, std::sqrt;
  const Real delta = sqrt(std::numeric_limits<Real>::epsilon()) * std::max(abs(y), scale);
  // What is added is the difference of two machine numbers: t + delta - t is exact then.
  volatile Real moved = y + delta;
  return moved - y;
}

/// The increment of a difference in time: sqrt(eps) max(|t|, |h|) in the direction of the step h, and no more
/// than a thousandth of h, within which f changes little. Steps of a few roundings of t are taken whole.
template <class Real>
Real time_increment(Real t, Real h) {
  using std::abs, std::copysign, std::sqrt;
  const Real wanted = sqrt(std::numeric_limits<Real>::epsilon()) * std::max(abs(t), abs(h));
  volatile Real moved = t + copysign(std::min(wanted, abs(h) / 1024), h);
  if (moved == t) moved = t + h;
  return moved - t;
}
}  // namespace detail

/// A system that declares where its Jacobian can be nonzero: `sparsity` writes a matrix of shape (dim, dim)
/// with an entry wherever some f_i depends on y_j; the values do not matter. Differences then take columns
/// without a common row together.
template <class S>
concept PatternedSystem = System<S> &&
    requires(const S& system, Eigen::SparseMatrix<real_of<typename S::State>>& pattern) {
  system.sparsity(pattern);
};

/// Whether a system declares its pattern; an erased one answers at run time.
template <System S>
constexpr bool has_sparsity(const S& system) {
  if constexpr (requires { system.has_sparsity(); })
    return system.has_sparsity();
  else
    return PatternedSystem<S>;
}

/// The columns of a sparse matrix in groups whose members have no row in common: each column in turn joins
/// the first group that takes it [curtis1974estimation]. One difference then gives all columns of a group.
class ColumnGroups {
 public:
  /// No groups: of an empty pattern.
  ColumnGroups() = default;
  /// @param pattern  shape (n, n)
  /// @cost  for each entry the entries before it in its row
  template <class Real>
  explicit ColumnGroups(const Eigen::SparseMatrix<Real>& pattern)
      : group_(static_cast<std::size_t>(pattern.cols())) {
    using Entries = typename Eigen::SparseMatrix<Real>::InnerIterator;
    const Eigen::SparseMatrix<Real> rows = pattern.transpose();  // column i holds the entries of row i
    std::vector<Eigen::Index> taken_for;                         // by group: the last column it refused
    for (Eigen::Index j = 0; j < pattern.cols(); ++j) {
      for (Entries entry(pattern, j); entry; ++entry)
        for (Entries other(rows, entry.row()); other && other.row() < j; ++other)
          taken_for[of(other.row())] = j;
      std::size_t group = 0;
      // The first group without a row of column j.
      while (group < taken_for.size() && taken_for[group] == j) ++group;
      if (group == taken_for.size()) taken_for.push_back(-1);
      group_[static_cast<std::size_t>(j)] = group;
    }
    members_.resize(taken_for.size());
    for (Eigen::Index j = 0; j < pattern.cols(); ++j) members_[of(j)].push_back(j);
  }

  /// The columns of each group.
  [[nodiscard]] const std::vector<std::vector<Eigen::Index>>& members() const { return members_; }

 private:
  [[nodiscard]] std::size_t of(Eigen::Index column) const { return group_[static_cast<std::size_t>(column)]; }

  std::vector<std::size_t> group_;  ///< by column
  /// Columns of each group.
  std::vector<std::vector<Eigen::Index>> members_;
};

namespace detail {
/// Whether a slope is infinite. What is not a number is a mistake of the system, which methods tell.
template <class Slopes>
bool has_infinite(const Slopes& slopes) {
  for (Eigen::Index i = 0; i < slopes.size(); ++i)
    if (std::isinf(std::abs(slopes[i]))) return true;
  return false;
}

/// Has `write` fill a matrix of the type Own that a system knows, and leaves the result in J, which may be of
/// more kinds. What J held of these kinds goes in, so that patterns are kept.
template <class Own, class Matrix, class Write>
void write_as(Matrix& J, const Write& write) {
  if constexpr (std::is_same_v<Matrix, Own>) {
    write(J);
  } else {
    Own own;
    std::visit(
        [&]<class Held>(Held& held) {
          if constexpr (may_hold<Held, Own>) own.template emplace<Held>().swap(held);
        },
        J);
    write(own);
    std::visit([&]<class Held>(Held& held) { alternative<Held>(J).swap(held); }, own);
  }
}
}  // namespace detail

/// df/dy of a system, from its verb `jacobian`, or by forward differences: column by column, those that
/// rounding hides again with larger increments, or by groups of columns where the system declares its
/// pattern. Slopes of a dense `jacobian` that are infinite become differences. Of second-order systems with
/// sparse matrices: these.
/// @tparam Matrix  jacobian_type or equations_type of the system
template <class State, class Matrix>
class JacobianSource {
 public:
  using Real = real_of<State>;

  /// Prepares differences where the system has no Jacobian: pattern, column groups and vectors.
  template <System Sys>
  void init(const Sys& system) {
    looks_for_hidden_ = true;
    searched_ = 0;
    // A system with a Jacobian of its own needs no memory for differences.
    if (has_jacobian(system)) return;
    f0_.resize(system.dim());
    f1_.resize(system.dim());
    moved_.resize(system.dim());
    if constexpr (PatternedSystem<Sys>)
      if (has_sparsity(system)) {
        system.sparsity(pattern_);
        pattern_.makeCompressed();
      }
    if constexpr (is_sparse)
      if (pattern_.size() == 0)  // a sparse matrix of whose pattern nothing is known is full
        pattern_ = jacobian_of<Vector>::Ones(system.dim(), system.dim()).sparseView();
    groups_ = ColumnGroups(pattern_);
    increments_.resize(system.dim());
    if (pattern_.size() == 0) hidden_.resize(system.dim());
  }

  /// J = df/dy at (t, y), shape (n, n). Differences cost one evaluation of f for each column, or each group
  /// of columns, and one more where f0 is not given: J_ij = (f_i(t, y + delta_j e_j) - f_i(t, y)) /
  /// delta_j.
  /// @param J   keeps its pattern from call to call
  /// @param f0  f(t, y) if it is known
  template <System Sys>
  void evaluate(const Sys& system, Real t, const State& y, Matrix& J, const State* f0 = nullptr) {
    // Operators or parts of a second-order system first, then its own Jacobian, then differences.
    if constexpr (detail::is_mechanical<Matrix>) {
      write_parts(system, t, y, J);
    } else {
      if constexpr (detail::may_hold<OperatorJacobian, Matrix>)
        if (auto structure = structure_operator_of(system)) {
          J = OperatorJacobian{std::move(structure)};
          return;
        }
      if constexpr (detail::may_hold<MechanicalJacobian<Real>, Matrix>)
        if (system.dofs() > 0 && has_sparse_matrices(system)) return write_parts(system, t, y, J);
      if constexpr (DifferentiableSystem<Sys>)
        if (has_jacobian(system)) {
          detail::write_as<jacobian_type<Sys>>(J, [&](auto& own) { system.jacobian(t, y, own); });
          if (Dense* dense = dense_of(J); dense != nullptr && !dense->allFinite())
            replace_infinite(system, t, y, *dense);
          return;
        }
      if (f0 == nullptr) {
        system.rhs(t, y, f0_);
        f0 = &f0_;
      }
      // moved_ is y but for the columns of the difference at hand.
      moved_ = y;
      if (pattern_.size() > 0) return grouped_differences(system, t, y, *f0, J);
      if constexpr (!is_sparse) differences(system, t, y, *f0, J);
    }
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) { visit(looks_for_hidden_, searched_); }

 private:
  using Dense = jacobian_of<State>;
  using Sparse = Eigen::SparseMatrix<typename State::Scalar>;
  using Vector = Eigen::Vector<Real, Eigen::Dynamic>;
  static constexpr bool is_sparse = std::is_same_v<Matrix, Sparse>;

  /// J as the alternative Wanted, emplaced where a variant holds another one.
  template <class Wanted>
  static Wanted& as(Matrix& J) {
    if constexpr (detail::is_variant<Matrix>)
      return detail::alternative<Wanted>(J);
    else
      return J;
  }

  /// J where it is dense, else null.
  static Dense* dense_of(Matrix& J) {
    if constexpr (std::is_same_v<Matrix, Dense>)
      return &J;
    else if constexpr (detail::is_variant<Matrix>)
      return std::get_if<Dense>(&J);
    else
      return nullptr;
  }

  /// At the end of a domain, as of sqrt(y) at 0, a slope is infinite and a difference into the domain is not:
  /// with that a step of an implicit method leaves the place. Takes memory, which no other Jacobian does.
  template <System Sys>
  static void replace_infinite(const Sys& system, Real t, const State& y, Dense& J) {
    State f = y, moved = y, f_moved = y;
    system.rhs(t, y, f);
    const Real scale = scale_of(y);
    for (Eigen::Index j = 0; j < y.size(); ++j)
      for (const Real side : {Real(1), Real(-1)}) {
        if (!detail::has_infinite(J.col(j))) break;
        const Real delta = side * increment(y, j, scale);
        moved[j] = y[j] + delta;
        system.rhs(t, moved, f_moved);
        moved[j] = y[j];
        if (!f_moved.allFinite()) continue;
        for (Eigen::Index i = 0; i < y.size(); ++i)
          if (std::isinf(std::abs(J(i, j)))) J(i, j) = (f_moved[i] - f[i]) / delta;
      }
  }

  /// M, K and C in the place of J. M is taken once, since it is constant.
  template <System Sys>
  void write_parts(const Sys& system, Real t, const State& y, Matrix& J) {
    using Parts = MechanicalJacobian<Real>;
    const Eigen::Index n = system.dofs();
    Parts& parts = as<Parts>(J);
    if (parts.mass.size() != n) parts.mass = mass_of(system);
    positions_ = y.head(n);
    velocities_ = y.tail(n);
    // The matrix lends its memory to a variant and takes it back, so that patterns are kept.
    const auto write = [](auto&& verb, Eigen::SparseMatrix<Real>& into) {
      if constexpr (detail::is_variant<typename Sys::DofMatrix>) {
        typename Sys::DofMatrix matrix;
        matrix.template emplace<Eigen::SparseMatrix<Real>>().swap(into);
        verb(matrix);
        into.swap(std::get<Eigen::SparseMatrix<Real>>(matrix));
      } else {
        verb(into);
      }
    };
    write([&](auto& K) { system.stiffness(t, positions_, velocities_, K); }, parts.stiffness);
    write([&](auto& C) { system.damping(t, positions_, velocities_, C); }, parts.damping);
  }

  /// Components far below the others are moved as one of 1e-5 of the largest. A state of 0 has no size: there
  /// as one of 1e-8.
  static Real scale_of(const State& y) {
    const Real largest = y.size() > 0 ? Real(y.cwiseAbs().maxCoeff()) : Real(0);
    return largest > 0 ? Real(1e-5) * largest : Real(1e-8);
  }
  /// delta_j = sqrt(eps) max(|y_j|, scale).
  static Real increment(const State& y, Eigen::Index j, Real scale) {
    using std::abs;
    return detail::difference_increment<Real>(Eigen::numext::real(y[j]), std::max(Real(abs(y[j])), scale));
  }

  /// Column j by one evaluation at y + delta_j e_j.
  template <System Sys>
  void differences(const Sys& system, Real t, const State& y, const State& f0, Matrix& J) {
    Dense& out = as<Dense>(J);
    out.resize(y.size(), y.size());
    const Real scale = scale_of(y);
    for (Eigen::Index j = 0; j < y.size(); ++j) {
      increments_[j] = increment(y, j, scale);
      moved_[j] = y[j] + increments_[j];
      system.rhs(t, moved_, f1_);
      out.col(j) = (f1_ - f0) / increments_[j];
      moved_[j] = y[j];
    }
    // A search that goes on in every Jacobian finds nothing.
    if (y.size() > detail::most_resolved_columns || !looks_for_hidden_) return;
    const auto take = [&](Eigen::Index j, Real delta, State& column) {
      moved_[j] = y[j] + delta;
      system.rhs(t, moved_, f1_);
      column = (f1_ - f0) / (moved_[j] - y[j]);
      moved_[j] = y[j];
      return column.allFinite();
    };
    const int taken = hidden_.resolve(out, f0, increments_, y.cwiseAbs().maxCoeff(), take);
    searched_ += taken;
    looks_for_hidden_ = searched_ < 100 * y.size();
  }

  /// The same by groups of columns, into a dense J or the entries of a sparse one.
  template <System Sys>
  void grouped_differences(const Sys& system, Real t, const State& y, const State& f0, Matrix& J) {
    if constexpr (std::is_same_v<Matrix, Dense>) {
      J.setZero(y.size(), y.size());
      each_entry(system, t, y, f0,
                 [&](Eigen::Index i, Eigen::Index j, Eigen::Index, auto value) { J(i, j) = value; });
    } else {
      Sparse& out = as<Sparse>(J);
      // The pattern at the first call; then values alone.
      if (out.rows() != pattern_.rows() || out.nonZeros() != pattern_.nonZeros())
        out = pattern_.template cast<typename State::Scalar>();
      each_entry(system, t, y, f0,
                 [&](Eigen::Index, Eigen::Index, Eigen::Index n, auto value) { out.valuePtr()[n] = value; });
    }
  }

  /// Calls set(i, j, n, value) for the entry (i, j), the n-th of the pattern.
  template <System Sys, class Set>
  void each_entry(const Sys& system, Real t, const State& y, const State& f0, const Set& set) {
    const Real scale = scale_of(y);
    for (Eigen::Index j = 0; j < y.size(); ++j) increments_[j] = increment(y, j, scale);
    for (const auto& group : groups_.members()) {
      // Each f_i depends on at most one column of the group.
      for (const Eigen::Index j : group) moved_[j] = y[j] + increments_[j];
      system.rhs(t, moved_, f1_);
      for (const Eigen::Index j : group) {
        moved_[j] = y[j];
        for (Eigen::Index n = pattern_.outerIndexPtr()[j]; n < pattern_.outerIndexPtr()[j + 1]; ++n) {
          const Eigen::Index i = pattern_.innerIndexPtr()[n];
          set(i, j, n, (f1_[i] - f0[i]) / increments_[j]);
        }
      }
    }
  }

  /// f(t, y), f at the moved state, and the moved state, shape (n).
  State f0_ = blank_state<State>(), f1_ = f0_, moved_ = f0_;
  /// q and v of a packed state, shape (n / 2).
  Eigen::Vector<Real, Eigen::Dynamic> positions_, velocities_;
  Eigen::SparseMatrix<Real> pattern_;  ///< empty: unknown, so every entry
  /// Columns that are moved together.
  ColumnGroups groups_;
  Vector increments_;  ///< of the columns
  /// Columns that rounding hides, and whether they are looked for.
  detail::ResolvedDifferences<State> hidden_{Real(1e-4)};
  bool looks_for_hidden_ = true;
  Eigen::Index searched_ = 0;  ///< evaluations that this took
};

/// dfdt = partial f / partial t at (t, y), shape (n): the system's own, with the secant over the step where
/// that is infinite; zero for autonomous systems; or a one-sided difference, which costs one evaluation of f.
/// It is taken inside of the step, and so on the near side of whatever the step ends at.
/// @param h   the step from t, in whose direction the difference is taken; not 0
/// @param f0  f(t, y)
template <System Sys>
void evaluate_time_derivative(const Sys& system, real_of<typename Sys::State> t,
                              real_of<typename Sys::State> h, const typename Sys::State& y,
                              const typename Sys::State& f0, typename Sys::State& dfdt) {
  using Real = real_of<typename Sys::State>;
  if (is_autonomous(system)) {
    dfdt.setZero(y.size());
    return;
  }
  if constexpr (TimeDifferentiableSystem<Sys>)
    if (has_time_derivative(system)) {
      system.time_derivative(t, y, dfdt);
      if (!detail::has_infinite(dfdt)) return;
      // At the end of a domain, as of t^0.3 at 0, a slope is infinite and the secant over the step is not.
      typename Sys::State f_end = y;
      system.rhs(t + h, y, f_end);
      for (Eigen::Index i = 0; i < y.size(); ++i)
        if (std::isinf(std::abs(dfdt[i]))) dfdt[i] = (f_end[i] - f0[i]) / h;
      return;
    }
  const Real delta = detail::time_increment(t, h);
  system.rhs(t + delta, y, dfdt);
  // partial f / partial t = (f(t + delta, y) - f0) / delta
  dfdt = (dfdt - f0) / delta;
}

}  // namespace hmax
