#include "analysis/dynamics/coupled_motion.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "analysis/amplification/structural_amplification.hpp"
#include "analysis/spectrum/scaled_matrices.hpp"
#include "core/dense_solvers.hpp"
#include "core/numbers.hpp"
#include "problems/matrix_entries.hpp"

namespace hmax {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// The coefficient of zeta^j; zero beyond the degree.
double coefficient(const Polynomial& p, std::size_t j) {
  return j < p.size() ? static_cast<double>(p[j]) : 0.0;
}

/// p(zeta) by Horner's rule.
Complex value_of(const Polynomial& p, Complex zeta) {
  Complex sum = 0;
  for (std::size_t j = p.size(); j-- > 0;) sum = sum * zeta + static_cast<double>(p[j]);
  return sum;
}

/// Powers of zeta that all of them have are roots at zero, which say nothing.
MotionMap without_zeros(MotionMap map) {
  const std::array<Polynomial*, 4> all{&map.inertia, &map.damper, &map.lumped, &map.spring};
  while (std::ranges::all_of(all, [](const Polynomial* p) { return p->empty() || p->front() == 0; }))
    for (Polynomial* p : all)
      if (!p->empty()) p->erase(p->begin());
  return map;
}

/// The limit at h with a shape that has this kappa, gamma, and damping by the diagonal alone.
CoupledLimit limit_of_shape(const MotionMap& map, double h, MechanicalMode shape, double lumped,
                            const VectorXd& displacement, bool proved) {
  std::vector<Polynomial> p;
  for (std::size_t j = 0; j <= map.degree(); ++j)
    // p_j(h) = inertia_j + h (gamma damper_j + lumped lumped_j) + h^2 kappa spring_j.
    p.push_back({coefficient(map.inertia, j),
                 shape.gamma * coefficient(map.damper, j) + lumped * coefficient(map.lumped, j),
                 shape.kappa * coefficient(map.spring, j)});
  return {.h_max = h,
          .shape = shape,
          .displacement = displacement.normalized(),
          .of_shape = StepPolynomial::real(p),
          .proved = proved};
}

/// Of a symmetric A, but for rounding of 1e-12 of the largest modulus.
bool has_no_negative_eigenvalue(const MatrixXd& A) {
  const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
  return values.size() == 0 || values[0] >= -1e-12 * values.cwiseAbs().maxCoeff();
}

/// Cholesky's factorisation succeeds for positive definite matrices alone, but for rounding; n^3 / 3
/// operations.
bool is_definite(const MatrixXd& A) { return Eigen::LLT<MatrixXd>(A).info() == Eigen::Success; }

/// The smallest positive root of a + b h + e h^2 with a > 0, of which rounding makes no other.
double smallest_root(double a, double b, double e) {
  if (e == 0) return b < 0 ? -a / b : infinity;
  const double discriminant = b * b - 4 * a * e;
  if (discriminant < 0) return infinity;
  // 2 a / (-b + sqrt) without cancellation
  const double root = std::sqrt(discriminant);
  // q = (-b + sign(-b) sqrt(b^2 - 4 a e)) / 2 has no cancellation; the roots are q / e and a / q.
  const double q = b < 0 ? (-b + root) / 2 : (-b - root) / 2;
  double smallest = infinity;
  for (const double each : {q / e, q != 0 ? a / q : infinity})
    if (each > 0) smallest = std::min(smallest, each);
  return smallest;
}

/// Single oscillations from undamped to creeping, and a damper alone.
constexpr std::array<MechanicalMode, 10> sampled_modes{
    {{1, 0}, {1, 2e-3}, {1, 0.02}, {1, 0.2}, {1, 0.6}, {1, 1.2}, {1, 2}, {1, 4}, {1, 20}, {0, 1}}};

/// Whether every single oscillation leaves at zeta = -1, if it does.
/// pi(-1, h) = inertia(-1) + h gamma damper(-1) + h^2 kappa spring(-1): its smallest positive root against
/// the first exit of ten samples, to 1e-9.
bool singles_leave_at_minus_one(const Amplification& single, const MotionMap& map) {
  const double inertia = value_of(map.inertia, -1).real(), sign = inertia < 0 ? -1 : 1;
  return inertia != 0 && std::ranges::all_of(sampled_modes, [&](const MechanicalMode& mode) {
           const double exit = first_exit(single.of_oscillation(mode));
           const double at_minus_one =
               smallest_root(sign * inertia, sign * mode.gamma * value_of(map.damper, -1).real(),
                             sign * mode.kappa * value_of(map.spring, -1).real());
           return exit == at_minus_one || std::abs(exit - at_minus_one) <= 1e-9 * exit;
         });
}

/// The map for which lumping_keeps_stable() is true.
bool has_kicks_with_lumped_damping(const MotionMap& map) {
  const MotionMap kicks = kick_drift_kick_amplification(KickDamping::lumped).motion.value();
  return map.inertia == kicks.inertia && map.damper == kicks.damper && map.lumped == kicks.lumped &&
         map.spring == kicks.spring;
}

/// Of the ten samples; for each proved by its conditions.
bool singles_never_leave(const Amplification& single) {
  return std::ranges::all_of(sampled_modes, [&](const MechanicalMode& mode) {
    return std::isinf(first_exit(single.of_oscillation(mode)));
  });
}

/// The limit of steps that no single oscillation leaves, whatever the matrices are; nothing for others.
std::optional<CoupledLimit> without_exit(const MotionMap& map, const Amplification& single) {
  if (!map.lumped.empty() || !singles_never_leave(single)) return std::nullopt;
  return CoupledLimit{.h_max = infinity, .proved = true};
}

}  // namespace

// A method that takes the diagonal of C apart couples modes unless C is diagonal.
bool couples_modes(const MotionMap& map, const MechanicalPart& part) {
  if (!part.decouples()) return true;
  if (map.lumped.empty()) return false;
  double all = 0, beside = 0;  // squares of Frobenius norms
  each_entry(part.C, [&](Index i, Index j, double value) {
    all += value * value;
    if (i != j) beside += value * value;
  });
  return std::sqrt(beside) > 1e-12 * std::sqrt(all);
}

// A Newton-like iteration for the least h at which P(-1, h) has a kernel: the quadratic of the current
// least eigenvector is solved exactly, then a new eigenvector is taken. Products with sparse k and c
// alone.
std::optional<CoupledLimit> proved_first_exit(const MotionMap& map, const FindLargestOfSum& find,
                                              double most_c, double most_k, const Amplification& single) {
  if (std::optional<CoupledLimit> none = without_exit(map, single)) return none;
  if (!map.lumped.empty() || !singles_leave_at_minus_one(single, map)) return std::nullopt;
  const double inertia = value_of(map.inertia, -1).real(), sign = inertia < 0 ? -1 : 1,
               damper = sign * value_of(map.damper, -1).real(),
               spring = sign * value_of(map.spring, -1).real();
  // Below this step P(-1, h) is definite by the norms of c and k alone: a start from below.
  double h = smallest_root(std::abs(inertia), std::min(damper, 0.0) * most_c, std::min(spring, 0.0) * most_k);
  if (std::isinf(h)) return std::nullopt;
  for (int iteration = 0; iteration < 50; ++iteration) {
    // The least eigenvector of P(-1, h) = |inertia| I + h damper c + h^2 spring k.
    const LargestOfSum least = find(-h * damper, -h * h * spring, 1e-9);
    // P(-1, next) is zero along it, so the first exit is not beyond it.
    const double next = smallest_root(std::abs(inertia), damper * least.gamma, spring * least.kappa);
    if (std::abs(next - h) <= 1e-10 * h) {
      if (!least.converged) return std::nullopt;
      return limit_of_shape(map, next, {.kappa = least.kappa, .gamma = least.gamma}, 0, least.vector, true);
    }
    h = next;
    if (!std::isfinite(h)) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<CoupledLimit> proved_first_exit(const MotionMap& map, const MechanicalPart& part,
                                              const Amplification& single) {
  if (!part.symmetric) return std::nullopt;
  if (std::optional<CoupledLimit> none = without_exit(map, single)) return none;
  if (!map.lumped.empty() || !singles_leave_at_minus_one(single, map)) return std::nullopt;
  const ScaledMatrices scaled(part);
  const double most_c = scaled.largest_c().bound, most_k = scaled.largest_k().bound;
  std::optional<CoupledLimit> limit =
      proved_first_exit(map, scaled.largest_of_sum(most_c, most_k), most_c, most_k, single);
  if (limit && limit->displacement.size() > 0)
    limit->displacement = VectorXd(scaled.mass.root_solve(limit->displacement)).normalized();
  return limit;
}

CoupledMotion::CoupledMotion(const MotionMap& map, const MechanicalPart& part)
    : map_(without_zeros(map)), n_(part.mass.size()), mass_(part.mass), symmetric_(part.symmetric) {
  k_ = mass_scaled(part.mass, part.K);
  c_ = mass_scaled(part.mass, part.C);
  // Symmetric to the last bit.
  if (symmetric_) {
    k_ = ((k_ + k_.transpose()) / 2).eval();
    c_ = ((c_ + c_.transpose()) / 2).eval();
  }
  d_ = c_.diagonal().asDiagonal();
  // Bounds of the eigenvalues: the largest sum of a row.
  const auto bound = [](const MatrixXd& A) { return A.cwiseAbs().rowwise().sum().maxCoeff(); };
  rate_ = std::max(std::sqrt(bound(k_)), bound(c_));
  // A body free to drift has the double root 1, of which rounding makes 1 +- sqrt(rounding).
  const bool drifts = Eigen::FullPivLU<MatrixXd>(k_).setThreshold(1e-12).rank() < n_;
  rounding_ = drifts ? 1e-6 : 1e-10;
}

// Linearises the matrix polynomial sum_j zeta^j P_j by its block companion matrix.
std::vector<Complex> CoupledMotion::roots(double h) const {
  const std::size_t degree = map_.degree();
  // P_j of P(zeta) = sum_j zeta^j P_j.
  const auto block = [&](std::size_t j) {
    MatrixXd P = h * coefficient(map_.damper, j) * c_ + h * coefficient(map_.lumped, j) * d_ +
                 h * h * coefficient(map_.spring, j) * k_;
    P.diagonal().array() += coefficient(map_.inertia, j);
    return P;
  };
  // P_d has to be regular: it is what a step solves for.
  const Eigen::PartialPivLU<MatrixXd> leading(block(degree));
  const Index size = static_cast<Index>(degree) * n_;
  MatrixXd companion = MatrixXd::Zero(size, size);
  for (std::size_t j = 0; j < degree; ++j)
    // First row of blocks -P_d^-1 P_d-1, ..., -P_d^-1 P_0; identities below the diagonal. It acts on
    // (zeta^(d-1) x, ..., zeta x, x).
    companion.block(0, static_cast<Index>(degree - 1 - j) * n_, n_, n_) = -leading.solve(block(j));
  companion.bottomLeftCorner(size - n_, size - n_).diagonal().setOnes();
  if (!companion.allFinite()) return {infinity};
  const Eigen::EigenSolver<MatrixXd> solver(companion, false);
  if (solver.info() != Eigen::Success) return {infinity};
  return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
}

double CoupledMotion::spectral_radius(double h) const {
  double radius = 0;
  for (const Complex zeta : roots(h)) radius = std::max(radius, std::abs(zeta));
  return radius;
}

MatrixXcd CoupledMotion::at(Complex zeta, double h) const {
  MatrixXcd P = h * value_of(map_.damper, zeta) * c_ + h * value_of(map_.lumped, zeta) * d_ +
                h * h * value_of(map_.spring, zeta) * k_;
  P.diagonal().array() += value_of(map_.inertia, zeta);
  return P;
}

// Quotients x* A x / x* x of k, c and the diagonal of c.
CoupledLimit CoupledMotion::leaves_with(double h, const VectorXcd& x, bool proved) const {
  // x* A x / x* x, real for symmetric A.
  const auto of_shape = [&](const MatrixXd& A) { return x.dot(A * x).real() / x.squaredNorm(); };
  // Turned so that its largest entry is real.
  Index largest = 0;
  x.cwiseAbs().maxCoeff(&largest);
  return limit_of_shape(map_, h, {.kappa = of_shape(k_), .gamma = of_shape(c_)}, of_shape(d_),
                        mass_.root_solve(VectorXd((x / x[largest]).real())), proved);
}

CoupledLimit CoupledMotion::with_shape(double h, Complex zeta, bool proved) const {
  // Inverse iteration a hair beside the root.
  const Eigen::PartialPivLU<MatrixXcd> P(at(zeta * (1 + 1e-10), h));
  // A start without the symmetries that modes may have.
  VectorXcd x = VectorXcd::LinSpaced(n_, 1, 2);
  for (int i = 0; i < 4; ++i) x = P.solve(x).normalized();
  return leaves_with(h, x, proved);
}

// Cholesky's factorisation of sign P(-1, h) as a test, strides outwards from where norms prove that it is
// definite, then bisection.
std::optional<double> CoupledMotion::leaves_at_minus_one() const {
  const double inertia = value_of(map_.inertia, -1).real();
  if (inertia == 0) return std::nullopt;
  const double sign = inertia < 0 ? -1 : 1;
  // sign P(-1, h) = |inertia| I + h first + h^2 second, positive definite at h = 0.
  const MatrixXd first =
                     sign * (value_of(map_.damper, -1).real() * c_ + value_of(map_.lumped, -1).real() * d_),
                 second = sign * value_of(map_.spring, -1).real() * k_;
  const auto definite = [&](double h) {
    MatrixXd S = h * first + h * h * second;
    S.diagonal().array() += std::abs(inertia);
    return is_definite(S);
  };
  // Up to here the norms alone say that it is definite.
  const double sure = smallest_root(std::abs(inertia), -first.cwiseAbs().rowwise().sum().maxCoeff(),
                                    -second.cwiseAbs().rowwise().sum().maxCoeff());
  if (std::isinf(sure)) return std::nullopt;
  double low = sure * (1 - 1e-12), high = low;
  do {
    low = high;
    high *= 1.1;
    if (high > 1e6 * sure) return std::nullopt;
    // Strides of 10 % outwards, then bisection to 1e-14.
  } while (definite(high));
  while (high - low > 1e-14 * high) {
    const double middle = low + (high - low) / 2;
    if (middle == low || middle == high) break;
    (definite(middle) ? low : high) = middle;
  }
  return low;
}

// Newton's method for theta and h on g(theta, h) of the bordered system; where it fails or leaves the
// bracket, the bracket is halved and it starts again.
CoupledLimit CoupledMotion::refined(double stable, double unstable) const {
  // The root that is outside at the unstable end, then both ends closer until Newton's method finds the exit
  // between them:  g(theta, h) = 0  for  (P, b; b*, 0) (x, g) = (0, 1),
  // which vanishes where P does not have full rank.
  for (;;) {
    Complex zeta = 0;
    for (const Complex each : roots(unstable))
      if (std::abs(each) > std::abs(zeta)) zeta = each;
    double theta = std::arg(zeta), h = unstable;
    VectorXcd b = VectorXcd::LinSpaced(n_, 1, 2).normalized();
    if (std::isfinite(std::abs(zeta))) {
      const Eigen::PartialPivLU<MatrixXcd> P(at(zeta * (1 + 1e-9), h));
      for (int i = 0; i < 3; ++i) b = P.solve(b).normalized();
    }
    for (int iteration = 0; iteration < 25 && std::isfinite(theta) && h > 0; ++iteration) {
      const Complex on_circle = std::polar(1.0, theta);
      const auto bordered = [&](Complex z, double step) {
        MatrixXcd A(n_ + 1, n_ + 1);
        A << at(z, step), b, b.adjoint(), Complex(0);
        return A;
      };
      const Eigen::PartialPivLU<MatrixXcd> A(bordered(on_circle, h));
      VectorXcd unit = VectorXcd::Zero(n_ + 1);
      unit[n_] = 1;
      // Right and left vectors of the bordered matrix: g = 0 if and only if P x = 0 with b* x = 1.
      const VectorXcd x = A.solve(unit), w = A.adjoint().solve(unit);
      const Complex g = x[n_];
      // dg = -w* dP x
      constexpr double small = 1e-6;
      const auto slope = [&](const MatrixXcd& more, const MatrixXcd& less, double across) {
        return -w.head(n_).dot((more - less) * x.head(n_)) / across;
      };
      const Complex by_theta =
          slope(at(std::polar(1.0, theta + small), h), at(std::polar(1.0, theta - small), h), 2 * small);
      const Complex by_h =
          slope(at(on_circle, h * (1 + small)), at(on_circle, h * (1 - small)), 2 * small * h);
      // Two real equations, Re g = Im g = 0, in theta and h, by Cramer's rule.
      const double determinant = by_theta.real() * by_h.imag() - by_theta.imag() * by_h.real();
      const double d_theta = (-g.real() * by_h.imag() + g.imag() * by_h.real()) / determinant,
                   d_h = (-by_theta.real() * g.imag() + by_theta.imag() * g.real()) / determinant;
      theta += d_theta;
      h += d_h;
      // Converged when neither changes.
      if (std::abs(d_theta) > 1e-11 || std::abs(d_h) > 1e-12 * h) continue;
      if (h < stable * (1 - 1e-6) || h > unstable * (1 + 1e-6)) break;
      // Two exits may lie between the ends.
      if (const double below = h * (1 - 1e-6); below > stable && spectral_radius(below) > 1 + rounding_) {
        unstable = below;
        break;
      }
      return leaves_with(h, x.head(n_), false);
    }
    if (unstable - stable <= 1e-8 * unstable) return with_shape(stable, zeta, false);
    // Newton's method has failed from here: half of the bracket, geometrically.
    const double middle = std::sqrt(stable * unstable);
    (spectral_radius(middle) <= 1 + rounding_ ? stable : unstable) = middle;
  }
}

std::optional<CoupledLimit> CoupledMotion::by_strides(std::optional<double> at_minus_one) const {
  const Index rows = static_cast<Index>(map_.degree()) * n_;
  if (rows > most_coupled_rows) return std::nullopt;
  // Larger systems have denser spectra and dearer eigenproblems.
  const double ratio = rows <= 60 ? 1.05 : rows <= 240 ? 1.2 : 1.5;
  const auto growth_at = [&](double h) { return spectral_radius(h) - 1; };
  const auto is_stable = [&](double h) { return growth_at(h) <= rounding_; };
  // Growth that fades no faster than h^5 ends nowhere but in rounding: gyroscopic forces of the velocities
  // before a step amplify by O(h^2). Beyond a step where stability ends it is large.
  const auto unless_fading = [&](CoupledLimit limit) {
    constexpr double fading = 32;
    if (growth_at(2 * limit.h_max) <= fading * rounding_) limit.h_max = 0;
    return limit;
  };
  // Well below 1 / rate_, the fastest time scale of the model.
  double stable = 0.1 / rate_;
  if (!is_stable(stable)) {
    // Smaller steps, down to where one of every size must be unstable.
    double unstable = stable;
    do {
      unstable = stable;
      stable /= 4;
      if (stable < 1e-5 / rate_) return CoupledLimit{.h_max = 0};
    } while (!is_stable(stable));
    return unless_fading(refined(stable, unstable));
  }
  // A root is -1 where P(-1, h) ceases to be definite, so the first exit is not beyond it. Without such
  // a step the strides end at 1e4 / rate_.
  const double farthest = at_minus_one.value_or(1e4 / rate_);
  for (double h = stable; h < farthest;) {
    h = std::min(h * ratio, at_minus_one ? farthest * (1 - 1e-6) : infinity);
    if (!is_stable(h)) return unless_fading(refined(stable, h));
    stable = h;
    if (at_minus_one && h >= farthest * (1 - 2e-6)) break;
  }
  if (at_minus_one) return with_shape(*at_minus_one, -1, false);
  return CoupledLimit{.h_max = infinity};
}

// Looks for a rho with K <= rho C, the least first, by factors of rho C - K; the answer is that of the
// first one found.
bool CoupledMotion::lumping_keeps_stable(double h) const {
  if (!is_definite(c_ + 1e-12 * c_.trace() * MatrixXd::Identity(n_, n_))) return false;
  // K <= rho C: at least what the diagonals say, and of no use where it is much more.
  // K <= rho C needs k_ii <= rho c_ii for all i.
  const double least = (k_.diagonal().array() / c_.diagonal().array()).maxCoeff();
  for (double rho = least; rho > 0 && rho <= 1e3 * least; rho *= 1.2) {
    if (!is_definite(rho * (c_ + 1e-12 * c_.trace() * MatrixXd::Identity(n_, n_)) - k_)) continue;
    return is_definite(MatrixXd::Identity(n_, n_) + h / 2 * c_ + h * h * rho / 2 * (c_ - d_));
  }
  return false;
}

// Proofs first: nothing moves, no oscillation ever leaves, all leave at -1; then central differences with
// lumped damping; strides as the last resort.
std::optional<CoupledLimit> CoupledMotion::first_exit(const Amplification& single) const {
  if (rate_ == 0) return CoupledLimit{.h_max = infinity, .proved = true};
  if (!symmetric_) return by_strides(std::nullopt);
  if (map_.lumped.empty() && has_no_negative_eigenvalue(k_) && has_no_negative_eigenvalue(c_)) {
    if (singles_never_leave(single)) return CoupledLimit{.h_max = infinity, .proved = true};
    if (singles_leave_at_minus_one(single, map_))
      if (const auto h = leaves_at_minus_one()) return with_shape(*h, -1, true);
  }
  const std::optional<double> at_minus_one = leaves_at_minus_one();
  if (at_minus_one && has_kicks_with_lumped_damping(map_) && has_no_negative_eigenvalue(k_) &&
      lumping_keeps_stable(*at_minus_one))
    return with_shape(*at_minus_one, -1, true);
  return by_strides(at_minus_one);
}

}  // namespace hmax
