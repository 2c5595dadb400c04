/// The equations of implicit steps of mechanical systems: n unknowns and a symmetric matrix where packed
/// states would give 2 n and none, or operators where nobody has the matrix.
#pragma once

#include <algorithm>
#include <memory>
#include <type_traits>
#include <utility>
#include <variant>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/mass_matrix.hpp"
#include "core/structure_operator.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// The Jacobian of M q'' = F(t, q, v) in its parts, all of n rows:
///   J = ( 0, I; -M^-1 K, -M^-1 C ),   K = -dF/dq,   C = -dF/dv.
/// Of a lumped M, M^-1 divides each row by m_i. Units for tissue: M [kg], K [N/m], C [N s/m].
template <class RealT>
struct MechanicalJacobian {
  using Real = RealT;
  using Scalar = RealT;
  using Sparse = Eigen::SparseMatrix<Real>;
  MassMatrix<Real> mass;      ///< M, shape (n, n)
  Sparse stiffness, damping;  ///< K and C, shape (n, n)

  /// Exchanges memory; no copies.
  void swap(MechanicalJacobian& other) {
    std::swap(mass, other.mass);
    stiffness.swap(other.stiffness);
    damping.swap(other.damping);
  }
  friend void swap(MechanicalJacobian& a, MechanicalJacobian& b) { a.swap(b); }
};

/// I - s J of a mechanical system, reduced to its velocities. Elimination of x = b + s w gives
///   (I - s J)(x, w) = (b, d)   <=>   (M + s C + s^2 K) w = M d - s K b,   x = b + s w.
/// @tparam Scalar  of s; complex where a method needs complex shifts
template <class ScalarT>
struct ShiftedMechanical {
  using Scalar = ScalarT;
  using Real = typename Eigen::NumTraits<Scalar>::Real;
  Scalar s{};                           ///< the shift, h gamma of a stage [s]
  MassMatrix<Real> mass;                ///< M, shape (n, n)
  Eigen::SparseMatrix<Real> stiffness;  ///< K, shape (n, n)
  Eigen::SparseMatrix<Scalar> reduced;  ///< M + s C + s^2 K, shape (n, n)
};

namespace detail {
/// Whether two compressed sparse matrices have entries at the same places.
template <class A, class B>
bool same_pattern(const A& a, const B& b) {
  return a.rows() == b.rows() && a.nonZeros() == b.nonZeros() && a.isCompressed() && b.isCompressed() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
}

/// Copies values alone where the pattern is there already; then nothing is allocated.
/// @returns whether it was there
template <class Matrix>
bool copy_sparse(const Matrix& from, Matrix& to) {
  const bool same = same_pattern(from, to);
  if (same)
    std::copy_n(from.valuePtr(), from.nonZeros(), to.valuePtr());
  else
    to = from;
  to.makeCompressed();
  return same;
}
}  // namespace detail

/// A = diag(m) + c C + k K for sparse C and K, shape (n, n), m of shape (n). Written in place where C, K
/// and A have one pattern with a full diagonal; otherwise A gets the common pattern and allocates.
template <class Real, class Scalar>
void set_sparse_combination(const Eigen::Vector<Real, Eigen::Dynamic>& m, Scalar c,
                            const Eigen::SparseMatrix<Real>& C, Scalar k, const Eigen::SparseMatrix<Real>& K,
                            Eigen::SparseMatrix<Scalar>& A) {
  // Different patterns: the sum of Eigen has their union.
  if (!detail::same_pattern(C, K) || !detail::same_pattern(K, A)) {
    Eigen::SparseMatrix<Scalar> mass(m.size(), m.size());
    mass.setIdentity();
    mass.diagonal() = m.template cast<Scalar>();
    A = mass + c * C.template cast<Scalar>() + k * K.template cast<Scalar>();
    A.makeCompressed();
    return;
  }
  // The three matrices have their values in one order.
  const Real *const of_C = C.valuePtr(), *const of_K = K.valuePtr();
  Scalar* const values = A.valuePtr();
  // One pattern: entry by entry, then m on the diagonal, which stands behind the rows above it.
  const Eigen::Index entries = A.nonZeros();
  for (Eigen::Index i = 0; i < entries; ++i) values[i] = c * of_C[i] + k * of_K[i];
  const int *const outer = A.outerIndexPtr(), *const inner = A.innerIndexPtr();
  for (int j = 0; j < static_cast<int>(m.size()); ++j) {
    // Counted, which takes less time than a search by bisection in columns of some ten entries.
    int above = 0;
    for (int p = outer[j]; p < outer[j + 1]; ++p) above += inner[p] < j;
    values[outer[j] + above] += m[j];
  }
}

/// A = M + c C + k K for a sparse M, shape (n, n). M is added in place where A has entries wherever M has.
template <class Real, class Scalar>
void set_sparse_combination(const Eigen::SparseMatrix<double>& M, Scalar c,
                            const Eigen::SparseMatrix<Real>& C, Scalar k, const Eigen::SparseMatrix<Real>& K,
                            Eigen::SparseMatrix<Scalar>& A) {
  const Eigen::Vector<Real, Eigen::Dynamic> none = Eigen::Vector<Real, Eigen::Dynamic>::Zero(M.cols());
  set_sparse_combination<Real, Scalar>(none, c, C, k, K, A);
  bool holds_all = true;
  for (Eigen::Index j = 0; j < A.cols() && holds_all; ++j) {
    const int *at = A.innerIndexPtr() + A.outerIndexPtr()[j], *const end = A.innerIndexPtr() +
                                                                           A.outerIndexPtr()[j + 1];
    for (Eigen::SparseMatrix<double>::InnerIterator entry(M, j); entry && holds_all; ++entry) {
      at = std::lower_bound(at, end, static_cast<int>(entry.row()));
      holds_all = at != end && *at == entry.row();
      if (holds_all)
        A.valuePtr()[at - A.innerIndexPtr()] += static_cast<Scalar>(static_cast<Real>(entry.value()));
    }
  }
  if (holds_all) return;
  A = Eigen::SparseMatrix<Scalar>(M.template cast<Scalar>()) + c * C.template cast<Scalar>() +
      k * K.template cast<Scalar>();
  A.makeCompressed();
}

/// A = M + c C + k K of a diagonal or a sparse M.
template <class Real, class Scalar>
void set_sparse_combination(const MassMatrix<Real>& M, Scalar c, const Eigen::SparseMatrix<Real>& C, Scalar k,
                            const Eigen::SparseMatrix<Real>& K, Eigen::SparseMatrix<Scalar>& A) {
  if (M.is_diagonal())
    set_sparse_combination<Real, Scalar>(M.diagonal(), c, C, k, K, A);
  else
    set_sparse_combination<Real, Scalar>(M.coupled()->matrix(), c, C, k, K, A);
}

/// A = I - s J, as (s, M, K, M + s C + s^2 K).
template <class Real, class Scalar>
void set_shifted(const MechanicalJacobian<Real>& J, Scalar s, ShiftedMechanical<Scalar>& A) {
  A.s = s;
  A.mass = J.mass;
  detail::copy_sparse(J.stiffness, A.stiffness);
  set_sparse_combination<Real, Scalar>(J.mass, s, J.damping, s * s, J.stiffness, A.reduced);
}

/// J = (0, I; -K, -C) of a structure with masses of one, by its operators.
struct OperatorJacobian {
  std::shared_ptr<const StructureOperator> structure;

  /// Nothing: it is of the system. See saved_state.hpp.
  void visit_state(auto& /*visit*/) {}
};
/// I + c C + k K of such a structure; where c and k say nothing it stands for C and K.
struct OperatorSum : OperatorJacobian {
  double c = 0, k = 0;  ///< [s], [s^2]
};
/// I - s J, reduced to I + s C + s^2 K as that of a mechanical system.
struct ShiftedOperator {
  OperatorSum reduced;
};

/// A = I - s J. @throws ComplexEquations  for s that is no double
template <class Scalar>
void set_shifted(const OperatorJacobian& J, Scalar s, ShiftedOperator& A) {
  if constexpr (std::is_same_v<Scalar, double>)
    A.reduced = {J, s, s * s};
  else
    throw ComplexEquations();
}

namespace detail {
/// Whether T is a MechanicalJacobian.
template <class T>
inline constexpr bool is_mechanical = false;
template <class Real>
inline constexpr bool is_mechanical<MechanicalJacobian<Real>> = true;

/// Whether a matrix of type Matrix is of a kind, or may at run time hold one.
template <class Kind, class Matrix>
inline constexpr bool may_hold = std::is_same_v<Kind, Matrix>;
template <class Kind, class... Matrices>
inline constexpr bool may_hold<Kind, std::variant<Matrices...>> = (std::is_same_v<Kind, Matrices> || ...);

/// Whether a system of this type may write sparse K and C, and how its equations are then kept.
template <class Sys>
struct EquationsType {
  using type = jacobian_type<Sys>;
};
template <SecondOrderSystem Sys>
requires std::is_base_of_v < Eigen::SparseMatrixBase<typename Sys::DofMatrix>,
typename Sys::DofMatrix > struct EquationsType<Sys> {
  using type = MechanicalJacobian<real_of<typename Sys::State>>;
};
/// The type of K and C of systems that decide at run time; their equations are dense, sparse, in parts or by
/// operators. Those of long double, in which orders are measured alone, stay as the system writes them.
using DenseOrSparse = std::variant<Eigen::MatrixXd, Eigen::SparseMatrix<double>>;
template <SecondOrderSystem Sys>
requires std::is_same_v<typename Sys::DofMatrix, DenseOrSparse>
struct EquationsType<Sys> {
  using type = std::variant<Eigen::MatrixXd, Eigen::SparseMatrix<double>, MechanicalJacobian<double>,
                            OperatorJacobian>;
};

/// How a method of second order keeps K and C.
template <class Matrix>
struct StructureType {
  using type = Matrix;
};
template <>
struct StructureType<DenseOrSparse> {
  using type = std::variant<Eigen::MatrixXd, Eigen::SparseMatrix<double>, OperatorSum>;
};
}  // namespace detail

/// The type in which a method that solves equations keeps the Jacobian of a system: jacobian_type, or for
/// second-order systems with sparse matrices their parts.
template <class Sys>
using equations_type = typename detail::EquationsType<Sys>::type;

/// The type in which a method of second order keeps K, C and their sums: DofMatrix, or of systems that decide
/// at run time also operators.
template <SecondOrderSystem Sys>
using structure_type = typename detail::StructureType<typename Sys::DofMatrix>::type;

}  // namespace hmax
