/// Derivatives of f as methods ask for them: the system's own where it has them, differences where not.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "integrators/linear_solver.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// When a method takes a new Jacobian.
struct JacobianUpdate {
  static constexpr int automatic = -1, frozen = 0;
  /// automatic: the method's own rule; frozen: that of the start, for the whole run; K >= 1: at the start of
  /// every K-th step, so that 1 is the exact one.
  int every = automatic;

  bool operator==(const JacobianUpdate&) const = default;
};

namespace detail {
/// The increment of a forward difference of a quantity of size |y|.
template <class Real>
Real difference_increment(Real y, Real scale) {
  using std::abs, std::sqrt;
  const Real delta = sqrt(std::numeric_limits<Real>::epsilon()) * std::max(abs(y), scale);
  // What is added is the difference of two machine numbers: t + delta - t is exact then.
  volatile Real moved = y + delta;
  return moved - y;
}
}  // namespace detail

/// df/dy of a system, from its verb `jacobian` or by forward differences, column by column.
/// @tparam Matrix  jacobian_type of the system
template <class State, class Matrix>
class JacobianSource {
 public:
  using Real = real_of<State>;

  template <System Sys>
  void init(const Sys& system) {
    if (has_jacobian(system)) return;
    f0_.resize(system.dim());
    f1_.resize(system.dim());
    moved_.resize(system.dim());
  }

  /// J = df/dy at (t, y), shape (n, n). Differences cost n + 1 evaluations of f.
  template <System Sys>
  void evaluate(const Sys& system, Real t, const State& y, Matrix& J) {
    if constexpr (DifferentiableSystem<Sys>)
      if (has_jacobian(system)) return system.jacobian(t, y, J);
    differences(system, t, y, J);
  }

 private:
  template <System Sys>
  void differences(const Sys& system, Real t, const State& y, Matrix& J) {
    using Dense = jacobian_of<State>;
    Dense& out = [&]() -> Dense& {
      if constexpr (detail::is_variant<Matrix>)
        return detail::alternative<Dense>(J);
      else
        return J;
    }();
    const Eigen::Index n = system.dim();
    out.resize(n, n);
    system.rhs(t, y, f0_);
    // Components far below the others are moved by what the others would be.
    const Real scale = std::max(Real(1e-5) * y.cwiseAbs().maxCoeff(), Real(1e-8));
    moved_ = y;
    for (Eigen::Index j = 0; j < n; ++j) {
      const Real delta = detail::difference_increment<Real>(y[j], scale);
      moved_[j] = y[j] + delta;
      system.rhs(t, moved_, f1_);
      out.col(j) = (f1_ - f0_) / delta;
      moved_[j] = y[j];
    }
  }

  State f0_, f1_, moved_;
};

/// dfdt = partial f / partial t at (t, y), shape (n): the system's own, zero for autonomous systems, or a
/// forward difference, which costs one evaluation of f.
/// @param f0  f(t, y)
template <System Sys>
void evaluate_time_derivative(const Sys& system, real_of<typename Sys::State> t, const typename Sys::State& y,
                              const typename Sys::State& f0, typename Sys::State& dfdt) {
  using Real = real_of<typename Sys::State>;
  if (is_autonomous(system)) {
    dfdt.setZero(y.size());
    return;
  }
  if constexpr (TimeDifferentiableSystem<Sys>)
    if (has_time_derivative(system)) return system.time_derivative(t, y, dfdt);
  const Real delta = detail::difference_increment<Real>(t, Real(1e-3));
  system.rhs(t + delta, y, dfdt);
  dfdt = (dfdt - f0) / delta;
}

}  // namespace hmax
