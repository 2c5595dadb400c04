/// The two-body problem, with its exact solution.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/digits.hpp"
#include "problems/test_set/common.hpp"

namespace hmax {

struct KeplerParameters {
  double e = 0.6;  ///< eccentricity of the orbit that y0() starts, 0 <= e < 1 [1]
  static constexpr ParameterNames<KeplerParameters, 1> names{{{"e", &KeplerParameters::e}}};
};

/// A light body around a fixed one, lengths and times scaled so that the semi-major axis of y0() is 1 and its
/// period 2 pi: q'' = -q / |q|^3 in the plane, y = (q1, q2, v1, v2).
///   y(0) = (1 - e, 0, 0, sqrt((1 + e) / (1 - e)))
/// @source  [hairer2006geometric, I.2]; exact solution by Lagrange's coefficients and Kepler's equation in
///          the difference of eccentric anomalies [battin1999introduction, 4.3]
template <class Real>
class Kepler {
 public:
  using State = Eigen::Matrix<Real, 4, 1>;
  using Jacobian = Eigen::Matrix<Real, 4, 4>;
  using Dofs = Eigen::Matrix<Real, 2, 1>;
  using DofMatrix = Eigen::Matrix<Real, 2, 2>;
  using Parameters = KeplerParameters;
  static constexpr std::string_view id = "kepler", source = "hairer2006geometric",
                                    note = "the two-body problem on an ellipse of eccentricity e";
  static constexpr bool autonomous = true, stiff = false;
  static constexpr double t_end = 20;

  /// @throws std::invalid_argument  unless 0 <= e < 1
  explicit Kepler(const Parameters& parameters = {})
      : parameters_(detail::finite_parameters(parameters, id)) {
    if (!(parameters.e >= 0 && parameters.e < 1))
      throw std::invalid_argument("parameter e of kepler is " + shortest_digits(parameters.e) +
                                  " but the eccentricity of an ellipse lies in [0, 1)");
  }

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  static constexpr Eigen::Index dim() { return 4; }
  [[nodiscard]] static constexpr Linearity linearity() { return Linearity::nonlinear; }
  [[nodiscard]] static std::vector<std::string> states() { return {"q1", "q2", "v1", "v2"}; }
  [[nodiscard]] State y0() const {
    const double e = parameters_.e;
    return Eigen::Vector4d(1 - e, 0, 0, std::sqrt((1 + e) / (1 - e))).template cast<Real>();
  }

  void rhs(Real /*t*/, const State& y, State& dydt) const noexcept {
    const Real weight = detail::inverse_cube(y[0], y[1]);
    dydt[0] = y[2];
    dydt[1] = y[3];
    dydt[2] = -y[0] * weight;
    dydt[3] = -y[1] * weight;
  }
  void jacobian(Real t, const State& y, Jacobian& J) const noexcept {
    DofMatrix K;
    stiffness(t, y.template head<2>(), y.template tail<2>(), K);
    J.template topRows<2>() << DofMatrix::Zero(), DofMatrix::Identity();
    J.template bottomRows<2>() << -K, DofMatrix::Zero();
  }

  static constexpr Eigen::Index dofs() { return 2; }
  [[nodiscard]] static Dofs mass() { return Dofs::Ones(); }
  void force(Real /*t*/, const Dofs& q, const Dofs& /*v*/, Dofs& f) const noexcept {
    f = -detail::inverse_cube(q[0], q[1]) * q;
  }
  /// K = -dF/dq = I / r^3 - 3 q q^T / r^5.
  void stiffness(Real /*t*/, const Dofs& q, const Dofs& /*v*/, DofMatrix& K) const noexcept {
    const Real weight = detail::inverse_cube(q[0], q[1]);
    K = weight * (DofMatrix::Identity() - Real(3) / q.squaredNorm() * (q * q.transpose()));
  }
  void damping(Real /*t*/, const Dofs& /*q*/, const Dofs& /*v*/, DofMatrix& C) const noexcept { C.setZero(); }

  /// |v|^2 / 2 - 1 / |q|, constant along solutions.
  [[nodiscard]] static Real energy(const State& y) {
    return y.template tail<2>().squaredNorm() / Real(2) - Real(1) / y.template head<2>().norm();
  }
  /// q1 v2 - q2 v1, constant along solutions.
  [[nodiscard]] static Real angular_momentum(const State& y) { return y[0] * y[3] - y[1] * y[2]; }

  /// The motion from any start on an ellipse. With D the eccentric anomaly gained since t = 0, a the
  /// semi-major axis, r0 = |q0|, s = q0 . v0:
  ///   t / sqrt(a^3) = D - (1 - r0 / a) sin D + s / sqrt(a) (1 - cos D)
  ///   q = (1 - a / r0 (1 - cos D)) q0 + (t - sqrt(a^3) (D - sin D)) v0
  /// @returns NaN for a start that is not on an ellipse (energy not negative, or no angular momentum)
  [[nodiscard]] State exact(Real t, const State& start) const {
    using std::cos, std::sin, std::sqrt, std::floor, std::abs;
    const Dofs q0 = start.template head<2>(), v0 = start.template tail<2>();
    const Real r0 = q0.norm(), a = Real(-1) / (Real(2) * energy(start)), s = q0.dot(v0);
    if (!(a > 0) || angular_momentum(start) == Real(0))
      return State::Constant(std::numeric_limits<Real>::quiet_NaN());
    // Whole periods change nothing and are taken away before the angle is formed.
    const Real unit = a * sqrt(a), turn = Real(2) * std::numbers::pi_v<Real>;
    const Real anomaly = t / unit - turn * floor(t / (unit * turn));
    const Real rest = anomaly * unit;
    const Real p = Real(1) - r0 / a, w = s / sqrt(a);
    auto mean = [&](Real D) { return D - p * sin(D) + w * (Real(1) - cos(D)); };
    // mean() grows with D, by r / a > 0: Newton's steps, kept in an interval that holds the root.
    const Real e = std::hypot(p, w);
    Real low = anomaly - Real(2) * e - Real(1), high = anomaly + Real(2) * e + Real(1), D = anomaly;
    for (int i = 0; i < 200; ++i) {
      const Real gap = mean(D) - anomaly;
      if (gap == Real(0)) break;
      (gap > 0 ? high : low) = D;
      Real next = D - gap / (Real(1) - p * cos(D) + w * sin(D));
      if (!(next > low && next < high)) next = (low + high) / Real(2);
      const Real moved = abs(next - D);
      D = next;
      if (moved <= std::numeric_limits<Real>::epsilon() * (Real(1) + abs(D))) break;
    }
    const Real half = sin(D / Real(2)), versine = Real(2) * half * half;  // 1 - cos D without cancellation
    const Real r = a + (r0 - a) * cos(D) + s * sqrt(a) * sin(D);
    State y;
    y << (Real(1) - a / r0 * versine) * q0 + (rest - unit * (D - sin(D))) * v0,
        (-sqrt(a) / (r * r0) * sin(D)) * q0 + (Real(1) - a / r * versine) * v0;
    return y;
  }

 private:
  Parameters parameters_;
};

}  // namespace hmax
