/// Formulas from their own start on, forwards or backwards in time.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "problems/formula_system.hpp"

namespace hmax {

/// The system of formulas in the time s = direction (t - t0), which begins at 0 and grows: dy/ds = direction
/// f(t, y). Backwards it has no positions and velocities, since dq/ds = -v.
/// @tparam Matrix  of derivatives: Eigen::MatrixXd, or FormulaSystem::SparseMatrix where the system
/// is_sparse()
/// @tparam rounded  as a system of long double, in which they are not computed: what they give is no
/// reference, and so they offer no Jacobian for one
template <class Matrix, bool rounded = false>
class FormulaMotion {
 public:
  using State = FormulaSystem::State;
  using Jacobian = Matrix;
  using Dofs = FormulaSystem::Dofs;
  using DofMatrix = Matrix;

  /// @param direction  1, or -1 for a motion that ends before t0
  FormulaMotion(FormulaSystem system, double t0, double direction)
      : system_(std::move(system)), t0_(t0), direction_(direction) {}

  Eigen::Index dim() const { return system_.dim(); }
  void rhs(double s, const State& y, State& dyds) const {
    system_.rhs(time(s), y, dyds);
    if (direction_ < 0) dyds = -dyds;
  }
  void jacobian(double s, const State& y, Jacobian& J) const requires(!rounded) {
    system_.jacobian(time(s), y, J);
    if (direction_ < 0) J *= -1;
  }
  /// d(direction f)/ds = direction^2 df/dt.
  void time_derivative(double s, const State& y, State& dfds) const requires(!rounded) {
    system_.time_derivative(time(s), y, dfds);
  }
  bool is_autonomous() const requires(!rounded) { return system_.is_autonomous(); }
  Linearity linearity() const requires(!rounded) { return system_.linearity(); }
  std::vector<double> breakpoints(double s0, double s1) const requires(!rounded) {
    const double a = time(s0), b = time(s1);
    std::vector<double> times = system_.breakpoints(std::min(a, b), std::max(a, b));
    if (t0_ == 0 && direction_ > 0) return times;
    for (double& t : times) t = direction_ * (t - t0_);
    if (direction_ < 0) std::ranges::reverse(times);
    return times;
  }

  Eigen::Index dofs() const { return direction_ > 0 ? system_.dofs() : 0; }
  Dofs mass() const { return Dofs::Ones(dofs()); }
  void force(double s, const Dofs& q, const Dofs& v, Dofs& f) const { system_.force(time(s), q, v, f); }
  void stiffness(double s, const Dofs& q, const Dofs& v, DofMatrix& K) const {
    system_.stiffness(time(s), q, v, K);
  }
  void damping(double s, const Dofs& q, const Dofs& v, DofMatrix& C) const {
    system_.damping(time(s), q, v, C);
  }

  const FormulaSystem& system() const { return system_; }
  /// Null where s is not the time of the formulas and they have one.
  std::shared_ptr<const FormulaProgram> formulas() const requires(!rounded) {
    return direction_ > 0 && (t0_ == 0 || is_autonomous()) ? system_.formulas() : nullptr;
  }

 private:
  /// 0 + s is s to the last bit.
  double time(double s) const { return t0_ + direction_ * s; }

  FormulaSystem system_;
  double t0_, direction_;
};

}  // namespace hmax
