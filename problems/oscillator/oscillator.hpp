/// The lumped soft-tissue model of the house: one mass on a damped, possibly cubic, possibly driven spring.
///   m x'' + c x' + k1 x + k3 x^3 = P cos(w t)
/// The linear, cubic and forced liver models are members of this one family of six parameters.
#pragma once

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <Eigen/Core>

#include "problems/digits.hpp"

namespace hmax {

/// The six parameters; the defaults are the forced liver model of average mass.
struct OscillatorParameters {
  double m = 1.45;  ///< mass [kg], m > 0
  double c = 2.0;   ///< damping [N s/m]; negative means self-exciting
  double k1 = 0.7;  ///< linear stiffness [N/m]
  double k3 = 0.8;  ///< cubic stiffness [N/m^3]
  double P = 0.5;   ///< amplitude of the force [N]
  double w = 0.5;   ///< angular frequency of the force [rad/s]

  bool operator==(const OscillatorParameters&) const = default;
};

/// The parameters by name, for whoever sets or prints them: `p.*member` reads and writes the value.
inline constexpr std::array<std::pair<std::string_view, double OscillatorParameters::*>, 6>
    oscillator_parameter_names{{{"m", &OscillatorParameters::m},
                                {"c", &OscillatorParameters::c},
                                {"k1", &OscillatorParameters::k1},
                                {"k3", &OscillatorParameters::k3},
                                {"P", &OscillatorParameters::P},
                                {"w", &OscillatorParameters::w}}};

/// The model as a first-order system in y = (x, v), displacement [m] and velocity [m/s].
///   x' = v,   v' = (P cos(w t) - c v - k1 x - k3 x^3) / m
/// Real is the type the model computes in. The parameters are doubles in every precision: 0.7 means the
/// double next to 0.7 also in long double, so that all precisions solve the same problem.
template <class Real>
class BasicOscillator {
 public:
  using State = Eigen::Matrix<Real, 2, 1>;
  using Jacobian = Eigen::Matrix<Real, 2, 2>;
  using Dofs = Eigen::Matrix<Real, 1, 1>;
  using DofMatrix = Eigen::Matrix<Real, 1, 1>;

  /// @throws std::invalid_argument  when m is not positive, a parameter is not finite, or a parameter divided
  /// by m
  ///                                overflows Real
  explicit BasicOscillator(const OscillatorParameters& parameters = {})
      : parameters_(checked(parameters)),
        c_m_(per_mass(parameters.c)),
        k1_m_(per_mass(parameters.k1)),
        k3_m_(per_mass(parameters.k3)),
        P_m_(per_mass(parameters.P)),
        w_(static_cast<Real>(parameters.w)),
        forced_(P_m_ != Real(0)) {}

  static constexpr Eigen::Index dim() { return 2; }
  [[nodiscard]] bool is_linear() const noexcept { return k3_m_ == Real(0); }

  const OscillatorParameters& parameters() const noexcept { return parameters_; }

  /// The force per mass, P cos(w t) / m: all of the model that depends on time (concept TimeSplitSystem).
  [[gnu::always_inline]] Real at(Real t) const noexcept {
    using std::cos;
    return forced_ ? P_m_ * cos(w_ * t) : Real(0);
  }

  /// Writes y' into dydt for a given force per mass. The velocity, the newest number in a Runge-Kutta stage,
  /// enters last. The components are written one by one: a vector store followed by scalar loads would stall
  /// on store forwarding.
  [[gnu::always_inline]] void rhs_at(Real force, const State& y, State& dydt) const noexcept {
    const Real x = y[0];
    const Real v = y[1];
    dydt[0] = v;
    dydt[1] = (force - x * (k1_m_ + k3_m_ * (x * x))) - c_m_ * v;
  }

  /// Writes y' = f(t, y) into dydt.
  [[gnu::always_inline]] void rhs(Real t, const State& y, State& dydt) const noexcept {
    rhs_at(at(t), y, dydt);
  }

  /// J = df/dy: the tangent stiffness is k1 + 3 k3 x^2.
  [[gnu::always_inline]] void jacobian(Real /*t*/, const State& y, Jacobian& J) const noexcept {
    J(0, 0) = Real(0);
    J(0, 1) = Real(1);
    J(1, 0) = -(k1_m_ + Real(3) * k3_m_ * (y[0] * y[0]));
    J(1, 1) = -c_m_;
  }

  /// The larger modulus of the eigenvalues of J [1/s], from lambda^2 + c/m lambda + (k1 + 3 k3 x^2)/m = 0.
  Real spectral_radius(Real /*t*/, const State& y) const noexcept {
    using std::abs, std::sqrt;
    const Real stiffness = k1_m_ + Real(3) * k3_m_ * (y[0] * y[0]), half = c_m_ / 2;
    const Real discriminant = half * half - stiffness;
    return discriminant < 0 ? sqrt(stiffness) : abs(half) + sqrt(discriminant);
  }

  /// The partial derivative df/dt = (0, -P w sin(w t) / m) that Rosenbrock methods ask for.
  [[gnu::always_inline]] void time_derivative(Real t, const State& /*y*/, State& dfdt) const noexcept {
    using std::sin;
    dfdt[0] = Real(0);
    dfdt[1] = P_m_ != Real(0) ? -P_m_ * w_ * sin(w_ * t) : Real(0);
  }

  /// The same as a second-order system of one degree of freedom, m x'' = force(t, x, x').
  static constexpr Eigen::Index dofs() { return 1; }
  Dofs mass() const { return Dofs(static_cast<Real>(parameters_.m)); }
  void force(Real t, const Dofs& q, const Dofs& v, Dofs& f) const noexcept {
    const Real x = q[0];
    f[0] = static_cast<Real>(parameters_.m) * ((at(t) - x * (k1_m_ + k3_m_ * (x * x))) - c_m_ * v[0]);
  }
  /// K = -dF/dx = k1 + 3 k3 x^2 [N/m].
  void stiffness(Real /*t*/, const Dofs& q, const Dofs& /*v*/, DofMatrix& K) const noexcept {
    K(0, 0) = static_cast<Real>(parameters_.m) * (k1_m_ + Real(3) * k3_m_ * (q[0] * q[0]));
  }
  /// C = -dF/dv = c [N s/m].
  void damping(Real /*t*/, const Dofs& /*q*/, const Dofs& /*v*/, DofMatrix& C) const noexcept {
    C(0, 0) = static_cast<Real>(parameters_.m) * c_m_;
  }

  static constexpr bool linear_stiff_part = true;
  /// The linear spring and the damper, which IMEX methods treat implicitly: (v, -(k1 x + c v) / m).
  void rhs_stiff(Real /*t*/, const State& y, State& dydt) const noexcept {
    const Real v = y[1];
    dydt[0] = v;
    dydt[1] = -(k1_m_ * y[0] + c_m_ * v);
  }
  /// The cubic spring and the driving force.
  void rhs_nonstiff(Real t, const State& y, State& dydt) const noexcept {
    const Real x = y[0];
    dydt[0] = Real(0);
    dydt[1] = at(t) - k3_m_ * (x * x * x);
  }
  void jacobian_stiff(Real /*t*/, const State& /*y*/, Jacobian& J) const noexcept {
    J << Real(0), Real(1), -k1_m_, -c_m_;
  }

  /// E = m v^2 / 2 + k1 x^2 / 2 + k3 x^4 / 4 [J], constant along solutions when c = 0 and P = 0.
  Real energy(const State& y) const noexcept {
    const Real x2 = y[0] * y[0];
    const Real twice =
        static_cast<Real>(parameters_.m) * (y[1] * y[1]) +
        x2 * (static_cast<Real>(parameters_.k1) + static_cast<Real>(parameters_.k3) * x2 / Real(2));
    return twice / Real(2);
  }

 private:
  static const OscillatorParameters& checked(const OscillatorParameters& p) {
    for (const auto& [name, member] : oscillator_parameter_names)
      if (!std::isfinite(p.*member))
        throw std::invalid_argument("oscillator parameter " + std::string(name) +
                                    " is not a finite number; give it a finite value");
    if (!(p.m > 0))
      throw std::invalid_argument("oscillator parameter m is " + shortest_digits(p.m) +
                                  " but a mass must be positive; give m in kg, for instance 1.45");
    return p;
  }

  Real per_mass(double parameter) const {
    const Real quotient = static_cast<Real>(parameter) / static_cast<Real>(parameters_.m);
    if (!std::isfinite(quotient))
      throw std::invalid_argument(
          "an oscillator parameter divided by the mass m overflows; use a larger m or a smaller parameter");
    return quotient;
  }

  OscillatorParameters parameters_;
  Real c_m_, k1_m_, k3_m_, P_m_, w_;
  bool forced_;  // P_m_ != 0: cheaper to ask in every evaluation than the number itself
};

using Oscillator = BasicOscillator<double>;

}  // namespace hmax
