/// M q'' + C q' + K q = 0 of the user's own matrices: a system that every method steps.
#pragma once

#include <memory>
#include <optional>
#include <type_traits>
#include <variant>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/mass_matrix.hpp"
#include "core/size_limits.hpp"
#include "problems/any_system.hpp"
#include "problems/linearity.hpp"

namespace hmax {

/// J = (0, I; -M^-1 K, -M^-1 C), shape (2 n, 2 n), of a structure as a first-order system. Of an M that
/// couples unknowns M^-1 K is full.
/// @tparam MatrixT  Eigen::MatrixXd or Eigen::SparseMatrix<double>
/// @throws std::invalid_argument  for such an M of more than most_coupled_masses rows
template <class MatrixT>
void first_order_matrix(const MatrixT& K, const MassMatrix<double>& M, const MatrixT& C, MatrixT& J);

/// A linear structure, y = (q, v), shape (2 n). Copies share the matrices.
/// @tparam MatrixT  Eigen::MatrixXd or Eigen::SparseMatrix<double>
template <class MatrixT>
class LinearStructure {
 public:
  using State = Eigen::VectorXd;
  using Dofs = Eigen::VectorXd;
  using DofMatrix = MatrixT;
  using Jacobian = MatrixT;
  static constexpr bool autonomous = true;
  static constexpr Linearity linearity() { return Linearity::linear; }

  /// @param K     stiffness, shape (n, n) [N/m]
  /// @param mass  the diagonal of M, shape (n) [kg], all positive; or for a sparse K an M that couples
  /// unknowns
  /// @param C     damping, shape (n, n) [N s/m]
  /// @throws std::invalid_argument  for other shapes, numbers that are not finite, masses that are not
  /// positive, and matrices of which only one triangle is stored
  LinearStructure(MatrixT K, MassMatrix<double> mass, MatrixT C);

  [[nodiscard]] Eigen::Index dofs() const { return parts_->mass.size(); }
  [[nodiscard]] Eigen::Index dim() const { return 2 * dofs(); }
  void rhs(double /*t*/, const State& y, State& dydt) const {
    const Eigen::Index n = dofs();
    dydt.head(n) = y.tail(n);
    dydt.tail(n).noalias() = parts_->K * y.head(n);
    if (parts_->damped) dydt.tail(n).noalias() += parts_->C * y.tail(n);
    if (parts_->mass.is_diagonal())
      dydt.tail(n).array() /= -parts_->mass.diagonal().array();
    else
      dydt.tail(n) = -parts_->mass.solve(dydt.tail(n));
  }
  /// @throws std::invalid_argument  as first_order_matrix
  void jacobian(double, const State&, Jacobian& J) const {
    first_order_matrix(parts_->K, parts_->mass, parts_->C, J);
  }
  /// @throws std::invalid_argument  where M couples unknowns
  [[nodiscard]] Dofs mass() const { return parts_->mass.lumped(); }
  [[nodiscard]] const MassMatrix<double>& mass_matrix() const { return parts_->mass; }
  void force(double /*t*/, const Dofs& q, const Dofs& v, Dofs& f) const {
    f.noalias() = parts_->K * q;
    if (parts_->damped) f.noalias() += parts_->C * v;
    f = -f;
  }
  void stiffness(double, const Dofs&, const Dofs&, DofMatrix& K) const { K = parts_->K; }
  void damping(double, const Dofs&, const Dofs&, DofMatrix& C) const { C = parts_->C; }

 private:
  struct Parts {
    MatrixT K;
    MassMatrix<double> mass;
    MatrixT C;
    bool damped = false;
  };
  std::shared_ptr<const Parts> parts_;
};

extern template class LinearStructure<Eigen::MatrixXd>;
extern template class LinearStructure<Eigen::SparseMatrix<double>>;

/// A square matrix as it was given.
using StructureMatrix = std::variant<Eigen::MatrixXd, Eigen::SparseMatrix<double>>;

namespace detail {
template <class T>
concept RealMatrix = std::is_base_of_v<Eigen::EigenBase<T>, T> &&
    std::is_arithmetic_v<typename Eigen::internal::traits<T>::Scalar>;

template <class T>
inline constexpr bool is_diagonal_matrix = std::is_base_of_v<Eigen::DiagonalBase<T>, T>;

/// A copy in the types that hmax computes with.
template <RealMatrix T>
StructureMatrix structure_matrix(const T& given) {
  if constexpr (is_diagonal_matrix<T>) {
    return Eigen::MatrixXd(given.toDenseMatrix().template cast<double>());
  } else if constexpr (std::is_base_of_v<Eigen::SparseMatrixBase<T>, T>) {
    Eigen::SparseMatrix<double> copy = given.template cast<double>();
    copy.makeCompressed();
    return copy;
  } else {
    return Eigen::MatrixXd(given.template cast<double>());
  }
}

/// The same of masses: a vector of them is one column.
template <RealMatrix T>
StructureMatrix mass_matrix(const T& given) {
  if constexpr (is_diagonal_matrix<T>)
    return Eigen::MatrixXd(given.diagonal().template cast<double>());
  else if constexpr (T::RowsAtCompileTime == 1 && T::ColsAtCompileTime != 1)
    return structure_matrix(given.transpose().eval());
  else
    return structure_matrix(given);
}

/// @param C  none: no damping
AnySystem structure_system(StructureMatrix K, StructureMatrix M, std::optional<StructureMatrix> C);
}  // namespace detail

/// The system M q'' + C q' + K q = 0, y = (q, v), of any Eigen matrices, dense or sparse.
/// @param K  stiffness, shape (n, n) [N/m]
/// @param M  masses [kg]: a vector of n, or a matrix of shape (n, n), which may couple degrees of freedom as
/// a
///           consistent mass matrix does
/// @param C  damping, shape (n, n) [N s/m]
/// @throws std::invalid_argument  for other shapes, numbers that are not finite, masses that are not
/// positive, mass matrices that are not symmetric, and matrices of which only one triangle is stored
template <detail::RealMatrix KType, detail::RealMatrix MType, detail::RealMatrix CType>
AnySystem linear_structure(const KType& K, const MType& M, const CType& C) {
  return detail::structure_system(detail::structure_matrix(K), detail::mass_matrix(M),
                                  detail::structure_matrix(C));
}
/// The same without damping.
template <detail::RealMatrix KType, detail::RealMatrix MType>
AnySystem linear_structure(const KType& K, const MType& M) {
  return detail::structure_system(detail::structure_matrix(K), detail::mass_matrix(M), std::nullopt);
}

}  // namespace hmax
