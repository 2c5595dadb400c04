/// Masses on a line between two walls, joined by springs and dampers: a soft tissue of known spectrum.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "problems/digits.hpp"
#include "problems/test_set/common.hpp"

namespace hmax {

struct SpringChainParameters {
  double n = 20;     ///< number of masses [1]
  double m = 0.005;  ///< each mass [kg], m > 0
  double k = 100;    ///< linear stiffness of each spring [N/m], k > 0
  double c = 0.05;   ///< damping of each spring [N s/m], c >= 0
  double k3 = 0;     ///< cubic stiffness of each spring [N/m^3]; 0: linear, with an exact solution
  static constexpr ParameterNames<SpringChainParameters, 5> names{{{"n", &SpringChainParameters::n},
                                                                   {"m", &SpringChainParameters::m},
                                                                   {"k", &SpringChainParameters::k},
                                                                   {"c", &SpringChainParameters::c},
                                                                   {"k3", &SpringChainParameters::k3}}};
};

/// n masses between two walls, displacements q_1 ... q_n along the line [m], q_0 = q_(n+1) = 0, y = (q, v),
/// shape (2 n).
///   m q_i'' = T_(i+1) - T_i,   T_i = k s_i + c s_i' + k3 s_i^3,   s_i = q_i - q_(i-1)
/// At the start the chain is at rest but for the first mass, which moves at 1 m/s: every mode is excited.
/// With k3 = 0 the modes are sines, kappa_j = 4 sin^2(j pi / (2 (n + 1))), and each is a damped oscillator
///   m a'' + c kappa_j a' + k kappa_j a = 0.
/// The stiff part of the split is the linear springs and the dampers.
/// @source  [hairer2006geometric, I.5] for the cubic chain of Fermi, Pasta and Ulam; the spectrum is that of
///          the second difference with fixed ends
template <class Real>
class SpringChain {
 public:
  using State = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  using Jacobian = Eigen::SparseMatrix<Real>;
  using Dofs = State;
  using DofMatrix = Eigen::SparseMatrix<Real>;
  using Parameters = SpringChainParameters;
  static constexpr std::string_view id = "spring_chain", source = "hairer2006geometric",
                                    note =
                                        "n masses on springs and dampers between two walls, known spectrum";
  static constexpr bool autonomous = true, stiff = false;
  static constexpr double t_end = 1;

  /// @throws std::invalid_argument  unless n is a whole number, m and k are positive and c is not negative
  explicit SpringChain(const Parameters& parameters = {})
      : parameters_(detail::finite_parameters(parameters, id)),
        n_(detail::count_of(parameters.n, "n", id)),
        m_(static_cast<Real>(parameters.m)),
        k_(static_cast<Real>(parameters.k)),
        c_(static_cast<Real>(parameters.c)),
        k3_(static_cast<Real>(parameters.k3)) {
    detail::require_positive(parameters.m, "m", id);
    detail::require_positive(parameters.k, "k", id);
    if (parameters.c < 0)
      throw std::invalid_argument("parameter c of spring_chain is " + shortest_digits(parameters.c) +
                                  " but a damper cannot push; give c >= 0");
  }

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  [[nodiscard]] Eigen::Index dim() const { return 2 * n_; }
  [[nodiscard]] Linearity linearity() const { return k3_ == 0 ? Linearity::linear : Linearity::nonlinear; }
  [[nodiscard]] std::vector<std::string> states() const {
    std::vector<std::string> names;
    detail::append_numbered(names, "q", n_);
    detail::append_numbered(names, "v", n_);
    return names;
  }
  [[nodiscard]] State y0() const {
    State y = State::Zero(dim());
    y[n_] = Real(1);
    return y;
  }

  void rhs(Real /*t*/, const State& y, State& dydt) const {
    dydt.head(n_) = y.tail(n_);
    pull(y.data(), y.data() + n_, k_, c_, k3_, dydt.data() + n_);
    dydt.tail(n_) /= m_;
  }
  void jacobian(Real /*t*/, const State& y, Jacobian& J) const { packed_jacobian(y, k3_, J); }

  [[nodiscard]] Eigen::Index dofs() const { return n_; }
  [[nodiscard]] Dofs mass() const { return Dofs::Constant(n_, m_); }
  void force(Real /*t*/, const Dofs& q, const Dofs& v, Dofs& f) const {
    pull(q.data(), v.data(), k_, c_, k3_, f.data());
  }
  /// K = -dF/dq, tridiagonal: each spring has the tangent k + 3 k3 s^2.
  void stiffness(Real /*t*/, const Dofs& q, const Dofs& /*v*/, DofMatrix& K) const {
    detail::write_sparse(K, n_, [&](const auto& emit) {
      tridiagonal([&](Eigen::Index i) { return tangent(q.data(), i, k3_); }, Real(1), 0, 0, emit);
    });
  }
  /// C = -dF/dv, tridiagonal.
  void damping(Real /*t*/, const Dofs& /*q*/, const Dofs& /*v*/, DofMatrix& C) const {
    detail::write_sparse(
        C, n_, [&](const auto& emit) { tridiagonal([&](Eigen::Index) { return c_; }, Real(1), 0, 0, emit); });
  }

  static constexpr bool linear_stiff_part = true;
  void rhs_stiff(Real /*t*/, const State& y, State& dydt) const {
    dydt.head(n_) = y.tail(n_);
    pull(y.data(), y.data() + n_, k_, c_, Real(0), dydt.data() + n_);
    dydt.tail(n_) /= m_;
  }
  void jacobian_stiff(Real /*t*/, const State& y, Jacobian& J) const { packed_jacobian(y, Real(0), J); }
  void stiffness_stiff(DofMatrix& K) const {
    detail::write_sparse(
        K, n_, [&](const auto& emit) { tridiagonal([&](Eigen::Index) { return k_; }, Real(1), 0, 0, emit); });
  }
  void damping_stiff(DofMatrix& C) const { damping(Real(0), {}, {}, C); }
  void rhs_nonstiff(Real /*t*/, const State& y, State& dydt) const {
    dydt.head(n_).setZero();
    pull(y.data(), y.data() + n_, Real(0), Real(0), k3_, dydt.data() + n_);
    dydt.tail(n_) /= m_;
  }

  /// For an eigenvector with positions x, |x| = 1: m l^2 + l x*Cx + x*Kx = 0, where 0 <= x*Cx <= 4 c and x*Kx
  /// is at most 4 times the largest tangent. Complex roots have |l|^2 = x*Kx / m, real ones lie within x*Cx /
  /// m while no tangent is negative.
  [[nodiscard]] Real spectral_radius(Real /*t*/, const State& y) const {
    using std::sqrt, std::abs;
    Real lowest = k_, largest(0);
    for (Eigen::Index i = 0; i <= n_; ++i) {
      const Real one = tangent(y.data(), i, k3_);
      lowest = std::min(lowest, one);
      largest = std::max(largest, abs(one));
    }
    const Real damper = Real(4) * c_ / m_, spring = Real(4) * largest / m_;
    if (lowest >= 0) return std::max(damper, sqrt(spring));
    return (damper + sqrt(damper * damper + Real(4) * spring)) / Real(2);
  }

  /// Kinetic and elastic energy [J]; constant along solutions when c = 0.
  [[nodiscard]] Real energy(const State& y) const {
    Real sum = m_ * y.tail(n_).squaredNorm() / Real(2);
    for (Eigen::Index i = 0; i <= n_; ++i) {
      const Real s2 = stretch(y.data(), i) * stretch(y.data(), i);
      sum += s2 * (k_ / Real(2) + k3_ * s2 / Real(4));
    }
    return sum;
  }

  /// The eigenvalues of the Jacobian of the linear chain [1/s], in pairs from the slowest mode to the
  /// fastest.
  [[nodiscard]] std::vector<std::complex<Real>> eigenvalues() const {
    std::vector<std::complex<Real>> all;
    for (Eigen::Index j = 1; j <= n_; ++j) {
      const Real decay = c_ * kappa(j) / (Real(2) * m_), square = k_ * kappa(j) / m_;
      const std::complex<Real> root = std::sqrt(std::complex<Real>(decay * decay - square));
      // The small one of two real roots from the product of both: their sum would cancel.
      const std::complex<Real> far = -decay - root;
      all.push_back(root.imag() == Real(0) ? square / far : -decay + root);
      all.push_back(far);
    }
    return all;
  }

  /// Whether exact() knows the motion.
  [[nodiscard]] bool has_exact() const { return k3_ == Real(0); }

  /// The motion of the linear chain from any start, mode by mode; O(n^2).
  /// @returns NaN when k3 is not zero
  [[nodiscard]] State exact(Real t, const State& start) const {
    if (!has_exact()) return State::Constant(dim(), std::numeric_limits<Real>::quiet_NaN());
    State y = State::Zero(dim());
    State shape(n_);
    for (Eigen::Index j = 1; j <= n_; ++j) {
      using std::sin;
      // Whole turns of the sine are taken away as integers: i j is exact, i j pi is not.
      for (Eigen::Index i = 1; i <= n_; ++i)
        shape[i - 1] = sin(std::numbers::pi_v<Real> * static_cast<Real>(i * j % (2 * (n_ + 1))) /
                           static_cast<Real>(n_ + 1));
      const Real norm = Real(2) / static_cast<Real>(n_ + 1);
      const auto [a, b] = mode(j, t, norm * shape.dot(start.head(n_)), norm * shape.dot(start.tail(n_)));
      y.head(n_) += a * shape;
      y.tail(n_) += b * shape;
    }
    return y;
  }

 private:
  /// s_(i+1), the stretch of spring i = 0 ... n, of which 0 and n hang on the walls.
  [[nodiscard]] Real stretch(const Real* q, Eigen::Index i) const {
    return (i < n_ ? q[i] : Real(0)) - (i > 0 ? q[i - 1] : Real(0));
  }
  [[nodiscard]] Real tangent(const Real* q, Eigen::Index i, Real cubic) const {
    const Real s = stretch(q, i);
    return k_ + Real(3) * cubic * (s * s);
  }

  /// f_i = T_(i+1) - T_i for springs of the given constants.
  void pull(const Real* q, const Real* v, Real linear, Real damper, Real cubic, Real* f) const {
    Real before(0);
    for (Eigen::Index i = 0; i <= n_; ++i) {
      const Real s = stretch(q, i), tension = s * (linear + cubic * (s * s)) + damper * stretch(v, i);
      if (i > 0) f[i - 1] = tension - before;
      before = tension;
    }
  }

  /// Column j of factor * (the matrix in which spring i joins masses i - 1 and i with the constant
  /// spring(i)).
  template <class Spring, class Emit>
  void column_of(Eigen::Index j, const Spring& spring, Real factor, Eigen::Index row0, Eigen::Index column0,
                 const Emit& emit) const {
    if (j > 0) emit(row0 + j - 1, column0 + j, -factor * spring(j));
    emit(row0 + j, column0 + j, factor * (spring(j) + spring(j + 1)));
    if (j + 1 < n_) emit(row0 + j + 1, column0 + j, -factor * spring(j + 1));
  }
  template <class Spring, class Emit>
  void tridiagonal(const Spring& spring, Real factor, Eigen::Index row0, Eigen::Index column0,
                   const Emit& emit) const {
    for (Eigen::Index j = 0; j < n_; ++j) column_of(j, spring, factor, row0, column0, emit);
  }

  /// (0, I; -K / m, -C / m).
  void packed_jacobian(const State& y, Real cubic, Jacobian& J) const {
    detail::write_sparse(J, dim(), [&](const auto& emit) {
      const Real per_mass = Real(-1) / m_;
      tridiagonal([&](Eigen::Index i) { return tangent(y.data(), i, cubic); }, per_mass, n_, 0, emit);
      for (Eigen::Index j = 0; j < n_; ++j) {
        emit(j, n_ + j, Real(1));
        column_of(
            j, [&](Eigen::Index) { return c_; }, per_mass, n_, n_, emit);
      }
    });
  }

  /// 4 sin^2(j pi / (2 (n + 1))).
  [[nodiscard]] Real kappa(Eigen::Index j) const {
    using std::sin;
    const Real s = sin(std::numbers::pi_v<Real> * static_cast<Real>(j) / static_cast<Real>(2 * (n_ + 1)));
    return Real(4) * s * s;
  }

  /// Amplitude and speed at t of mode j that starts with a and b.
  [[nodiscard]] std::pair<Real, Real> mode(Eigen::Index j, Real t, Real a, Real b) const {
    using std::sqrt, std::exp, std::expm1, std::sin, std::cos;
    const Real g = c_ * kappa(j) / (Real(2) * m_), square = k_ * kappa(j) / m_, gap = g * g - square;
    if (gap < 0) {
      const Real w = sqrt(-gap), fade = exp(-g * t), s = sin(w * t), c = cos(w * t);
      return {fade * (a * c + (b + g * a) / w * s), fade * (b * c - (square * a + g * b) / w * s)};
    }
    // Two real roots, slow > fast: a e^(slow t) + (b - slow a) (e^(slow t) - e^(fast t)) / (slow - fast).
    const Real root = sqrt(gap), fast = -(g + root), slow = -square / (g + root);
    const Real spread = Real(2) * root * t;
    const Real integral = spread > 0 ? -expm1(-spread) / (Real(2) * root) : t;
    const Real position = exp(slow * t) * (a + (b - slow * a) * integral);
    return {position, slow * position + (b - slow * a) * exp(fast * t)};
  }

  Parameters parameters_;
  Eigen::Index n_;
  Real m_, k_, c_, k3_;
};

}  // namespace hmax
