/// What the tests of structural methods share: a chain of masses and the runs that are asked again and again.
#pragma once

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/integrate.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// n masses 1, 1.1, 1.2, ... on a string of hardening springs and dampers, the first tied to a wall, the last
/// pulled by a periodic force. Spring i has the stretch e_i = q_i - q_(i-1) and the tension
/// k e_i + k3 e_i^3 + c e_i'. Damping and stiffness are tridiagonal.
/// @tparam StateT   real or complex, of any size; shape (2 n)
/// @tparam MatrixT  of K and C: dense or sparse
template <class StateT, class MatrixT = jacobian_of<Eigen::Vector<typename StateT::Scalar, Eigen::Dynamic>>>
struct Chain {
  using State = StateT;
  using Scalar = typename State::Scalar;
  using Real = real_of<State>;
  static constexpr int rows = State::RowsAtCompileTime;
  using Dofs = Eigen::Vector<Scalar, rows == Eigen::Dynamic ? Eigen::Dynamic : rows / 2>;
  using DofMatrix = MatrixT;

  Eigen::Index n;
  Real k = 5, k3 = 2, c = 0, pull = 0;

  [[nodiscard]] bool is_linear() const { return k3 == 0; }
  [[nodiscard]] Eigen::Index dim() const { return 2 * n; }
  [[nodiscard]] Eigen::Index dofs() const { return n; }
  [[nodiscard]] Dofs mass() const {
    Dofs m(n);
    for (Eigen::Index i = 0; i < n; ++i) m[i] = Real(1) + static_cast<Real>(i) / 10;
    return m;
  }
  void force(Real t, const Dofs& q, const Dofs& v, Dofs& f) const {
    for (Eigen::Index i = 0; i < n; ++i) f[i] = tension(q, v, i + 1) - tension(q, v, i);
    f[n - 1] += pull * std::cos(3 * t);
  }
  void rhs(Real t, const State& y, State& dydt) const {
    for (Eigen::Index i = 0; i < n; ++i) {
      dydt[i] = y[n + i];
      dydt[n + i] = (tension(y.head(n), y.tail(n), i + 1) - tension(y.head(n), y.tail(n), i)) /
                    (Real(1) + static_cast<Real>(i) / 10);
    }
    dydt[2 * n - 1] += pull * std::cos(3 * t) / (Real(1) + static_cast<Real>(n - 1) / 10);
  }
  void stiffness(Real, const Dofs& q, const Dofs&, DofMatrix& K) const {
    fill(K, [&](Eigen::Index i) {
      const Scalar e = stretch(q, i);
      return k + 3 * k3 * e * e;
    });
  }
  void damping(Real, const Dofs&, const Dofs&, DofMatrix& C) const {
    fill(C, [&](Eigen::Index) { return Scalar(c); });
  }
  /// Kinetic and elastic energy.
  [[nodiscard]] Scalar energy(const State& y) const {
    Scalar sum{0};
    const Dofs m = mass(), q = y.head(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Scalar e = stretch(q, i), e2 = e * e;
      sum += (m[i] * y[n + i] * y[n + i] + k * e2 + k3 * e2 * e2 / Real(2)) / Real(2);
    }
    return sum;
  }

 private:
  template <class Vector>
  static Scalar stretch(const Vector& q, Eigen::Index i) {
    return i == 0 ? q[0] : q[i] - q[i - 1];
  }
  template <class Q, class V>
  Scalar tension(const Q& q, const V& v, Eigen::Index i) const {
    if (i == n) return Scalar(0);
    const Scalar e = stretch(q, i);
    return k * e + k3 * (e * e * e) + c * stretch(v, i);
  }
  template <class Of>
  void fill(DofMatrix& matrix, const Of& of) const {
    std::vector<Eigen::Triplet<Scalar>> entries;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto row = static_cast<int>(i);
      entries.emplace_back(row, row, of(i));
      if (i == 0) continue;
      entries.emplace_back(row - 1, row - 1, of(i));
      entries.emplace_back(row, row - 1, -of(i));
      entries.emplace_back(row - 1, row, -of(i));
    }
    matrix.resize(n, n);
    if constexpr (std::is_base_of_v<Eigen::SparseMatrixBase<DofMatrix>, DofMatrix>) {
      matrix.setFromTriplets(entries.begin(), entries.end());
    } else {
      matrix.setZero();
      for (const auto& entry : entries) matrix(entry.row(), entry.col()) += entry.value();
    }
  }
};

/// The state after `steps` steps of size h from t = 0.
template <class StepperT, class Sys>
typename Sys::State after_steps(const StepperT& stepper, const Sys& system, typename Sys::State y,
                                real_of<typename Sys::State> h, int steps) {
  using Real = real_of<typename Sys::State>;
  const auto end =
      integrate(stepper, system, Span<Real>{0, static_cast<Real>(steps) * h}, y, FixedStep<Real>(h));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  EXPECT_EQ(end.stats.steps, steps);
  return y;
}

/// The order that halving the step from h shows at time t_end.
template <class StepperT, class Sys>
double order_by_halving(const StepperT& stepper, const Sys& system, const typename Sys::State& y0,
                        const typename Sys::State& exact, double t_end, int steps) {
  using Real = real_of<typename Sys::State>;
  const auto error = [&](int n) {
    return (after_steps(stepper, system, y0, static_cast<Real>(t_end) / static_cast<Real>(n), n) - exact)
        .norm();
  };
  return static_cast<double>(std::log2(error(steps) / error(2 * steps)));
}

}  // namespace hmax
