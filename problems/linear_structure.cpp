#include "problems/linear_structure.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "problems/digits.hpp"
#include "problems/matrix_entries.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

std::string shape_of(Eigen::Index rows, Eigen::Index columns) {
  return std::to_string(rows) + " x " + std::to_string(columns);
}

/// What serves as K, C or M: square, of n rows, finite, and not one triangle of a symmetric matrix.
template <class Matrix>
void require_whole(const Matrix& matrix, std::string_view name, Eigen::Index n) {
  if (matrix.rows() != n || matrix.cols() != n)
    throw std::invalid_argument(std::string(name) + " has the shape " +
                                shape_of(matrix.rows(), matrix.cols()) + " but must have " + shape_of(n, n) +
                                ", a row and a column for each degree of freedom of K");
  bool above = false, below = false;
  each_entry(matrix, [&](Eigen::Index i, Eigen::Index j, double value) {
    if (!std::isfinite(value))
      throw std::invalid_argument(std::string(name) + " has " + shortest_digits(value) + " at row " +
                                  std::to_string(i + 1) + ", column " + std::to_string(j + 1) +
                                  " (counted from 1); every entry must be finite");
    above = above || (i < j && value != 0);
    below = below || (i > j && value != 0);
  });
  if (above != below)
    throw std::invalid_argument(std::string(name) +
                                " has entries on one side of its diagonal only; store "
                                "both triangles of a symmetric matrix");
}

void require_masses(const VectorXd& mass, Eigen::Index n) {
  if (mass.size() != n)
    throw std::invalid_argument("there are " + std::to_string(mass.size()) + " masses, but K has " +
                                std::to_string(n) + " rows; give one mass for each degree of freedom");
  for (Eigen::Index i = 0; i < n; ++i)
    if (!(mass[i] > 0 && std::isfinite(mass[i])))
      throw std::invalid_argument("the mass of degree of freedom " + std::to_string(i + 1) + " is " +
                                  shortest_digits(mass[i]) +
                                  " but must be positive and finite; give it a mass in kg, or take the "
                                  "degree of freedom out of the matrices");
}

Eigen::Index rows_of(const StructureMatrix& matrix) {
  return std::visit([](const auto& held) { return held.rows(); }, matrix);
}
Eigen::Index columns_of(const StructureMatrix& matrix) {
  return std::visit([](const auto& held) { return held.cols(); }, matrix);
}
MatrixXd dense_of(const StructureMatrix& matrix) {
  return std::visit([](const auto& held) { return MatrixXd(held); }, matrix);
}

/// The masses of a vector or of a diagonal matrix; empty for one that couples degrees of freedom.
VectorXd lumped_masses(const StructureMatrix& M) {
  if (columns_of(M) == 1) return dense_of(M);
  if (rows_of(M) != columns_of(M)) return {};  // told by require_whole
  bool diagonal = true;
  each_entry(M, [&](Eigen::Index i, Eigen::Index j, double value) {
    diagonal = diagonal && (i == j || value == 0);
  });
  if (!diagonal) return {};
  return std::visit([](const auto& held) { return VectorXd(held.diagonal()); }, M);
}

Sparse sparse_of(StructureMatrix matrix) {
  auto* const sparse = std::get_if<Sparse>(&matrix);
  return sparse != nullptr ? std::move(*sparse) : Sparse(std::get<MatrixXd>(matrix).sparseView());
}

/// Methods add M to K and C in place, which takes stored entries where M has some; of damped structures K and
/// C have one pattern, so that no step looks for it.
void share_pattern(Sparse& K, Sparse& C, const MassMatrix<double>& M, bool damped) {
  Sparse zero(K.rows(), K.rows());
  zero.setIdentity();
  if (!M.is_diagonal()) zero = M.coupled()->matrix();
  zero *= 0.0;
  const Sparse pattern = damped ? Sparse(0.0 * K + 0.0 * C + zero) : zero;
  C = Sparse(C + pattern);
  K = Sparse(K + (damped ? pattern : zero));
}
void share_pattern(MatrixXd&, MatrixXd&, const MassMatrix<double>&, bool) {}

}  // namespace

template <class MatrixT>
LinearStructure<MatrixT>::LinearStructure(MatrixT K, MassMatrix<double> mass, MatrixT C) {
  if (K.rows() == 0)
    throw std::invalid_argument("K has no rows; a structure has at least one degree of freedom");
  if (K.rows() != K.cols())
    throw std::invalid_argument("K has the shape " + shape_of(K.rows(), K.cols()) +
                                " but must be square, a row and a column for each degree of freedom");
  require_whole(K, "K", K.rows());
  require_masses(mass.diagonal(), K.rows());
  require_whole(C, "C", K.rows());
  auto parts = std::make_shared<Parts>();
  parts->damped = has_entries(C);
  share_pattern(K, C, mass, parts->damped);
  parts->K.swap(K);
  std::swap(parts->mass, mass);
  parts->C.swap(C);
  parts_ = std::move(parts);
}

template <class MatrixT>
void first_order_matrix(const MatrixT& K, const MassMatrix<double>& M, const MatrixT& C, MatrixT& J) {
  const Eigen::Index n = M.size();
  if (!M.is_diagonal()) {
    if (n > most_coupled_masses)
      throw std::invalid_argument(
          "the mass matrix couples " + std::to_string(n) +
          " degrees of freedom, and the Jacobian of such a structure is written up to " +
          std::to_string(most_coupled_masses) +
          "; take a method that uses stiffness and damping themselves, or lump the mass matrix");
    MatrixXd full = MatrixXd::Zero(2 * n, 2 * n);
    full.topRightCorner(n, n).setIdentity();
    full.bottomLeftCorner(n, n) = -M.solve(MatrixXd(K));
    full.bottomRightCorner(n, n) = -M.solve(MatrixXd(C));
    if constexpr (std::is_same_v<MatrixT, MatrixXd>)
      J = std::move(full);
    else
      J = full.sparseView(1, -1);  // zeros as well: one pattern at all times
    return;
  }
  const VectorXd& mass = M.diagonal();
  const auto write = [&](const auto& add) {
    for (Eigen::Index i = 0; i < n; ++i) add(i, n + i, 1);
    each_entry(K, [&](Eigen::Index i, Eigen::Index j, double value) { add(n + i, j, -value / mass[i]); });
    each_entry(C, [&](Eigen::Index i, Eigen::Index j, double value) { add(n + i, n + j, -value / mass[i]); });
  };
  if constexpr (std::is_same_v<MatrixT, MatrixXd>) {
    J.setZero(2 * n, 2 * n);
    write([&](Eigen::Index i, Eigen::Index j, double value) { J(i, j) = value; });
  } else {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(n + K.nonZeros() + C.nonZeros()));
    write([&](Eigen::Index i, Eigen::Index j, double value) {
      entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
    });
    J.resize(2 * n, 2 * n);
    J.setFromTriplets(entries.begin(), entries.end());
  }
}

template void first_order_matrix(const MatrixXd&, const MassMatrix<double>&, const MatrixXd&, MatrixXd&);
template void first_order_matrix(const Sparse&, const MassMatrix<double>&, const Sparse&, Sparse&);
template class LinearStructure<MatrixXd>;
template class LinearStructure<Sparse>;

namespace detail {

AnySystem structure_system(StructureMatrix K, StructureMatrix M, std::optional<StructureMatrix> damping) {
  const Eigen::Index n = rows_of(K);
  StructureMatrix C = damping ? std::move(*damping) : Sparse(n, n);
  auto *const sparse_K = std::get_if<Sparse>(&K), *const sparse_C = std::get_if<Sparse>(&C);
  const bool sparse = sparse_K != nullptr && sparse_C != nullptr;
  VectorXd mass = lumped_masses(M);
  if (mass.size() == 0 && rows_of(M) > 0) {
    // Shapes are told of the matrices as they were given.
    for (const auto& [matrix, name] : {std::pair{&K, "K"}, {&M, "M"}, {&C, "C"}})
      std::visit([&, name = name](const auto& held) { require_whole(held, name, n); }, *matrix);
    // Dense ones too: methods and limits divide by a mass that couples with sparse K and C.
    return AnySystem(LinearStructure<Sparse>(
        sparse_of(std::move(K)),
        MassMatrix<double>(std::make_shared<const CoupledMass>(sparse_of(std::move(M)))),
        sparse_of(std::move(C))));
  }
  if (sparse)
    return AnySystem(LinearStructure<Sparse>(std::move(*sparse_K), std::move(mass), std::move(*sparse_C)));
  return AnySystem(LinearStructure<MatrixXd>(dense_of(K), std::move(mass), dense_of(C)));
}

}  // namespace detail
}  // namespace hmax
