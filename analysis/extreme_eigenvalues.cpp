#include "analysis/extreme_eigenvalues.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#if HMAX_HAVE_SPECTRA
#include <Spectra/GenEigsSolver.h>
#include <Spectra/MatOp/SparseGenMatProd.h>
#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/MatOp/SparseSymShiftSolve.h>
#include <Spectra/SymEigsShiftSolver.h>
#include <Spectra/SymEigsSolver.h>
#endif

#include "analysis/spectrum.hpp"
#include "results/errors.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
constexpr double tolerance = 1e-10;

/// Whether dense methods are to be used.
/// @throws InputError  when the question has no answer
bool goes_dense(Index n, Index count, Index dense_to) {
  if (count < 1 || count > n)
    throw InputError(
        fmt::format("{} eigenvalues of {} unknowns were asked for; ask for 1 to {}", count, n, n));
  // The iterations need room beside what they look for.
  if (n <= dense_to || count + 3 > n) return true;
  if (has_krylov()) return false;
  if (n > most_dense_rows)
    throw InputError(
        fmt::format("the extreme eigenvalues of {} unknowns need Spectra: install the Debian package "
                    "libspectra-dev and build again, or take at most {} unknowns",
                    n, most_dense_rows));
  return true;
}

LargestEigenvalues dense_largest(const MatrixXd& J, Index count) {
  const Eigen::EigenSolver<MatrixXd> solver(J);
  std::vector<Index> order(static_cast<std::size_t>(J.rows()));
  std::iota(order.begin(), order.end(), Index(0));
  const Eigen::VectorXcd lambda = solver.eigenvalues();
  const Eigen::MatrixXcd vectors = solver.eigenvectors();
  // Conjugates have one modulus and stay side by side.
  std::ranges::stable_sort(order,
                           [&](Index a, Index b) { return std::abs(lambda[a]) > std::abs(lambda[b]); });
  const Index taken = std::min(count + 1, J.rows());
  LargestEigenvalues result{.lambda = {}, .vectors = Eigen::MatrixXcd(J.rows(), taken)};
  for (Index i = 0; i < taken; ++i) {
    const Index from = order[static_cast<std::size_t>(i)];
    result.lambda.push_back(lambda[from]);
    result.vectors.col(i) = vectors.col(from).normalized();
  }
  return result;
}

/// Takes off the value that was computed beyond `count`, unless it is the conjugate of the one before.
void trim(LargestEigenvalues& result, Index count) {
  const auto wanted = static_cast<std::size_t>(count);
  if (result.lambda.size() <= wanted) return;
  const Complex last = result.lambda[wanted - 1], next = result.lambda[wanted];
  const bool cut = last.imag() != 0 && std::abs(next - std::conj(last)) <= 1e-8 * std::abs(last);
  const bool whole =
      wanted >= 2 && std::abs(result.lambda[wanted - 2] - std::conj(last)) <= 1e-8 * std::abs(last);
  result.lambda.resize(wanted + (cut && !whole ? 1 : 0));
  result.vectors.conservativeResize(Eigen::NoChange, static_cast<Index>(result.lambda.size()));
}

/// M^-1/2 K M^-1/2, and what turns its eigenvectors into shapes.
struct Scaled {
  VectorXd inverse_root;
  Sparse k;

  explicit Scaled(const MechanicalPart& part) : inverse_root(part.mass.cwiseSqrt().cwiseInverse()) {
    if (!part.symmetric)
      throw std::invalid_argument(
          "extreme stiffnesses need a symmetric K; take the eigenvalues of the Jacobian");
    const Sparse K =
        is_sparse(part.K) ? std::get<Sparse>(part.K) : Sparse(std::get<MatrixXd>(part.K).sparseView());
    k = inverse_root.asDiagonal() * K * inverse_root.asDiagonal();
    k.makeCompressed();
  }
  [[nodiscard]] double gershgorin() const {
    return VectorXd(k.cwiseAbs() * VectorXd::Ones(k.cols())).maxCoeff();
  }
};

ExtremeStiffnesses dense_stiffnesses(const Scaled& scaled, Index count, bool largest) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver{MatrixXd(scaled.k)};
  const Index n = scaled.k.rows();
  ExtremeStiffnesses result{.kappa = {}, .shapes = MatrixXd(n, count)};
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index(0));
  const VectorXd& kappa = solver.eigenvalues();
  std::ranges::stable_sort(order, [&](Index a, Index b) {
    return largest ? kappa[a] > kappa[b] : std::abs(kappa[a]) < std::abs(kappa[b]);
  });
  for (Index i = 0; i < count; ++i) {
    const Index from = order[static_cast<std::size_t>(i)];
    result.kappa.push_back(kappa[from]);
    result.shapes.col(i) = scaled.inverse_root.cwiseProduct(solver.eigenvectors().col(from));
  }
  return result;
}

#if HMAX_HAVE_SPECTRA

/// A vector that is orthogonal to no mode of a regular structure, and the same in every run: the numbers of a
/// linear congruential generator in (-1/2, 1/2).
VectorXd start_vector(Index n) {
  VectorXd start(n);
  std::uint64_t state = 20;
  for (double& value : start) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    value = static_cast<double>(state >> 11U) * 0x1p-53 - 0.5;
  }
  return start;
}

/// Vectors kept between restarts: more than are wanted, so that neighbours of the last one do not hold it up.
Index krylov_dimension(Index n, Index count) { return std::min(n, std::max<Index>(2 * count + 20, 60)); }

template <class Solver>
bool run(Solver& solver, Index n, Spectra::SortRule rule, Index restarts) {
  const VectorXd start = start_vector(n);
  solver.init(start.data());
  solver.compute(rule, restarts, tolerance, rule);
  return solver.info() == Spectra::CompInfo::Successful;
}

/// What a solver has found, the nearest to `end` first.
template <class Solver>
ExtremeStiffnesses stiffnesses_of(const Solver& solver, double end, bool converged, const Scaled& scaled) {
  const VectorXd kappa = solver.eigenvalues();
  const MatrixXd vectors = solver.eigenvectors();
  std::vector<Index> order(static_cast<std::size_t>(kappa.size()));
  std::iota(order.begin(), order.end(), Index(0));
  std::ranges::sort(order, {}, [&](Index i) { return std::abs(kappa[i] - end); });
  ExtremeStiffnesses result{
      .kappa = {}, .shapes = MatrixXd(vectors.rows(), kappa.size()), .converged = converged};
  for (const Index from : order) {
    result.shapes.col(static_cast<Index>(result.kappa.size())) =
        scaled.inverse_root.cwiseProduct(vectors.col(from));
    result.kappa.push_back(kappa[from]);
  }
  return result;
}

/// Powers of two that bring row and column i of D^-1 J D to about one size, shape (n): positions and
/// velocities for instance have none in common, and iterations see a matrix as far from normal as its units
/// make it [parlett1969balancing]. All of D moves at once, so each by half of what it would move alone.
VectorXd balance(const Sparse& J) {
  VectorXd log_d = VectorXd::Zero(J.cols());
  for (int sweep = 0; sweep < 30; ++sweep) {
    VectorXd row = VectorXd::Zero(J.rows()), column = row;
    for (Index j = 0; j < J.cols(); ++j)
      for (Sparse::InnerIterator entry(J, j); entry; ++entry) {
        if (entry.row() == j) continue;
        const double size = std::abs(entry.value()) * std::exp2(log_d[j] - log_d[entry.row()]);
        row[entry.row()] += size;
        column[j] += size;
      }
    for (Index i = 0; i < J.cols(); ++i)
      if (row[i] > 0 && column[i] > 0) log_d[i] += std::log2(row[i] / column[i]) / 4;
  }
  return log_d.unaryExpr([](double value) { return std::exp2(std::round(value)); });
}

/// The eigenvalues nearest to a shift beyond one end of the spectrum.
ExtremeStiffnesses nearest_stiffnesses(const Scaled& scaled, Index count, double shift) {
  Spectra::SparseSymShiftSolve<double> inverse(scaled.k);
  Spectra::SymEigsShiftSolver<Spectra::SparseSymShiftSolve<double>> solver(
      inverse, count, krylov_dimension(scaled.k.rows(), count), shift);
  const bool converged = run(solver, scaled.k.rows(), Spectra::SortRule::LargestMagn, 300);
  return stiffnesses_of(solver, shift, converged, scaled);
}

LargestEigenvalues krylov_largest(const Sparse& J, Index count) {
  const VectorXd d = balance(J);
  const Sparse balanced = d.cwiseInverse().asDiagonal() * J * d.asDiagonal();
  Spectra::SparseGenMatProd<double> product(balanced);
  Spectra::GenEigsSolver<Spectra::SparseGenMatProd<double>> solver(product, count + 1,
                                                                   krylov_dimension(J.rows(), count + 1));
  const bool converged = run(solver, J.rows(), Spectra::SortRule::LargestMagn, 2000);
  const Eigen::VectorXcd lambda = solver.eigenvalues();
  LargestEigenvalues result{.lambda = {lambda.begin(), lambda.end()},
                            .vectors = d.asDiagonal() * solver.eigenvectors(),
                            .converged = converged};
  result.vectors.colwise().normalize();
  return result;
}

ExtremeStiffnesses krylov_stiffnesses(const Scaled& scaled, Index count, bool largest) {
  const double bound = scaled.gershgorin();
  // Outside the spectrum by more than rounding: the shifted matrix stays regular.
  if (!largest) return nearest_stiffnesses(scaled, count, -1e-8 * bound);
  Spectra::SparseSymMatProd<double> product(scaled.k);
  Spectra::SymEigsSolver<Spectra::SparseSymMatProd<double>> solver(product, count,
                                                                   krylov_dimension(scaled.k.rows(), count));
  if (run(solver, scaled.k.rows(), Spectra::SortRule::LargestAlge, 100))
    return stiffnesses_of(solver, bound, true, scaled);
  return nearest_stiffnesses(scaled, count, (1 + 1e-8) * bound);
}

#else

LargestEigenvalues krylov_largest(const Sparse& J, Index count) { return dense_largest(MatrixXd(J), count); }
ExtremeStiffnesses krylov_stiffnesses(const Scaled& scaled, Index count, bool largest) {
  return dense_stiffnesses(scaled, count, largest);
}

#endif

ExtremeStiffnesses stiffnesses(const MechanicalPart& part, Index count, Index dense_to, bool largest) {
  const bool by_dense = goes_dense(part.mass.size(), count, dense_to);
  const Scaled scaled(part);
  if (by_dense || scaled.gershgorin() == 0) return dense_stiffnesses(scaled, count, largest);
  return krylov_stiffnesses(scaled, count, largest);
}

}  // namespace

bool has_krylov() {
#if HMAX_HAVE_SPECTRA
  return true;
#else
  return false;
#endif
}

LargestEigenvalues largest_eigenvalues(const Sparse& J, Index count, Index dense_to) {
  const bool by_dense = goes_dense(J.rows(), count, dense_to) || J.nonZeros() == 0;
  LargestEigenvalues result = by_dense ? dense_largest(MatrixXd(J), count) : krylov_largest(J, count);
  trim(result, count);
  return result;
}

ExtremeStiffnesses largest_stiffnesses(const MechanicalPart& part, Index count, Index dense_to) {
  return stiffnesses(part, count, dense_to, true);
}

ExtremeStiffnesses smallest_stiffnesses(const MechanicalPart& part, Index count, Index dense_to) {
  return stiffnesses(part, count, dense_to, false);
}

}  // namespace hmax
