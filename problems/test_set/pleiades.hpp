/// Seven stars in the plane.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/test_set/common.hpp"

namespace hmax {

/// Seven bodies of mass m_i = i in the plane that attract one another, everything without unit; several close
/// encounters up to t = 3.
///   m_i p_i'' = sum over j != i of m_i m_j (p_j - p_i) / |p_j - p_i|^3
/// y = (x_1 ... x_7, y_1 ... y_7, x'_1 ... x'_7, y'_1 ... y'_7), shape (28).
/// @source  [hairer1993solving, II.10]; end point of [mazzia2008test]
template <class Real>
class Pleiades {
 public:
  static constexpr Eigen::Index bodies = 7;
  using State = Eigen::Matrix<Real, 4 * bodies, 1>;
  using Jacobian = Eigen::Matrix<Real, 4 * bodies, 4 * bodies>;
  using Dofs = Eigen::Matrix<Real, 2 * bodies, 1>;
  using DofMatrix = Eigen::Matrix<Real, 2 * bodies, 2 * bodies>;
  using Parameters = NoParameters;
  static constexpr std::string_view id = "pleiades", source = "mazzia2008test",
                                    note = "seven stars in the plane with close encounters";
  static constexpr bool autonomous = true, stiff = false;
  static constexpr double t_end = 3;
  /// y(t_end), and its error relative to its largest component.
  static constexpr std::array<long double, 4 * bodies> end_point{
      0.3706139143970502L,  3.237284092057233L,   -3.222559032418324L,  0.6597091455775310L,
      0.3425581707156584L,  1.562172101400631L,   -0.7003092922212495L, -3.943437585517392L,
      -3.271380973972550L,  5.225081843456543L,   -2.590612434977470L,  1.198213693392275L,
      -0.2429682344935824L, 1.091449240428980L,   3.417003806314313L,   1.354584501625501L,
      -2.590065597810775L,  2.025053734714242L,   -1.155815100160448L,  -0.8072988170223021L,
      0.5952396354208710L,  -3.741244961234010L,  0.3773459685750630L,  0.9386858869551073L,
      0.3667922227200571L,  -0.3474046353808490L, 2.344915448180937L,   -1.947020434263292L};
  static constexpr double end_point_error = 2e-15;

  explicit Pleiades(const Parameters& /*none*/ = {}) {}

  [[nodiscard]] static Parameters parameters() noexcept { return {}; }
  static constexpr Eigen::Index dim() { return 4 * bodies; }
  [[nodiscard]] static constexpr Linearity linearity() { return Linearity::nonlinear; }
  [[nodiscard]] static std::vector<std::string> states() {
    std::vector<std::string> names;
    for (const char* stem : {"x", "y", "vx", "vy"}) detail::append_numbered(names, stem, bodies);
    return names;
  }
  [[nodiscard]] static State y0() {
    State y;
    y << 3, 3, -1, -3, 2, -2, 2,  //
        3, -3, 2, 0, 0, -4, 4,    //
        0, 0, 0, 0, 0, Real(1.75), Real(-1.5), 0, 0, 0, Real(-1.25), 1, 0, 0;
    return y;
  }

  void rhs(Real /*t*/, const State& y, State& dydt) const noexcept {
    dydt.template head<2 * bodies>() = y.template tail<2 * bodies>();
    dydt.template tail<2 * bodies>().setZero();
    each_pair(y.data(), [&](Eigen::Index i, Eigen::Index j, Real dx, Real dy, Real square) {
      using std::sqrt;
      const Real weight = Real(1) / (square * sqrt(square));
      const Real on_i = star(j) * weight, on_j = star(i) * weight;
      Real* a = dydt.data() + 2 * bodies;
      a[i] += on_i * dx;
      a[bodies + i] += on_i * dy;
      a[j] -= on_j * dx;
      a[bodies + j] -= on_j * dy;
    });
  }
  void jacobian(Real t, const State& y, Jacobian& J) const noexcept {
    DofMatrix K;
    stiffness(t, y.template head<2 * bodies>(), y.template tail<2 * bodies>(), K);
    J.setZero();
    J.template topRightCorner<2 * bodies, 2 * bodies>().setIdentity();
    J.template bottomLeftCorner<2 * bodies, 2 * bodies>() = mass().cwiseInverse().asDiagonal() * (-K);
  }

  static constexpr Eigen::Index dofs() { return 2 * bodies; }
  /// (1 ... 7, 1 ... 7): each star once for x and once for y.
  [[nodiscard]] static Dofs mass() {
    Dofs m;
    for (Eigen::Index i = 0; i < bodies; ++i) m[i] = m[bodies + i] = star(i);
    return m;
  }
  void force(Real /*t*/, const Dofs& q, const Dofs& /*v*/, Dofs& f) const noexcept {
    f.setZero();
    each_pair(q.data(), [&](Eigen::Index i, Eigen::Index j, Real dx, Real dy, Real square) {
      using std::sqrt;
      const Real pull = star(i) * star(j) / (square * sqrt(square));
      f[i] += pull * dx;
      f[bodies + i] += pull * dy;
      f[j] -= pull * dx;
      f[bodies + j] -= pull * dy;
    });
  }
  /// K = -dF/dq, symmetric. A pair with d = p_j - p_i adds B = m_i m_j (I / r^3 - 3 d d^T / r^5) to its two
  /// diagonal blocks and takes it from the two others.
  void stiffness(Real /*t*/, const Dofs& q, const Dofs& /*v*/, DofMatrix& K) const noexcept {
    K.setZero();
    each_pair(q.data(), [&](Eigen::Index i, Eigen::Index j, Real dx, Real dy, Real square) {
      using std::sqrt;
      const Real pull = star(i) * star(j) / (square * sqrt(square)), three = Real(3) / square;
      const Real xx = pull * (Real(1) - three * dx * dx), yy = pull * (Real(1) - three * dy * dy),
                 xy = -pull * three * dx * dy;
      auto add = [&](Eigen::Index row, Eigen::Index column, Real sign) {
        K(row, column) += sign * xx;
        K(row, bodies + column) += sign * xy;
        K(bodies + row, column) += sign * xy;
        K(bodies + row, bodies + column) += sign * yy;
      };
      add(i, i, Real(1));
      add(j, j, Real(1));
      add(i, j, Real(-1));
      add(j, i, Real(-1));
    });
  }
  void damping(Real /*t*/, const Dofs& /*q*/, const Dofs& /*v*/, DofMatrix& C) const noexcept { C.setZero(); }

  /// Kinetic energy minus m_i m_j / r of every pair, constant along solutions.
  [[nodiscard]] static Real energy(const State& y) {
    Real sum = mass().dot(y.template tail<2 * bodies>().cwiseAbs2()) / Real(2);
    each_pair(y.data(), [&](Eigen::Index i, Eigen::Index j, Real, Real, Real square) {
      using std::sqrt;
      sum -= star(i) * star(j) / sqrt(square);
    });
    return sum;
  }
  /// Sum of m (x y' - y x'), constant along solutions.
  [[nodiscard]] static Real angular_momentum(const State& y) {
    Real sum(0);
    for (Eigen::Index i = 0; i < bodies; ++i)
      sum += star(i) * (y[i] * y[3 * bodies + i] - y[bodies + i] * y[2 * bodies + i]);
    return sum;
  }

 private:
  static constexpr Real star(Eigen::Index i) { return static_cast<Real>(i + 1); }

  /// visit(i, j, x_j - x_i, y_j - y_i, square of the distance) for each pair i < j; q = (x, y).
  template <class Visit>
  static void each_pair(const Real* q, const Visit& visit) {
    for (Eigen::Index i = 0; i < bodies; ++i)
      for (Eigen::Index j = i + 1; j < bodies; ++j) {
        const Real dx = q[j] - q[i], dy = q[bodies + j] - q[bodies + i];
        visit(i, j, dx, dy, dx * dx + dy * dy);
      }
  }
};

}  // namespace hmax
