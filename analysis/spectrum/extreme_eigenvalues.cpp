#include "analysis/spectrum/extreme_eigenvalues.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <Eigen/SparseCore>
#include <fmt/format.h>

#include "analysis/spectrum/arnoldi.hpp"
#include "analysis/spectrum/davidson.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "analysis/spectrum/scaled_matrices.hpp"
#include "analysis/spectrum/spectrum.hpp"
#include "core/dense_solvers.hpp"
#include "core/errors.hpp"
#include "core/size_limits.hpp"
#include "integrators/linear/panel_factor.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
// Residuals over eigenvalues.
constexpr double most_residual = 1e-10;
/// How far beyond an end of the spectrum a shifted matrix is regular, relative to a bound.
constexpr double outside = 1e-8;

/// @throws InputError  when the question has no answer
void require_sensible(Index n, Index count) {
  if (count < 1 || count > n)
    throw InputError(
        fmt::format("{} eigenvalues of {} unknowns were asked for; ask for 1 to {}", count, n, n));
}

/// Whether all eigenvalues are computed: the iterations need room beside what they look for.
/// @throws InputError  when the question has no answer
bool goes_dense(Index n, Index count, Index dense_to) {
  require_sensible(n, count);
  return n <= dense_to || count + 3 > n;
}

/// All eigenvalues by the QR algorithm, 25 n^3 operations, of which count + 1 are kept.
LargestEigenvalues dense_largest(const MatrixXd& J, Index count) {
  const SortedEigenpairs pairs(J);
  // One more, so that trim() sees whether a pair would be cut.
  const Index taken = std::min(count + 1, static_cast<Index>(pairs.values.size()));
  return {.lambda = {pairs.values.begin(), pairs.values.begin() + taken},
          .vectors = pairs.vectors.leftCols(taken)};
}

/// Takes off the value that was computed beyond `count`, unless it is the conjugate of the one before.
void trim(LargestEigenvalues& result, Index count) {
  const auto wanted = static_cast<std::size_t>(count);
  if (result.lambda.size() <= wanted) return;
  const Complex last = result.lambda[wanted - 1], next = result.lambda[wanted];
  const bool cut = last.imag() != 0 && std::abs(next - std::conj(last)) <= 1e-8 * std::abs(last);
  // The value before is the conjugate already: the pair is complete.
  const bool whole =
      wanted >= 2 && std::abs(result.lambda[wanted - 2] - std::conj(last)) <= 1e-8 * std::abs(last);
  result.lambda.resize(wanted + (cut && !whole ? 1 : 0));
  result.vectors.conservativeResize(Eigen::NoChange, static_cast<Index>(result.lambda.size()));
}

/// k = R^-T K R^-1 with M = R^T R, and what turns its eigenvectors into shapes.
/// k is symmetric and similar to M^-1 K: its eigenvectors u give the shapes R^-1 u, which are orthonormal in
/// M. Holds references, so the part must outlive it.
class Scaled {
 public:
  const MassMatrix<double>& mass;

  /// @throws std::invalid_argument  unless K is symmetric
  explicit Scaled(const MechanicalPart& part) : mass(part.mass), part_(part) {
    if (!part.symmetric)
      throw std::invalid_argument(
          "extreme stiffnesses need a symmetric K; take the eigenvalues of the Jacobian");
    if (is_sparse(part.K)) {
      K_ = &std::get<Sparse>(part.K);
    } else {
      own_ = std::get<MatrixXd>(part.K).sparseView();
      K_ = &own_;
    }
  }
  Scaled(const Scaled&) = delete;
  Scaled& operator=(const Scaled&) = delete;

  [[nodiscard]] Index size() const { return mass.size(); }
  [[nodiscard]] MatrixXd matrix() const { return mass_scaled(mass, part_.K); }
  /// A matrix that is similar to k - shift I but for a positive definite factor on both sides, of which L D
  /// L^T is made: k - shift I itself, or K - shift M where M couples.
  [[nodiscard]] Sparse shifted(double shift) const {
    // One triangle decides, so that the factored matrix is exactly symmetric.
    Sparse result;
    if (mass.is_diagonal()) {
      const VectorXd inverse_root = mass.diagonal().cwiseSqrt().cwiseInverse();
      Sparse identity(size(), size());
      identity.setIdentity();
      const Sparse k = inverse_root.asDiagonal() * *K_ * inverse_root.asDiagonal();
      result = k.selfadjointView<Eigen::Lower>();
      result -= shift * identity;
    } else {
      result = K_->selfadjointView<Eigen::Lower>();
      result -= shift * mass.coupled()->matrix();
    }
    result.makeCompressed();
    return result;
  }
  /// y = (k - shift I)^-1 x from the factor of shifted(): R (K - shift M)^-1 R^T where M couples.
  void solve(PanelFactor<double>& factor, const VectorXd& x, VectorXd& y) const {
    y = x;
    if (mass.is_diagonal()) return factor.solve(y);
    mass.coupled()->root_solve(y);
    y = mass.times(y);
    factor.solve(y);
    y = mass.times(y);
    mass.coupled()->transposed_root_solve(y);
  }
  /// k for products, in blocks where K has them.
  [[nodiscard]] MassScaledProduct product() const { return {part_.K, mass}; }
  /// An upper bound of |kappa| [1/s^2]: max_j sum_i |k_ij| where M is diagonal, else that with diag(M) over
  /// the least eigenvalue of diag(M)^-1 M.
  [[nodiscard]] double gershgorin() const {
    const VectorXd inverse_root = mass.diagonal().cwiseSqrt().cwiseInverse();
    double largest = 0;
    for (Index j = 0; j < K_->cols(); ++j) {
      double sum = 0;
      for (Sparse::InnerIterator entry(*K_, j); entry; ++entry)
        sum += std::abs(entry.value()) * inverse_root[entry.row()];
      largest = std::max(largest, sum * inverse_root[j]);
    }
    return mass.is_diagonal() ? largest : largest / mass.coupled()->least_share();
  }

 private:
  const MechanicalPart& part_;
  // Holds a dense K as a sparse matrix; unused otherwise.
  Sparse own_;
  const Sparse* K_ = nullptr;
};

/// All eigenvalues, then the `count` largest or those nearest to zero.
ExtremeStiffnesses dense_stiffnesses(const Scaled& scaled, Index count, bool largest) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver{scaled.matrix()};
  const Index n = scaled.size();
  ExtremeStiffnesses result{.shapes = MatrixXd(n, count)};
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index(0));
  const VectorXd& kappa = solver.eigenvalues();
  // Beyond rounding: 1e-8 of the bound.
  result.negative = (kappa.array() < -outside * scaled.gershgorin()).count();
  std::ranges::stable_sort(order, [&](Index a, Index b) {
    return largest ? kappa[a] > kappa[b] : std::abs(kappa[a]) < std::abs(kappa[b]);
  });
  for (Index i = 0; i < count; ++i) {
    const Index from = order[static_cast<std::size_t>(i)];
    result.kappa.push_back(kappa[from]);
    result.shapes.col(i) = scaled.mass.root_solve(solver.eigenvectors().col(from));
  }
  return result;
}

/// The eigenvalues nearest to a shift, of which the shifted matrix can be factored without pivoting: always
/// where the shift is beyond one end of the spectrum.
/// L D L^T of k - shift I; by Sylvester's law of inertia as many pivots are negative as there are kappa <
/// shift.
/// @return  converged = false when there is no such factor, or a residual |k u - kappa u| exceeds 1e-8 of
/// the bound
ExtremeStiffnesses nearest_stiffnesses(const Scaled& scaled, Index count, double shift) {
  const Index n = scaled.size();
  const Sparse shifted = scaled.shifted(shift);
  PanelFactor<double> factor;
  factor.analyse(shifted);
  ExtremeStiffnesses result{.shapes = MatrixXd(n, 0), .converged = false};
  if (!factor.factor(shifted)) return result;
  result.negative = std::ranges::count_if(factor.pivots(), [](double pivot) { return pivot < 0; });
  const SymmetricOperator inverse = [&](const VectorXd& x, VectorXd& y) { scaled.solve(factor, x, y); };
  const LanczosPairs pairs = first_eigenpairs(inverse, n, count, Rank::largest_modulus, most_residual);
  const MassScaledProduct product = scaled.product();
  VectorXd image(n);
  result.converged = pairs.converged;
  result.shapes = scaled.mass.root_solve(pairs.vectors);
  for (Index i = 0; i < pairs.vectors.cols(); ++i) {
    const VectorXd u = pairs.vectors.col(i);
    // What the factor gave is held against the matrix itself.
    product(u, image);
    // theta = 1 / (kappa - shift)
    result.kappa.push_back(shift + 1 / pairs.values[static_cast<std::size_t>(i)]);
    if (!((image - result.kappa.back() * u).norm() <= 1e-8 * scaled.gershgorin())) result.converged = false;
  }
  return result;
}

/// The largest by products alone, of an M that couples by Davidson's method; where these do not converge, by
/// a factor of k - (1 + 1e-8) bound I, which is negative definite by Gershgorin's theorem. Beyond
/// most_factored unknowns no such factor is tried. The smallest always by a factor of k + 1e-8 bound I.
ExtremeStiffnesses krylov_stiffnesses(const Scaled& scaled, Index count, bool largest, bool with_shapes) {
  const double bound = scaled.gershgorin();
  const Index n = scaled.size();
  // Outside the spectrum by more than rounding: the shifted matrix stays regular.
  if (!largest) return nearest_stiffnesses(scaled, count, -outside * bound);
  const MassScaledProduct rows = scaled.product();
  if (!scaled.mass.is_diagonal()) {
    const PencilPairs pairs = largest_pencil_eigenpairs(
        [&](const VectorXd& x, VectorXd& y) { rows.unscaled()(x, y); }, *scaled.mass.coupled(), count,
        most_residual, n > most_factored ? 5000 : 1000);
    const ExtremeStiffnesses result{
        .kappa = pairs.values, .shapes = pairs.vectors, .converged = pairs.converged};
    if (result.converged || n > most_factored) return result;
    // Just beyond the best value, which bounds the spectrum where every pivot is negative.
    ExtremeStiffnesses beside =
        nearest_stiffnesses(scaled, count, (1 + outside) * (pairs.values.front() + pairs.residual));
    if (beside.negative != n) beside = nearest_stiffnesses(scaled, count, (1 + outside) * bound);
    return beside.converged ? beside : result;
  }
  const SymmetricOperator product = [&](const VectorXd& x, VectorXd& y) { rows(x, y); };
  ExtremeStiffnesses result;
  if (count == 1) {
    // Large meshes have no factor to fall back on, so they may iterate longer.
    const LanczosPair pair = largest_eigenpair(product, n,
                                               {.tolerance = most_residual,
                                                .most_products = n > most_factored ? 5000 : 600,
                                                .with_vector = with_shapes});
    result = {.kappa = {pair.value}, .converged = pair.converged};
    if (with_shapes) result.shapes = scaled.mass.root_solve(pair.vector);
  } else {
    const LanczosPairs pairs = first_eigenpairs(product, n, count, Rank::largest, most_residual);
    result = {
        .kappa = pairs.values, .shapes = scaled.mass.root_solve(pairs.vectors), .converged = pairs.converged};
  }
  if (result.converged || n > most_factored) return result;
  // Of a cluster neither may converge, as of a long chain of equal parts; what products gave is near it.
  ExtremeStiffnesses beyond = nearest_stiffnesses(scaled, count, (1 + outside) * bound);
  return beyond.converged ? beyond : result;
}

/// Powers of two that bring row and column i of D^-1 J D to about one size, shape (n): positions and
/// velocities for instance have none in common, and iterations see a matrix as far from normal as its units
/// make it [parlett1969balancing]. All of D moves at once, so each by half of what it would move alone.
VectorXd balance(const Sparse& J) {
  VectorXd log_d = VectorXd::Zero(J.cols());
  // Thirty sweeps; each halves the logarithm of the imbalance of a row that others leave alone.
  for (int sweep = 0; sweep < 30; ++sweep) {
    // Sums of the moduli beside the diagonal of D^-1 J D.
    VectorXd row = VectorXd::Zero(J.rows()), column = row;
    for (Index j = 0; j < J.cols(); ++j)
      for (Sparse::InnerIterator entry(J, j); entry; ++entry) {
        if (entry.row() == j) continue;
        const double size = std::abs(entry.value()) * std::exp2(log_d[j] - log_d[entry.row()]);
        row[entry.row()] += size;
        column[j] += size;
      }
    for (Index i = 0; i < J.cols(); ++i)
      // d_i <- d_i (row / column)^(1/4): alone (row / column)^(1/2) would make both equal.
      if (row[i] > 0 && column[i] > 0) log_d[i] += std::log2(row[i] / column[i]) / 4;
  }
  // Powers of two scale without rounding.
  return log_d.unaryExpr([](double value) { return std::exp2(std::round(value)); });
}

/// Arnoldi iteration on D^-1 J D, whose eigenvalues are those of J. One value more than asked for, so that
/// trim() sees a conjugate.
LargestEigenvalues krylov_largest(const Sparse& J, Index count, Index restarts) {
  const VectorXd d = balance(J);
  const Sparse balanced = d.cwiseInverse().asDiagonal() * J * d.asDiagonal();
  // More vectors than are wanted, so that neighbours of the last one do not hold it up.
  const Index basis = std::min(J.rows(), std::max<Index>(2 * count + 22, 60)), kept = basis / 2;
  LargestEigenvalues result;
  const auto is_decided = [&](const RitzSpectrum& ritz) {
    const Index found = std::min(count + 1, static_cast<Index>(ritz.values.size()));
    result = {.lambda = {}, .vectors = Eigen::MatrixXcd(J.rows(), found)};
    bool decided = found > count || ritz.invariant;
    for (Index i = 0; i < found; ++i) {
      const RitzValue& pair = ritz.values[static_cast<std::size_t>(i)];
      result.lambda.push_back(pair.value);
      // D^-1 J D u = lambda u, so J (D u) = lambda (D u).
      result.vectors.col(i) = d.asDiagonal() * ritz.vector(static_cast<std::size_t>(i));
      decided = decided && pair.residual <= most_residual * std::abs(pair.value);
    }
    return decided && found >= count;
  };
  const ArnoldiSettings settings{
      .basis = basis, .kept = kept, .most_products = basis + restarts * (basis - kept), .conditions = false};
  result.converged =
      visit_ritz_spectra([&](const VectorXd& x) -> VectorXd { return balanced * x; }, start_vector(J.rows()),
                         settings, basis, is_decided) == RitzSearch::decided;
  result.vectors.colwise().normalize();
  return result;
}

/// Dense up to `dense_to` unknowns, where nearly all eigenvalues are asked for, and for K = 0.
ExtremeStiffnesses stiffnesses(const MechanicalPart& part, Index count, Index dense_to, bool largest,
                               bool with_shapes = true) {
  const bool by_dense = goes_dense(part.mass.size(), count, dense_to);
  const Scaled scaled(part);
  if (by_dense || scaled.gershgorin() == 0) return dense_stiffnesses(scaled, count, largest);
  return krylov_stiffnesses(scaled, count, largest, with_shapes);
}

}  // namespace

// A matrix without entries has no Krylov space: it goes to the dense method too.
LargestEigenvalues largest_eigenvalues(const Sparse& J, Index count, Index dense_to, Index restarts) {
  const bool by_dense = goes_dense(J.rows(), count, dense_to) || J.nonZeros() == 0;
  LargestEigenvalues result =
      by_dense ? dense_largest(MatrixXd(J), count) : krylov_largest(J, count, restarts);
  trim(result, count);
  return result;
}

ExtremeStiffnesses largest_stiffnesses(const MechanicalPart& part, Index count, Index dense_to,
                                       bool with_shapes) {
  return stiffnesses(part, count, dense_to, true, with_shapes);
}

ExtremeStiffnesses smallest_stiffnesses(const MechanicalPart& part, Index count, Index dense_to) {
  return stiffnesses(part, count, dense_to, false);
}

// The shift lies 1e-9 beside the given kappa.
ExtremeStiffnesses stiffnesses_near(const MechanicalPart& part, double kappa, Index count) {
  require_sensible(part.mass.size(), count);
  const Scaled scaled(part);
  // An eigenvalue itself would leave nothing to divide by.
  const double shift = kappa + 1e-9 * (kappa != 0 ? std::abs(kappa) : scaled.gershgorin());
  return nearest_stiffnesses(scaled, count, shift);
}

}  // namespace hmax
