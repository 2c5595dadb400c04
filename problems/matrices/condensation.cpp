#include "problems/matrices/condensation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/SparseLU>

#include "core/size_limits.hpp"
#include "core/symmetry.hpp"
#include "problems/matrix_entries.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Entries of K' beyond which it takes more than a gigabyte.
constexpr std::size_t most_entries = 60'000'000;

Sparse from(const Triplets& entries, Eigen::Index rows, Eigen::Index columns) {
  Sparse matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

using NameOf = std::function<std::string(Eigen::Index)>;

/// @throws std::invalid_argument  unless C_m = b K_m for a number b
void require_proportional(const Sparse& C_m, const Sparse& K_m, const std::vector<Eigen::Index>& rows,
                          const NameOf& name_of) {
  const double b = K_m.squaredNorm() > 0 ? K_m.cwiseProduct(C_m).sum() / K_m.squaredNorm() : 0;
  const Sparse rest = C_m - b * K_m;
  const auto largest = [](const Sparse& A) {
    return A.nonZeros() > 0 ? A.coeffs().cwiseAbs().maxCoeff() : 0.0;
  };
  const double allowed = 1e-9 * std::max(std::abs(b) * largest(K_m), largest(C_m));
  each_entry(rest, [&](Eigen::Index i, Eigen::Index, double value) {
    if (std::abs(value) > allowed)
      throw std::invalid_argument(
          "damping acts on " + name_of(rows[static_cast<std::size_t>(i)]) +
          ", which has no mass, so the model is no longer of second order; give it a mass or "
          "take the damping away");
  });
}

/// K_mm^-1 K_mu, shape (m, u). What is not coupled stays zero exactly.
Sparse solved(const Sparse& K_mm, const Sparse& K_mu, const std::vector<Eigen::Index>& rows,
              const NameOf& name_of) {
  const auto fail = [&](Eigen::Index row) {
    throw std::invalid_argument("the stiffness among the " + std::to_string(rows.size()) +
                                " unknowns without mass is singular, for instance at " +
                                name_of(rows[static_cast<std::size_t>(row)]) +
                                ": nothing holds it; give it a mass, or take it out of the matrices");
  };
  VectorXd sizes = VectorXd::Zero(K_mm.rows());
  each_entry(K_mm, [&](Eigen::Index i, Eigen::Index, double value) {
    sizes[i] = std::max(sizes[i], std::abs(value));
  });
  for (Eigen::Index i = 0; i < sizes.size(); ++i)
    if (sizes[i] == 0) fail(i);
  Eigen::SparseLU<Sparse> factor(K_mm);
  if (factor.info() != Eigen::Success) fail(0);
  std::vector<Eigen::Index> columns;
  for (Eigen::Index j = 0; j < K_mu.cols(); ++j)
    if (Sparse::InnerIterator(K_mu, j)) columns.push_back(j);
  constexpr std::size_t at_once = 32;
  Triplets entries;
  for (std::size_t begin = 0; begin < columns.size(); begin += at_once) {
    const std::size_t count = std::min(at_once, columns.size() - begin);
    MatrixXd right = MatrixXd::Zero(K_mm.rows(), static_cast<Eigen::Index>(count));
    for (std::size_t k = 0; k < count; ++k)
      for (Sparse::InnerIterator entry(K_mu, columns[begin + k]); entry; ++entry)
        right(entry.row(), static_cast<Eigen::Index>(k)) = entry.value();
    const MatrixXd T = factor.solve(right);
    const MatrixXd left = K_mm * T - right;
    if (!(left.cwiseAbs().maxCoeff() <= 1e-6 * right.cwiseAbs().maxCoeff())) {
      Eigen::Index row = 0, column = 0;
      left.cwiseAbs().maxCoeff(&row, &column);
      fail(row);
    }
    for (Eigen::Index k = 0; k < T.cols(); ++k)
      for (Eigen::Index i = 0; i < T.rows(); ++i)
        if (T(i, k) != 0)
          entries.emplace_back(static_cast<int>(i),
                               static_cast<int>(columns[begin + static_cast<std::size_t>(k)]), T(i, k));
    if (entries.size() > most_entries)
      throw std::invalid_argument(
          "without its " + std::to_string(rows.size()) +
          " unknowns without mass the stiffness has too many entries; give them a mass");
  }
  return from(entries, K_mm.rows(), K_mu.cols());
}

}  // namespace

Sparse block_of(const Sparse& A, const std::vector<Eigen::Index>& rows,
                const std::vector<Eigen::Index>& columns) {
  std::vector<int> place(static_cast<std::size_t>(A.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i)
    place[static_cast<std::size_t>(rows[i])] = static_cast<int>(i);
  Triplets entries;
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (Sparse::InnerIterator entry(A, columns[j]); entry; ++entry)
      if (const int i = place[static_cast<std::size_t>(entry.row())]; i >= 0)
        entries.emplace_back(i, static_cast<int>(j), entry.value());
  return from(entries, static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size()));
}

void require_proportional_damping(const Sparse& C, const Sparse& K, const std::vector<Eigen::Index>& rows,
                                  const NameOf& name_of) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(K.rows()));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Eigen::Index>(i);
  require_proportional(block_of(C, rows, all), block_of(K, rows, all), rows, name_of);
}

CondensedStructure condensed(const Sparse& K, const Sparse& C, const std::vector<char>& massless,
                             const NameOf& name_of) {
  CondensedStructure result;
  std::vector<Eigen::Index> out;
  for (Eigen::Index i = 0; i < K.rows(); ++i)
    (massless[static_cast<std::size_t>(i)] ? out : result.kept).push_back(i);
  if (result.kept.empty())
    throw std::invalid_argument(
        "no unknown has a mass; check the mass matrix, or give a first-order model as jacobian=");
  if (static_cast<std::ptrdiff_t>(out.size()) > most_factored)
    throw std::invalid_argument(std::to_string(out.size()) + " unknowns have no mass, more than the " +
                                std::to_string(most_factored) + " that are taken out; give them a mass");
  require_proportional_damping(C, K, out, name_of);
  const std::vector<Eigen::Index>& kept = result.kept;
  const Sparse T = solved(block_of(K, out, out), block_of(K, out, kept), out, name_of);
  result.K = block_of(K, kept, kept) - Sparse(block_of(K, kept, out) * T);
  result.C = block_of(C, kept, kept) - Sparse(block_of(C, kept, out) * T);
  if (static_cast<std::size_t>(result.K.nonZeros()) > most_entries)
    throw std::invalid_argument(
        "without its unknowns without mass the stiffness has too many entries; give them a mass");
  if (is_symmetric(K)) result.K = symmetrised(result.K);
  if (is_symmetric(C, damping_noise)) result.C = symmetrised(result.C);
  return result;
}

}  // namespace hmax
