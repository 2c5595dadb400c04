#include "analysis/spectrum/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "core/dense_solvers.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Growing modulus; conjugates stay together, the upper one first.
bool comes_before(Complex a, Complex b) {
  const double size_a = std::abs(a), size_b = std::abs(b);
  if (size_a != size_b) return size_a < size_b;
  if (a.real() != b.real()) return a.real() < b.real();
  return a.imag() > b.imag();
}

/// @throws InputError  beyond most_dense_rows
void require_dense_size(Index n) {
  if (n > most_dense_rows)
    throw InputError(
        fmt::format("all eigenvalues of {} unknowns are too many for dense methods, which take at "
                    "most {}; ask for the extreme ones",
                    n, most_dense_rows));
}

/// @throws InputError  when the QR iteration has given up
void require_convergence(Eigen::ComputationInfo info) {
  if (info != Eigen::Success)
    throw InputError(
        "the eigenvalues of the Jacobian did not converge; scale the model so that its entries are "
        "of similar size");
}

/// A mechanical part as dense matrices of one unit: k = R^-T K R^-1 [1/s^2], c = R^-T C R^-1 [1/s], M = R^T
/// R. Similar to M^-1 K and M^-1 C, and symmetric where K and C are.
struct MassScaled {
  MatrixXd k, c;  ///< shape (n, n) each

  explicit MassScaled(const MechanicalPart& part)
      : k(mass_scaled(part.mass, part.K)), c(mass_scaled(part.mass, part.C)) {}
};

/// B = (0, s I; -k / s, -c) acts on (s R q, R v), M = R^T R.
struct Companion {
  double s = 1;  ///< a typical omega [rad/s]
  MatrixXd B;    ///< shape (2 n, 2 n) [1/s]

  /// B has shape (2 n, 2 n); s = 1 where K is zero.
  explicit Companion(const MechanicalPart& part) {
    const MassScaled scaled(part);
    const Index n = scaled.k.rows();
    // The root mean square of the eigenvalues of a symmetric k: s = sqrt of it is a typical omega.
    const double size = scaled.k.norm() / std::sqrt(static_cast<double>(n));
    if (size > 0) s = std::sqrt(size);
    B.setZero(2 * n, 2 * n);
    B.topRightCorner(n, n).diagonal().setConstant(s);
    B.bottomLeftCorner(n, n) = -scaled.k / s;
    B.bottomRightCorner(n, n) = -scaled.c;
  }
};

/// alpha and beta of c = alpha I + beta k, by least squares, where they leave nothing but rounding.
std::optional<std::pair<double, double>> rayleigh_coefficients(const MatrixXd& k, const MatrixXd& c) {
  const Index n = k.rows();
  const double mean_k = k.trace() / static_cast<double>(n), mean_c = c.trace() / static_cast<double>(n);
  const auto identity = MatrixXd::Identity(n, n);
  // k without its part along I: the two are orthogonal in the product trace(A^T B), so beta and alpha are
  // found one after the other.
  const MatrixXd deviation = k - mean_k * identity;
  const double square = deviation.squaredNorm();
  const double beta = square > 0 ? deviation.cwiseProduct(c).sum() / square : 0;
  if ((c - mean_c * identity - beta * deviation).norm() > 1e-13 * c.norm()) return std::nullopt;
  const double alpha = mean_c - beta * mean_k;
  // Without mass damping rounding is left, and its sign would be that of growth of a free body.
  return std::pair(std::abs(alpha) <= 1e-13 * std::abs(mean_c) ? 0.0 : alpha, beta);
}

/// Within the columns of u from `first`, `count` many, that share an eigenvalue of k: the eigenvectors of c.
/// Any orthonormal basis of an eigenspace of k serves k; that of u^T c u makes c diagonal too.
void diagonalise_within(const MatrixXd& c, Index first, Index count, MatrixXd& u) {
  const MatrixXd basis = u.middleCols(first, count);
  const MatrixXd block = basis.transpose() * c * basis;
  u.middleCols(first, count) = basis * Eigen::SelfAdjointEigenSolver<MatrixXd>(block).eigenvectors();
}

/// What is asked for of n eigenvectors, scaled or not: V, V^-1 and the condition.
void complete(Eigenvectors& result) {
  result.defective = !(result.condition <= defective_condition);
  if (!result.defective) return;
  result.left.resize(0, 0);
  result.note = fmt::format(
      "the Jacobian is defective to rounding (condition {:.1e} of its eigenvectors): two modes share one "
      "eigenvector, as at critical damping, and grow like t exp(lambda t) before they decay",
      result.condition);
}

/// (phi, lambda phi) for both eigenvalues of each mode; left vectors from the inverse of (1, 1; l1, l2).
Eigenvectors decoupled_eigenvectors(const MechanicalPart& part) {
  const MechanicalModes modal = mechanical_modes(part, true);
  const Index n = part.mass.size();
  Eigenvectors result;
  result.right.resize(2 * n, 2 * n);
  result.left.resize(2 * n, 2 * n);
  double largest = 0, smallest = infinity;
  for (Index i = 0; i < n; ++i) {
    const MechanicalMode& mode = modal.modes[static_cast<std::size_t>(i)];
    const auto lambda = eigenvalues_of(mode);
    const VectorXd shape = modal.shapes.col(i), dual = part.mass.times(shape);
    for (const Index k : {Index(0), Index(1)}) {
      const Complex own = lambda[static_cast<std::size_t>(k)],
                    other = lambda[static_cast<std::size_t>(1 - k)];
      // |(phi, lambda phi)| = |phi| sqrt(1 + |lambda|^2).
      const double length = shape.norm() * std::sqrt(1 + std::norm(own));
      result.lambda.push_back(own);
      result.right.col(2 * i + k) << (shape / length).cast<Complex>(), own * (shape / length);
      // (1, 1; l1, l2)^-1 = (-l2, 1; l1, -1) / (l1 - l2); rows times phi^T M.
      const Complex factor = length / (own - other);
      result.left.row(2 * i + k) << -other * factor * dual.transpose(), factor * dual.transpose();
    }
    // The two columns (w, l) / |(w, l)|: with g the product of both, the singular values squared are 1 +-
    // |g|, and their product is the determinant.
    // The modes are orthogonal to one another in these coordinates, so the condition of V is that of 2 x 2
    // blocks.
    const double w = std::sqrt(std::max(std::abs(mode.kappa), std::numeric_limits<double>::min()));
    // Root by root: of a free motion the product of both squares is zero.
    const double lengths = std::sqrt(w * w + std::norm(lambda[0])) * std::sqrt(w * w + std::norm(lambda[1]));
    const double g = std::min(1.0, std::abs(w * w + std::conj(lambda[0]) * lambda[1]) / lengths);
    const double longest = std::sqrt(1 + g);
    // sigma_1 sigma_2 = |det| = w |l2 - l1| / (product of the lengths).
    largest = std::max(largest, longest);
    smallest = std::min(smallest, w * std::abs(lambda[1] - lambda[0]) / lengths / longest);
  }
  // Largest singular value of all blocks over the smallest one.
  result.condition = smallest > 0 ? largest / smallest : infinity;
  complete(result);
  return result;
}

/// The eigenvectors of A, where x = T y are the coordinates that A acts on.
/// condition = sigma_1 / sigma_n of the eigenvectors of A, each of length 1.
/// @param to, back  T and its inverse, shape (n, n)
Eigenvectors general_eigenvectors(const MatrixXd& A, const MatrixXd& to, const MatrixXd& back) {
  const Index n = A.rows();
  Eigen::EigenSolver<MatrixXd> solver(A, true);
  require_convergence(solver.info());
  const Eigen::VectorXcd& values = solver.eigenvalues();
  const MatrixXcd vectors = solver.eigenvectors();
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index(0));
  std::ranges::sort(order, [&](Index a, Index b) { return comes_before(values[a], values[b]); });

  Eigenvectors result;
  MatrixXcd scaled(n, n);
  MatrixXd real(n, n);
  for (Index i = 0; i < n; ++i) {
    const Index from = order[static_cast<std::size_t>(i)];
    result.lambda.push_back(values[from]);
    scaled.col(i) = vectors.col(from).normalized();
    // (x, conj x) = sqrt(2) (Re x, Im x) U with a unitary U, which changes no singular value. Eigen's vectors
    // of a pair that is real to rounding are two real ones.
    const Eigen::VectorXcd x = scaled.col(i);
    if (x.imag().isZero(0))
      real.col(i) = x.real();
    else
      real.col(i) = std::numbers::sqrt2 * (values[from].imag() < 0 ? VectorXd(x.imag()) : VectorXd(x.real()));
  }
  // In the coordinates of A: the condition in the norm of energy.
  result.condition = condition_of(real);
  // A x = lambda x with x = T y: y = T^-1 x, made to length 1 again; rows of V^-1 alike.
  result.right = back * scaled;
  // right = T^-1 scaled L^-1 with the lengths L, so its inverse is L scaled^-1 T.
  const VectorXd lengths = result.right.colwise().norm();
  result.right = result.right * lengths.cwiseInverse().asDiagonal();
  if (result.condition <= defective_condition)
    result.left = lengths.asDiagonal() * MatrixXcd(MatrixXcd(scaled.inverse()) * to);
  complete(result);
  return result;
}

/// half +- sqrt(discriminant), the roots of lambda^2 - 2 half lambda + product, discriminant = half^2 -
/// product. The real one of larger modulus has no cancellation; the other follows from the product.
std::array<Complex, 2> roots_of(double half, double discriminant, double product) {
  if (discriminant < 0) {
    const double damped = std::sqrt(-discriminant);
    return {Complex(half, damped), Complex(half, -damped)};
  }
  const double root = std::sqrt(discriminant);
  const double larger = half < 0 ? half - root : half + root;
  const double smaller = larger == 0 ? 0 : product / larger;
  return {Complex(std::max(larger, smaller), 0.0), Complex(std::min(larger, smaller), 0.0)};
}

}  // namespace

// lambda = -zeta omega + i omega sqrt(1 - zeta^2), so |lambda| = omega.
Mode mode_of(Complex lambda) {
  if (lambda.imag() == 0) return {.lambda = lambda};
  const double omega = std::abs(lambda);
  return {.lambda = lambda, .omega = omega, .zeta = -lambda.real() / omega};
}

// Overdamped modes have two rates -lambda_1 >= -lambda_2 and zeta > 1; an unstable spring (kappa < 0) has
// rates of both signs.
Mode mode_of(const MechanicalMode& oscillation) {
  const auto [upper, lower] = eigenvalues_of(oscillation);
  const bool swings = upper.imag() != 0;
  Mode mode{.lambda = swings ? upper : lower};
  if (oscillation.kappa >= 0) mode.omega = std::sqrt(oscillation.kappa);
  if (oscillation.kappa > 0) mode.zeta = oscillation.gamma / (2 * *mode.omega);
  if (swings) return mode;
  mode.rates = {0 - lower.real(), 0 - upper.real()};  // of a free motion 0, not -0
  if (std::abs(upper) > std::abs(lower)) std::swap((*mode.rates)[0], (*mode.rates)[1]);
  return mode;
}

std::array<Complex, 2> eigenvalues_of(const MechanicalMode& mode) {
  const double half = -mode.gamma / 2;
  // gamma^2/4 - kappa as a product keeps its digits near critical damping.
  const double w = std::sqrt(std::abs(mode.kappa));
  // (gamma/2)^2 - omega^2 = (gamma/2 - omega)(gamma/2 + omega).
  return roots_of(half, mode.kappa > 0 ? (half - w) * (half + w) : half * half + w * w, mode.kappa);
}

std::array<Complex, 2> eigenvalues_2x2(const Eigen::Matrix2d& J) {
  // T^2/4 - D = ((J11 - J22)/2)^2 + J12 J21: for a symmetric matrix a sum of squares, never negative by
  // rounding.
  const double half_difference = (J(0, 0) - J(1, 1)) / 2;
  return roots_of(J.trace() / 2, half_difference * half_difference + J(0, 1) * J(1, 0), J.determinant());
}

// k u = kappa u; gamma by Rayleigh's coefficients where C has them, else u^T c u in a basis that makes c
// diagonal within each eigenspace of k.
MechanicalModes mechanical_modes(const MechanicalPart& part, bool with_shapes) {
  if (!part.decouples())
    throw std::invalid_argument(
        "modes of their own need symmetric K and C and proportional damping; take the eigenvalues of the "
        "whole");
  const Index n = part.mass.size();
  require_dense_size(n);
  const MassScaled scaled(part);
  MechanicalModes result;
  result.modes.resize(static_cast<std::size_t>(n));
  if (n == 1) {
    result.modes[0] = {scaled.k(0, 0), scaled.c(0, 0)};
    if (with_shapes) result.shapes = part.mass.root_solve(MatrixXd::Ones(1, 1));
    return result;
  }

  const bool damped = part.damping != Damping::none;
  // gamma = alpha + beta kappa needs no eigenvectors.
  const auto rayleigh = damped ? rayleigh_coefficients(scaled.k, scaled.c) : std::pair(0.0, 0.0);
  const bool with_vectors = with_shapes || !rayleigh;
  Eigen::SelfAdjointEigenSolver<MatrixXd> solver(
      scaled.k, with_vectors ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly);
  require_convergence(solver.info());
  // A free body has stiffnesses that are zero but for rounding, and their sign would be that of growth.
  VectorXd kappa = solver.eigenvalues();
  const double rounding = 1e-14 * static_cast<double>(n) * kappa.cwiseAbs().maxCoeff();
  for (double& each : kappa)
    if (std::abs(each) <= rounding) each = 0;
  if (rayleigh) {
    for (Index i = 0; i < n; ++i)
      result.modes[static_cast<std::size_t>(i)] = {kappa[i], rayleigh->first + rayleigh->second * kappa[i]};
    if (with_shapes) result.shapes = part.mass.root_solve(solver.eigenvectors());
    return result;
  }

  MatrixXd u = solver.eigenvectors();
  // Eigenvectors whose kappa differ by more than this are right to 1e-8, and what they say of gamma to its
  // square.
  const double gap = 1e-8 * kappa.cwiseAbs().maxCoeff();
  for (Index first = 0, next = 0; first < n; first = next) {
    // Runs of neighbouring kappa no more than `gap` apart form one eigenspace.
    for (next = first + 1; next < n && kappa[next] - kappa[next - 1] <= gap;) ++next;
    if (next - first > 1) diagonalise_within(scaled.c, first, next - first, u);
  }
  // gamma_i = u_i^T c u_i.
  const MatrixXd cu = scaled.c * u;
  for (Index i = 0; i < n; ++i)
    result.modes[static_cast<std::size_t>(i)] = {kappa[i], u.col(i).dot(cu.col(i))};
  if (with_shapes) result.shapes = part.mass.root_solve(u);
  return result;
}

// Hessenberg form and shifted QR iteration, some 10 n^3 operations without vectors (Golub and Van Loan,
// Matrix Computations).
std::vector<Complex> all_eigenvalues(const MatrixXd& J) {
  require_dense_size(J.rows());
  std::vector<Complex> lambda;
  lambda.reserve(static_cast<std::size_t>(J.rows()));
  if (J.rows() == 2) {
    // Two states in closed form.
    const auto pair = eigenvalues_2x2(J);
    lambda.assign(pair.begin(), pair.end());
  } else if (J.rows() > 0) {
    const Eigen::EigenSolver<MatrixXd> solver(J, false);
    require_convergence(solver.info());
    for (const Complex& value : solver.eigenvalues()) lambda.push_back(value);
  }
  std::ranges::sort(lambda, comes_before);
  return lambda;
}

// By modes, by the companion form or by J itself: the smallest problem that serves.
Spectrum spectrum_of(const LinearModel& model) {
  require_dense_size(model.y.size());
  Spectrum spectrum;
  if (!model.mechanical) {
    spectrum.lambda = all_eigenvalues(dense(model.J()));
    return spectrum;
  }
  if (!model.mechanical->decouples()) {
    spectrum.lambda = all_eigenvalues(Companion(*model.mechanical).B);
    return spectrum;
  }
  spectrum.mechanical = mechanical_modes(*model.mechanical).modes;
  spectrum.lambda.reserve(2 * spectrum.mechanical.size());
  for (const MechanicalMode& mode : spectrum.mechanical)
    for (const Complex& lambda : eigenvalues_of(mode)) spectrum.lambda.push_back(lambda);
  return spectrum;
}

// Coordinates x = T y: (s R q, R v) for the companion form.
Eigenvectors eigenvectors_of(const LinearModel& model) {
  require_dense_size(model.y.size());
  if (!model.mechanical) {
    const MatrixXd same = MatrixXd::Identity(model.y.size(), model.y.size());
    return general_eigenvectors(dense(model.J()), same, same);
  }
  if (model.mechanical->decouples()) return decoupled_eigenvectors(*model.mechanical);
  const Companion companion(*model.mechanical);
  const MassMatrix<double>& M = model.mechanical->mass;
  const Index n = M.size();
  const MatrixXd same = MatrixXd::Identity(n, n), root = M.root_times(same),
                 inverse_root = M.root_solve(same);
  MatrixXd to = MatrixXd::Zero(2 * n, 2 * n), back = to;
  to.topLeftCorner(n, n) = companion.s * root;
  to.bottomRightCorner(n, n) = root;
  back.topLeftCorner(n, n) = inverse_root / companion.s;
  back.bottomRightCorner(n, n) = inverse_root;
  return general_eigenvectors(companion.B, to, back);
}

}  // namespace hmax
