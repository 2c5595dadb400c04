/// The one stepper of methods that approximate a step of implicit Euler by a fixed number of iterations.
#pragma once

#include <Eigen/Core>

#include "core/process/leaving.hpp"
#include "integrators/hermite.hpp"
#include "integrators/positional/positional_system.hpp"
#include "integrators/stats.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// A step of h is `substeps` steps of h' = h / substeps, each
///   q_new ~ the root of  F(t + h', q_new, (q_new - q) / h') = M (q_new - q - h' v) / h'^2,
///   v_new = (q_new - q) / h',
/// by `iterations` iterations from a first guess that the iteration chooses. Before they have converged the
/// body looks softer, or more damped, than its material.
/// @tparam Iteration  init(system) sizes what it needs; begin(system, t, h, q, v, guess) makes the first
///                    guess; improve(system, t, h, q_new, work) improves it once. One that carries more than
///                    (q, v) from step to step has start(system, t, q, v), of each step, and visit_state
/// @source [macklin2019small] for substeps
template <class Iteration>
class PositionalEuler {
 public:
  using State = Eigen::VectorXd;
  using Real = double;
  static constexpr int order = 1;
  static constexpr int error_order = 0;
  static constexpr bool may_estimate_error = false;
  static constexpr bool is_explicit = false;

  /// @param iterations, substeps  1 at least
  PositionalEuler(Iteration iteration, int iterations, int substeps)
      : iteration_(std::move(iteration)), iterations_(iterations), substeps_(substeps) {}

  /// Sizes everything, evaluates nothing.
  template <SecondOrderSystem Sys>
  void init(const Sys& system, Real, const State&) {
    for (Eigen::VectorXd* each : {&q_, &v_, &start_}) each->setZero(system.dofs());
    iteration_.init(system);
    work_ = {};
  }

  /// @returns always ok: a state that is no number ends the run as diverged
  template <SecondOrderSystem Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    const Eigen::Index n = system.dofs();
    const Real part = h / substeps_;
    q_ = y.head(n);
    v_ = y.tail(n);
    if constexpr (requires { iteration_.start(system, t, q_, v_); }) iteration_.start(system, t, q_, v_);
    for (int s = 1; s <= substeps_; ++s) {
      const Real end = s == substeps_ ? t + h : t + s * part;
      start_ = q_;
      iteration_.begin(system, end, part, start_, v_, q_);
      for (int i = 0; i < iterations_; ++i) {
        leave_when_asked();
        iteration_.improve(system, end, part, q_, work_);
      }
      v_ = (q_ - start_) / part;
    }
    work_.newton += static_cast<std::int64_t>(iterations_) * substeps_;
    y_new.head(n) = q_;
    y_new.tail(n) = v_;
    return StepStatus::ok;
  }

  void accept(const State&) {}

  /// q by the cubic through (q, v) at both ends, v by the straight line: no evaluation, and no acceleration,
  /// which a step that is not converged does not have.
  template <SecondOrderSystem Sys>
  void interpolate(const Sys& system, Real, Real h, const State& y, const State& y_new, Real theta,
                   State& out) const {
    const Eigen::Index n = system.dofs();
    out.resize(y.size());
    out.head(n) = hermite(theta, y.head(n), y_new.head(n), h * y.tail(n), h * y_new.tail(n));
    out.tail(n) = (1 - theta) * y.tail(n) + theta * y_new.tail(n);
  }

  /// Iterations since init().
  [[nodiscard]] const ImplicitWork& work() const { return work_; }
  /// See saved_state.hpp.
  void visit_state(auto& visit) {
    visit_work(visit, work_);
    if constexpr (requires { iteration_.visit_state(visit); }) iteration_.visit_state(visit);
  }

 private:
  Iteration iteration_;
  int iterations_, substeps_;
  Eigen::VectorXd q_, v_, start_;  ///< of the substep, shape (dofs)
  ImplicitWork work_;
};

}  // namespace hmax
