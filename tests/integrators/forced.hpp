/// Problems that start at rest and are set in motion by a force, with their solutions in closed form.
#pragma once

#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace hmax::forced {

/// g(s) of x' = g(s) - x, x(0) = 0, s in [0, 10], and x(10).
struct Forcing {
  std::string_view name;
  double (*g)(double s);
  double end;
};

inline constexpr double pulse_width = 0.5, pulse_at = 5;

/// Begin and end at zero, come late, or grow from nothing.
inline std::vector<Forcing> forcings() {
  using std::numbers::pi;
  const double e = std::exp(-10.0), w = pulse_width, square = 1 + 4 * pi * pi;
  return {
      // (sin 2 pi s - 2 pi cos 2 pi s + 2 pi exp(-s)) / (1 + 4 pi^2)
      {"ten_sines", [](double s) { return std::sin(2 * pi * s); }, (-2 * pi + 2 * pi * e) / square},
      // The same of half a sine: w = pi / 10.
      {"half_a_sine", [](double s) { return std::sin(pi * s / 10); },
       (pi / 10) * (1 + e) / (1 + pi * pi / 100)},
      {"square", [](double s) { return s * s / 100; }, (100 - 20 + 2 - 2 * e) / 100},
      {"cube", [](double s) { return s * s * s / 1000; }, (1000 - 300 + 60 - 6 + 6 * e) / 1000},
      {"fifth_power", [](double s) { return std::pow(s / 10, 5); },
       (1e5 - 5e4 + 2e4 - 6e3 + 1200 - 120 + 120 * e) / 1e5},
      // exp(-((s - 5) / w)^2): the exponents of both factors make a square.
      {"pulse", [](double s) { return std::exp(-std::pow((s - pulse_at) / pulse_width, 2)); },
       w * std::sqrt(pi) / 2 * std::exp(pulse_at + w * w / 4 - 10) *
           (std::erf((10 - pulse_at) / w - w / 2) - std::erf(-pulse_at / w - w / 2))},
  };
}

/// y' = (g(t / T) - y) / T in a unit of time T, all of it declared stiff.
struct Forced {
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  double (*g)(double s);
  double unit = 1;  ///< T

  [[nodiscard]] static Eigen::Index dim() { return 1; }
  void rhs(double t, const State& y, State& dydt) const { dydt[0] = (g(t / unit) - y[0]) / unit; }
  void jacobian(double, const State&, Jacobian& J) const { J.setConstant(1, 1, -1 / unit); }
  void rhs_stiff(double t, const State& y, State& dydt) const { rhs(t, y, dydt); }
  void rhs_nonstiff(double, const State&, State& dydt) const { dydt[0] = 0; }
  void jacobian_stiff(double t, const State& y, Jacobian& J) const { jacobian(t, y, J); }
};

/// g jumps at s = 3 and s = 7 from 0 to `height` and back, with 0 or `height` at the jumps themselves.
struct Switched {
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  double height = 1;
  bool at_once = true;  ///< g(3) = height
  bool knows = true;    ///< its breakpoints

  [[nodiscard]] static Eigen::Index dim() { return 1; }
  [[nodiscard]] double g(double t) const {
    return (at_once ? t >= 3 && t < 7 : t > 3 && t <= 7) ? height : 0;
  }
  void rhs(double t, const State& y, State& dydt) const { dydt[0] = g(t) - y[0]; }
  void jacobian(double, const State&, Jacobian& J) const { J.setConstant(1, 1, -1); }
  void rhs_stiff(double t, const State& y, State& dydt) const { rhs(t, y, dydt); }
  void rhs_nonstiff(double, const State&, State& dydt) const { dydt[0] = 0; }
  void jacobian_stiff(double t, const State& y, Jacobian& J) const { jacobian(t, y, J); }
  [[nodiscard]] std::vector<double> breakpoints(double t0, double t1) const {
    std::vector<double> inside;
    for (const double t : {3.0, 7.0})
      if (knows && t > t0 && t < t1) inside.push_back(t);
    return inside;
  }
  /// y(10) from y(0) = 0.
  [[nodiscard]] double end() const { return height * (1 - std::exp(-4.0)) * std::exp(-3.0); }
};

}  // namespace hmax::forced
