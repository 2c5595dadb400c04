/// A closed orbit of a satellite around earth and moon.
#pragma once

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/digits.hpp"
#include "problems/test_set/common.hpp"

namespace hmax {

struct ArenstorfParameters {
  double mu = 0.012277471;  ///< mass of the moon over that of both bodies, 0 < mu < 1 [1]
  static constexpr ParameterNames<ArenstorfParameters, 1> names{{{"mu", &ArenstorfParameters::mu}}};
};

/// The restricted three-body problem in the rotating frame, scaled to the distance and the mass of both
/// bodies; earth at (-mu, 0), moon at (1 - mu, 0), y = (q1, q2, v1, v2).
///   q1'' = q1 + 2 v2 - (1 - mu) (q1 + mu) / D1 - mu (q1 - (1 - mu)) / D2
///   q2'' = q2 - 2 v1 - (1 - mu) q2 / D1        - mu q2 / D2
///   D1 = ((q1 + mu)^2 + q2^2)^(3/2),   D2 = ((q1 - (1 - mu))^2 + q2^2)^(3/2)
/// The force depends on velocities, through the antisymmetric damping matrix of the rotating frame: it does
/// no work. With the default mu the start is a closed orbit of period t_end, so y(t_end) = y(0). The start as
/// doubles misses the closed orbit by rounding, which a turn around earth and moon amplifies 1e5 times.
/// @source  [arenstorf1963periodic]; digits of [hairer1993solving, II.0]
template <class Real>
class Arenstorf {
 public:
  using State = Eigen::Matrix<Real, 4, 1>;
  using Jacobian = Eigen::Matrix<Real, 4, 4>;
  using Dofs = Eigen::Matrix<Real, 2, 1>;
  using DofMatrix = Eigen::Matrix<Real, 2, 2>;
  using Parameters = ArenstorfParameters;
  static constexpr std::string_view id = "arenstorf", source = "hairer1993solving",
                                    note =
                                        "a closed orbit around earth and moon, restricted three-body problem";
  static constexpr bool autonomous = true, stiff = false;
  static constexpr double t_end = 17.0652165601579625588917206249;
  /// y(t_end) for the default parameters, and its error relative to its largest component.
  static constexpr std::array<long double, 4> end_point{0.994L, 0, 0, -2.00158510637908252240537862224L};
  static constexpr double end_point_error = 1e-11;

  /// @throws std::invalid_argument  unless 0 < mu < 1
  explicit Arenstorf(const Parameters& parameters = {})
      : parameters_(detail::finite_parameters(parameters, id)),
        moon_(static_cast<Real>(parameters.mu)),
        earth_(Real(1) - moon_) {
    if (!(parameters.mu > 0 && parameters.mu < 1))
      throw std::invalid_argument("parameter mu of arenstorf is " + shortest_digits(parameters.mu) +
                                  " but the smaller body's share of the mass lies between 0 and 1");
  }

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  static constexpr Eigen::Index dim() { return 4; }
  [[nodiscard]] static constexpr Linearity linearity() { return Linearity::nonlinear; }
  [[nodiscard]] static std::vector<std::string> states() { return {"q1", "q2", "v1", "v2"}; }
  [[nodiscard]] static State y0() {
    return Eigen::Vector4d(0.994, 0, 0, -2.00158510637908252240537862224).template cast<Real>();
  }

  void rhs(Real /*t*/, const State& y, State& dydt) const noexcept {
    const Real x = y[0], z = y[1], u = y[2], w = y[3];
    const Real to_earth = earth_ * detail::inverse_cube(x + moon_, z),
               to_moon = moon_ * detail::inverse_cube(x - earth_, z);
    dydt[0] = u;
    dydt[1] = w;
    dydt[2] = x + Real(2) * w - to_earth * (x + moon_) - to_moon * (x - earth_);
    dydt[3] = z - Real(2) * u - (to_earth + to_moon) * z;
  }
  void jacobian(Real t, const State& y, Jacobian& J) const noexcept {
    DofMatrix K, C;
    stiffness(t, y.template head<2>(), y.template tail<2>(), K);
    damping(t, y.template head<2>(), y.template tail<2>(), C);
    J.template topRows<2>() << DofMatrix::Zero(), DofMatrix::Identity();
    J.template bottomRows<2>() << -K, -C;
  }

  static constexpr Eigen::Index dofs() { return 2; }
  [[nodiscard]] static Dofs mass() { return Dofs::Ones(); }
  void force(Real t, const Dofs& q, const Dofs& v, Dofs& f) const noexcept {
    State y, dydt;
    y << q, v;
    rhs(t, y, dydt);
    f = dydt.template tail<2>();
  }
  /// K = -dF/dq: each body adds m (I / r^3 - 3 d d^T / r^5) with d the way from it, the rotation takes I
  /// away.
  void stiffness(Real /*t*/, const Dofs& q, const Dofs& /*v*/, DofMatrix& K) const noexcept {
    K = -DofMatrix::Identity();
    for (const auto& [body, x] : {std::pair{earth_, -moon_}, std::pair{moon_, earth_}}) {
      const Dofs d(q[0] - x, q[1]);
      K += body * detail::inverse_cube(d[0], d[1]) *
           (DofMatrix::Identity() - Real(3) / d.squaredNorm() * (d * d.transpose()));
    }
  }
  /// C = -dF/dv: the Coriolis force (2 v2, -2 v1).
  void damping(Real /*t*/, const Dofs& /*q*/, const Dofs& /*v*/, DofMatrix& C) const noexcept {
    C << Real(0), Real(-2), Real(2), Real(0);
  }

  /// The Jacobi constant |q|^2 + 2 (1 - mu) / r1 + 2 mu / r2 - |v|^2, constant along solutions.
  [[nodiscard]] Real jacobi_constant(const State& y) const {
    using std::hypot;
    return y.template head<2>().squaredNorm() + Real(2) * earth_ / hypot(y[0] + moon_, y[1]) +
           Real(2) * moon_ / hypot(y[0] - earth_, y[1]) - y.template tail<2>().squaredNorm();
  }

 private:
  Parameters parameters_;
  Real moon_, earth_;
};

}  // namespace hmax
