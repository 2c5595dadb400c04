/// Counting what a run did. The loop counts steps; this wrapper is the only place that counts evaluations.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "integrators/system.hpp"

namespace hmax {

/// What an implicit method did inside its attempts; the loop puts it into the Stats of the run.
struct ImplicitWork {
  std::int64_t factorisations = 0;     ///< of matrices
  std::int64_t newton = 0;             ///< Newton iterations, all stages together
  std::int64_t linear_iterations = 0;  ///< of conjugate gradients, all equations together
  /// Largest error that the iterations of a stage left, as their convergence foretells, relative to the
  /// largest number of the state; of methods that iterate, at fixed steps.
  double newton_error = 0;
  std::string_view failure{};  ///< why the last equations that were not solved were not
};

/// What a run did.
struct Stats {
  std::int64_t steps = 0;     ///< accepted steps
  std::int64_t rejected = 0;  ///< rejected attempts
  std::int64_t rhs = 0;       ///< evaluations of f; 0 unless the system was Counted
  std::int64_t jacobian = 0;  ///< evaluations of df/dy; 0 unless the system was Counted
  std::int64_t factorisations = 0, newton = 0, linear_iterations = 0;  ///< as in ImplicitWork
  double newton_error = 0;                                             ///< as in ImplicitWork

  /// The work of the implicit method of the run.
  void take(const ImplicitWork& work) {
    factorisations = work.factorisations;
    newton = work.newton;
    linear_iterations = work.linear_iterations;
    newton_error = work.newton_error;
  }

  /// Adds the counts of another part of the run.
  Stats& operator+=(const Stats& part) {
    steps += part.steps;
    rejected += part.rejected;
    rhs += part.rhs;
    jacobian += part.jacobian;
    factorisations += part.factorisations;
    newton += part.newton;
    linear_iterations += part.linear_iterations;
    newton_error = std::max(newton_error, part.newton_error);
    return *this;
  }

  bool operator==(const Stats&) const = default;
};

/// A system that counts the calls of its verbs into the Stats of the caller; everything else is the system's
/// own. It holds a copy of the system.
/// @tparam S  any system; Counted<S> has every verb that S has
template <System S>
class Counted : public S {
 public:
  using State = typename S::State;
  using Real = real_of<State>;
  /// @param stats  must live as long as this system and its copies
  Counted(const S& system, Stats& stats) : S(system), stats_(&stats) {}

  /// f(t, y), one evaluation.
  void rhs(Real t, const State& y, State& dydt) const {
    ++stats_->rhs;
    S::rhs(t, y, dydt);
  }
  /// f(g(t), y), one evaluation; g itself is not counted.
  template <class TimePart>
  requires TimeSplitSystem<S>
  void rhs_at(const TimePart& part, const State& y, State& dydt) const {
    ++stats_->rhs;
    S::rhs_at(part, y, dydt);
  }
  /// df/dy, one evaluation; differences count as evaluations of f instead.
  template <class Matrix>
  requires DifferentiableSystem<S>
  void jacobian(Real t, const State& y, Matrix& J) const {
    ++stats_->jacobian;
    S::jacobian(t, y, J);
  }

  /// A force counts as an evaluation of f, a stiffness as one of its Jacobian.
  template <class Dofs>
  requires SecondOrderSystem<S>
  void force(Real t, const Dofs& q, const Dofs& v, Dofs& f) const {
    ++stats_->rhs;
    S::force(t, q, v, f);
  }
  template <class Dofs, class Matrix>
  requires SecondOrderSystem<S>
  void stiffness(Real t, const Dofs& q, const Dofs& v, Matrix& K) const {
    ++stats_->jacobian;
    S::stiffness(t, q, v, K);
  }

  /// Each half of a split f counts as an evaluation.
  void rhs_stiff(Real t, const State& y, State& dydt) const requires SplitSystem<S> {
    ++stats_->rhs;
    S::rhs_stiff(t, y, dydt);
  }
  void rhs_nonstiff(Real t, const State& y, State& dydt) const requires SplitSystem<S> {
    ++stats_->rhs;
    S::rhs_nonstiff(t, y, dydt);
  }
  /// The Jacobian of the stiff part, one evaluation of df/dy.
  template <class Matrix>
  requires SplitSystem<S>
  void jacobian_stiff(Real t, const State& y, Matrix& J) const {
    ++stats_->jacobian;
    S::jacobian_stiff(t, y, J);
  }
  /// The stiffness of the stiff part, one evaluation of its Jacobian.
  template <class Matrix>
  requires SplitStructure<S>
  void stiffness_stiff(Matrix& K) const {
    ++stats_->jacobian;
    S::stiffness_stiff(K);
  }

 private:
  Stats* stats_;  ///< not owned
};

}  // namespace hmax
