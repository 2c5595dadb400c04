/// Small systems that the tests of the foreign engines share.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <variant>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <gtest/gtest.h>

#include "integrators/observers.hpp"

namespace hmax::peers {

/// x'' = -x as a first-order system: y(t) = (cos t, -sin t) from (1, 0).
struct Circle {
  using State = Eigen::Vector2d;
  using Jacobian = Eigen::Matrix2d;
  static constexpr bool autonomous = true;
  static constexpr Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& dydt) const { dydt = State(y[1], -y[0]); }
  void jacobian(double, const State&, Jacobian& J) const { J << 0, 1, -1, 0; }
  static State exact(double t) { return {std::cos(t), -std::sin(t)}; }
};

/// The largest error of points inside the steps of a run of the circle to t = 10.
/// @param run  called with the state at the start and an observer
template <class Run>
double worst_inside_steps(const Run& run) {
  Eigen::Vector2d y(1, 0);
  double worst = 0;
  int samples = 0;
  SampleEvery sample(Span<double>{0, 10}, 0.01, y, [&](double t, const Eigen::Vector2d& at) {
    worst = std::max(worst, (at - Circle::exact(t)).norm());
    ++samples;
  });
  run(y, sample);
  EXPECT_EQ(samples, 1001);
  return worst;
}

/// y' = -1000 (y - cos t) - sin t, y(t) = cos t from 1: stiff, and it depends on time. `wrong` replaces the
/// Jacobian by one of the other sign.
struct Stiff {
  using State = Eigen::VectorXd;
  using Jacobian = Eigen::MatrixXd;
  static Eigen::Index dim() { return 1; }
  void rhs(double t, const State& y, State& dydt) const {
    dydt[0] = -1000 * (y[0] - std::cos(t)) - std::sin(t);
  }
  void jacobian(double, const State&, Jacobian& J) const {
    J.resize(1, 1);
    J(0, 0) = wrong ? 1e7 : -1000;
  }
  bool wrong = false;
};

/// y' = 1 up to t = 1 and no number after it.
struct Cliff {
  using State = Eigen::VectorXd;
  static Eigen::Index dim() { return 1; }
  void rhs(double t, const State&, State& dydt) const {
    dydt[0] = t > 1 ? std::numeric_limits<double>::quiet_NaN() : 1;
  }
};

/// y' = y^2 from 1: infinite at t = 1.
struct Pole {
  using State = Eigen::VectorXd;
  static Eigen::Index dim() { return 1; }
  void rhs(double, const State& y, State& dydt) const { dydt[0] = y[0] * y[0]; }
};

/// A right-hand side that cannot be evaluated.
struct Throwing {
  using State = Eigen::VectorXd;
  static Eigen::Index dim() { return 1; }
  void rhs(double t, const State&, State& dydt) const {
    if (t > 0.5) throw std::domain_error("beyond the data");
    dydt[0] = 1;
  }
};

/// Heat along a rod of n cells between cold ends, y' = (n + 1)^2 (y_{i-1} - 2 y_i + y_{i+1}); its Jacobian is
/// sparse, or the same numbers as a dense matrix.
struct Rod {
  using State = Eigen::VectorXd;
  using Jacobian = std::variant<Eigen::MatrixXd, Eigen::SparseMatrix<double>>;
  Eigen::Index n = 30;
  bool sparse = true;
  static constexpr bool autonomous = true;
  [[nodiscard]] Eigen::Index dim() const { return n; }
  [[nodiscard]] double stiffness() const { return static_cast<double>((n + 1) * (n + 1)); }
  void rhs(double, const State& y, State& dydt) const {
    for (Eigen::Index i = 0; i < n; ++i)
      dydt[i] = stiffness() * ((i > 0 ? y[i - 1] : 0) - 2 * y[i] + (i + 1 < n ? y[i + 1] : 0));
  }
  void jacobian(double, const State&, Jacobian& J) const {
    Eigen::SparseMatrix<double> matrix(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = std::max<Eigen::Index>(0, i - 1); j < std::min(n, i + 2); ++j)
        matrix.insert(i, j) = stiffness() * (i == j ? -2 : 1);
    matrix.makeCompressed();
    if (sparse)
      J = matrix;
    else
      J = Eigen::MatrixXd(matrix);
  }
  /// The slowest mode, which decays as exp(-rate() t).
  [[nodiscard]] State mode() const {
    State y(n);
    for (Eigen::Index i = 0; i < n; ++i)
      y[i] = std::sin(M_PI * static_cast<double>(i + 1) / static_cast<double>(n + 1));
    return y;
  }
  [[nodiscard]] double rate() const {
    const double s = std::sin(M_PI / (2.0 * static_cast<double>(n + 1)));
    return 4 * stiffness() * s * s;
  }
};

}  // namespace hmax::peers
