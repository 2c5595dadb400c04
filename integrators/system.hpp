/// Concepts of what is integrated. A method knows a system by these verbs and no problem by name.
#pragma once

#ifdef __FAST_MATH__
#error "hmax must not be compiled with -ffast-math: it makes isnan false, and divergence would pass unseen."
#endif

#include <concepts>

#include <Eigen/Core>

namespace hmax {

/// The real type under a state: double for Vector2d, float for VectorXcf.
template <class State>
using real_of = typename Eigen::NumTraits<typename State::Scalar>::Real;

/// A first-order system y' = f(t, y). `rhs` writes f into dydt (already sized, shape (dim)); it is const, has
/// no hidden state and allocates nothing. State is an Eigen column vector, of fixed size where the dimension
/// is known.
template <class S>
concept System = requires(const S& system, real_of<typename S::State> t, const typename S::State& y,
                          typename S::State& dydt) {
  typename S::State;
  { system.dim() } -> std::convertible_to<Eigen::Index>;
  system.rhs(t, y, dydt);
};

/// The Jacobian type of a state of fixed or dynamic size, shape (dim, dim).
template <class State>
using jacobian_of = Eigen::Matrix<typename State::Scalar, State::RowsAtCompileTime, State::RowsAtCompileTime>;

/// A system that also knows df/dy: `jacobian` writes J(i, j) = d f_i / d y_j, shape (dim, dim).
template <class S>
concept DifferentiableSystem = System<S> &&
    requires(const S& system, real_of<typename S::State> t, const typename S::State& y,
             jacobian_of<typename S::State>& J) {
  system.jacobian(t, y, J);
};

/// A system whose dependence on time can be evaluated apart from the state, f(t, y) = f(g(t), y): driving
/// forces, loads, prescribed motion. `at` returns g(t), a small value; `rhs_at` finishes the evaluation. A
/// stepper then evaluates g once for all stages at the same time, which generic code that sees only f(t, y)
/// cannot do.
/// g is also kept from the end t + h of a step to the start of the next when the two agree up to rounding, so
/// the last bits of a run may differ from those of the same system without the split.
template <class S>
concept TimeSplitSystem = System<S> && requires(const S& system, real_of<typename S::State> t,
                                                const typename S::State& y, typename S::State& dydt) {
  system.rhs_at(system.at(t), y, dydt);
};

}  // namespace hmax
