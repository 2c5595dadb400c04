/// The equilibrium of a system near a state, in any dimension. All equilibria in a window of the plane:
/// phase_plane.hpp.
/// y* with f(t, y*) = 0 at a fixed t: the operating point at which the system is linearised.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "analysis/spectrum/linear_model.hpp"

namespace hmax {

/// How a search ends.
enum class EquilibriumOutcome {
  found,
  no_equilibrium,    ///< the rates cannot be brought to zero from this start
  not_finite,        ///< rates or slopes at the start, or on every way from a state, are not finite
  singular_jacobian  ///< too large a system to tell which of the two a singular Jacobian means
};

/// "found", "no_equilibrium", ...
std::string_view name_of(EquilibriumOutcome outcome);

/// What a search has come to. That there may be no equilibrium is an answer, no error.
/// `residual` has the unit of the rates; `conserved` counts independent sums.
struct EquilibriumSearch {
  EquilibriumOutcome outcome = EquilibriumOutcome::no_equilibrium;
  Eigen::VectorXd state;  ///< the equilibrium, or where the search ended, shape (n)
  double residual = 0;    ///< the largest |f_i| there
  int iterations = 0;     ///< Newton steps
  int conserved = 0;      ///< sums w^T y that no motion changes: the state has those of the start
  std::string message;    ///< one sentence for people

  /// Whether `state` is an equilibrium, to rounding.
  [[nodiscard]] bool found() const { return outcome == EquilibriumOutcome::found; }
};

/// f and df/dy at one instant, for states of shape (n).
/// The Jacobian has shape (n, n), dense or sparse. Both may return numbers that are not finite; the search
/// then shortens its step or ends.
struct FrozenField {
  std::function<void(const Eigen::VectorXd& y, Eigen::VectorXd& f)> rhs;  ///< f(y)
  std::function<AnyMatrix(const Eigen::VectorXd& y)> jacobian;            ///< df/dy
};

/// Damped Newton: y += a d with J d = -f, a halved until the correction that follows with the same J shrinks,
/// |J^-1 f(y + a d)| <= (1 - a / 4) |d|, a test that no scaling of f changes [deuflhard2011newton,
/// section 3.3]. Where J is singular the least d that comes closest to J d = -f, after rows and columns have
/// been brought to one size. Sums w^T y that no motion changes keep the value of the start, w^T (y - start) =
/// 0 beside f = 0: on a line of equilibria the one that can be reached is found. Components of y that are
/// rounding beside what they have been on the way are given as 0.
/// It ends when the correction is below 1e-13 of the sizes of y, or below 1e-8 and no longer shrinking,
/// and all |f_i| are rounding beside |J| |y| + |f|. Conserved sums are found from rates at 2 n + 3 random
/// states around the start: w^T f = 0 at all of them.
/// @return  never throws for a search that fails: the outcome and a sentence say why
/// @param start            shape (n)
/// @param most_iterations  a double root takes some 50, a threefold one some 80
/// @cost  one Jacobian and one factorisation a step
EquilibriumSearch find_equilibrium(const FrozenField& field, const Eigen::VectorXd& start,
                                   int most_iterations = 200);

/// The same for a system whose time stands still at t [s].
/// @param t  [s]
template <System S>
EquilibriumSearch find_equilibrium(const S& system, double t, const typename S::State& start,
                                   int most_iterations = 200) {
  using State = typename S::State;
  using Real = real_of<State>;
  const auto at = static_cast<Real>(t);
  const FrozenField field{[&system, at](const Eigen::VectorXd& y, Eigen::VectorXd& f) {
                            const State& own = y.template cast<typename State::Scalar>();
                            State rate = own;
                            system.rhs(at, own, rate);
                            f = rate.template cast<double>();
                          },
                          [&system, at](const Eigen::VectorXd& y) {
                            const State& own = y.template cast<typename State::Scalar>();
                            if constexpr (DifferentiableSystem<S>)
                              if (has_jacobian(system)) return detail::jacobian_of_code(system, at, own);
                            JacobianOrigin origin{};
                            return detail::jacobian_by_differences(system, at, own, origin);
                          }};
  return find_equilibrium(field, start.template cast<double>(), most_iterations);
}

}  // namespace hmax
