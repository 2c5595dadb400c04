#include "analysis/linear_model.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// Calls visit(i, j, value) for every entry that is stored.
template <class Visit>
void each_entry(const AnyMatrix& matrix, const Visit& visit) {
  if (const auto* full = std::get_if<MatrixXd>(&matrix)) {
    for (Index j = 0; j < full->cols(); ++j)
      for (Index i = 0; i < full->rows(); ++i) visit(i, j, (*full)(i, j));
    return;
  }
  const auto& sparse = std::get<Sparse>(matrix);
  for (Index j = 0; j < sparse.cols(); ++j)
    for (Sparse::InnerIterator entry(sparse, j); entry; ++entry) visit(entry.row(), j, entry.value());
}

void require_masses(const VectorXd& mass) {
  for (Index i = 0; i < mass.size(); ++i)
    if (!(std::isfinite(mass[i]) && mass[i] > 0))
      throw InputError(
          fmt::format("the mass of degree of freedom {} is {}, but every mass must be positive and finite; "
                      "give it a mass in "
                      "kg, or take the degree of freedom out of the model",
                      i + 1, to_text(mass[i])));
}

/// Whether A = A^T beside the entries of A.
template <class Matrix>
bool is_symmetric(const Matrix& A, double relative) {
  return Matrix(A - Matrix(A.transpose())).norm() <= relative * A.norm();
}

/// Whether A B = B A for symmetric A and B, beside what rounding of the terms of the product may be.
template <class Matrix>
bool commute(const Matrix& A, const Matrix& B, double relative) {
  const Matrix product = A * B;
  const Matrix size = Matrix(A.cwiseAbs()) * Matrix(B.cwiseAbs());
  return Matrix(product - Matrix(product.transpose())).norm() <= relative * size.norm();
}

/// A with rows and columns divided by the square roots of the masses: M^-1/2 A M^-1/2.
template <class Matrix>
Matrix mass_scaled(const Matrix& A, const VectorXd& inverse_root) {
  return inverse_root.asDiagonal() * A * inverse_root.asDiagonal();
}

template <class Matrix>
void classify(const Matrix& K, const Matrix& C, double relative, MechanicalPart& part) {
  const VectorXd inverse_root = part.mass.cwiseSqrt().cwiseInverse();
  const Matrix k = mass_scaled(K, inverse_root), c = mass_scaled(C, inverse_root);
  part.symmetric = is_symmetric(k, relative) && is_symmetric(c, relative);
  if (c.norm() == 0)
    part.damping = Damping::none;
  else
    part.damping = part.symmetric && commute(k, c, relative) ? Damping::proportional : Damping::general;
}

Sparse as_sparse(const AnyMatrix& matrix) {
  if (const auto* sparse = std::get_if<Sparse>(&matrix)) return *sparse;
  return std::get<MatrixXd>(matrix).sparseView();
}

}  // namespace

std::string_view name_of(JacobianOrigin origin) {
  switch (origin) {
    case JacobianOrigin::analytic:
      return "analytic";
    case JacobianOrigin::differences:
      return "central differences";
    case JacobianOrigin::grouped_differences:
      break;
  }
  return "central differences by groups of columns";
}

std::string_view name_of(Damping damping) {
  switch (damping) {
    case Damping::none:
      return "none";
    case Damping::proportional:
      return "proportional";
    case Damping::general:
      break;
  }
  return "general";
}

MatrixXd dense(const AnyMatrix& matrix) {
  if (const auto* full = std::get_if<MatrixXd>(&matrix)) return *full;
  return MatrixXd(std::get<Sparse>(matrix));
}

double relative_distance(const AnyMatrix& A, const AnyMatrix& B) {
  if (!is_sparse(A) || !is_sparse(B)) return (dense(A) - dense(B)).norm() / dense(A).norm();
  using Sparse = Eigen::SparseMatrix<double>;
  return Sparse(std::get<Sparse>(A) - std::get<Sparse>(B)).norm() / std::get<Sparse>(A).norm();
}

MechanicalPart mechanical_part(VectorXd mass, AnyMatrix K, AnyMatrix C, double relative) {
  require_masses(mass);
  each_entry(K, [&](Index i, Index j, double value) {
    if (!std::isfinite(value))
      throw InputError(
          fmt::format("the stiffness matrix has {} at row {}, column {} (counted from 1), so there "
                      "is no linear model; choose a state where the force is differentiable",
                      to_text(value), i + 1, j + 1));
  });
  each_entry(C, [&](Index i, Index j, double value) {
    if (!std::isfinite(value))
      throw InputError(
          fmt::format("the damping matrix has {} at row {}, column {} (counted from 1), so there "
                      "is no linear model; choose a state where the force is differentiable",
                      to_text(value), i + 1, j + 1));
  });
  MechanicalPart part{.mass = std::move(mass), .K = std::move(K), .C = std::move(C)};
  if (part.mass.size() == 1) {  // one degree of freedom has nothing to couple with
    double c = 0;
    each_entry(part.C, [&](Index, Index, double value) { c = value; });
    part.damping = c == 0 ? Damping::none : Damping::proportional;
    return part;
  }
  if (is_sparse(part.K) && is_sparse(part.C))
    classify(std::get<Sparse>(part.K), std::get<Sparse>(part.C), relative, part);
  else if (is_sparse(part.K) != is_sparse(part.C))
    classify(as_sparse(part.K), as_sparse(part.C), relative, part);
  else
    classify(std::get<MatrixXd>(part.K), std::get<MatrixXd>(part.C), relative, part);
  return part;
}

namespace detail {

void require_finite(const AnyMatrix& matrix, std::string_view what, double t) {
  each_entry(matrix, [&](Index i, Index j, double value) {
    if (!std::isfinite(value))
      throw InputError(fmt::format(
          "{} has {} at row {}, column {} (counted from 1) at t = {}: the rate of component {} has no finite "
          "slope along component {}; choose a state where the model is differentiable",
          what, to_text(value), i + 1, j + 1, to_text(t), i + 1, j + 1));
  });
}

void require_finite_state(double t, const VectorXd& y) {
  if (!std::isfinite(t))
    throw InputError(fmt::format("the time of the linear model is {}; give a finite time", to_text(t)));
  for (Index i = 0; i < y.size(); ++i)
    if (!std::isfinite(y[i]))
      throw InputError(
          fmt::format("component {} (counted from 1) of the state to linearise at is {}; give a "
                      "finite state",
                      i + 1, to_text(y[i])));
}

std::pair<AnyMatrix, AnyMatrix> stiffness_and_damping_of(const AnyMatrix& J, const VectorXd& mass) {
  const Index n = mass.size();
  if (const auto* full = std::get_if<MatrixXd>(&J))
    return {MatrixXd(-(mass.asDiagonal() * full->bottomLeftCorner(n, n))),
            MatrixXd(-(mass.asDiagonal() * full->bottomRightCorner(n, n)))};
  std::vector<Eigen::Triplet<double>> stiffness, damping;
  each_entry(J, [&](Index i, Index j, double value) {
    if (i < n) return;
    auto& block = j < n ? stiffness : damping;
    block.emplace_back(static_cast<int>(i - n), static_cast<int>(j % n), -mass[i - n] * value);
  });
  Sparse K(n, n), C(n, n);
  K.setFromTriplets(stiffness.begin(), stiffness.end());
  C.setFromTriplets(damping.begin(), damping.end());
  return {K, C};
}

}  // namespace detail
}  // namespace hmax
