/// Concepts of what is integrated. A method knows a system by these verbs and no problem by name.
#pragma once

#ifdef __FAST_MATH__
#error "hmax must not be compiled with -ffast-math: it makes isnan false, and divergence would pass unseen."
#endif

#include <concepts>
#include <memory>

#include <Eigen/Core>

#include "core/structure_operator.hpp"

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
  // n, the number of first-order equations
  { system.dim() } -> std::convertible_to<Eigen::Index>;
  // dydt = f(t, y)
  system.rhs(t, y, dydt);
};

/// The Jacobian type of a state of fixed or dynamic size, shape (dim, dim).
template <class State>
using jacobian_of = Eigen::Matrix<typename State::Scalar, State::RowsAtCompileTime, State::RowsAtCompileTime>;

namespace detail {
/// S::Jacobian where a system declares it.
template <class S>
struct JacobianType {
  using type = jacobian_of<typename S::State>;
};
template <class S>
requires requires { typename S::Jacobian; }
struct JacobianType<S> {
  using type = typename S::Jacobian;
};
}  // namespace detail

/// The type a system writes its Jacobian into, shape (dim, dim): S::Jacobian where it declares one (a dense
/// matrix, an Eigen::SparseMatrix, or a std::variant of both for systems that decide at run time), else the
/// dense matrix of its state.
template <class S>
using jacobian_type = typename detail::JacobianType<S>::type;

/// A system that also knows df/dy: `jacobian` writes J(i, j) = d f_i / d y_j, shape (dim, dim). A sparse J
/// has one pattern for all t and y; it arrives empty, or as the last call left it.
template <class S>
concept DifferentiableSystem = System<S> &&
    requires(const S& system, real_of<typename S::State> t, const typename S::State& y, jacobian_type<S>& J) {
  // J_ij = d f_i / d y_j
  system.jacobian(t, y, J);
};

/// A system that knows df/dt, shape (dim), which Rosenbrock methods ask for. One that does not depend on time
/// says so instead: `static constexpr bool autonomous = true`. dfdt_i = partial f_i / partial t at fixed y.
template <class S>
concept TimeDifferentiableSystem = System<S> &&
    requires(const S& system, real_of<typename S::State> t, const typename S::State& y,
             typename S::State& dfdt) {
  // dfdt_i = d f_i / d t
  system.time_derivative(t, y, dfdt);
};

/// A mechanical system M q'' = F(t, q, v) behind its packed first-order form y = (q, v), dim() = 2 dofs().
/// `mass` is the lumped M, shape (dofs), kg; a system whose M may couple unknowns has the verb `mass_matrix`
/// too (core/mass_matrix.hpp), and `mass` then throws where it does; `force` writes F, shape (dofs), N;
/// `stiffness` writes K = -dF/dq and `damping` C = -dF/dv, shape (dofs, dofs), of type DofMatrix (dense,
/// sparse or a variant of both, as for Jacobians).
template <class S>
concept SecondOrderSystem = System<S> &&
    requires(const S& system, real_of<typename S::State> t, const typename S::Dofs& q,
             const typename S::Dofs& v, typename S::Dofs& f, typename S::DofMatrix& matrix) {
  { system.dofs() } -> std::convertible_to<Eigen::Index>;
  // the diagonal of M, m_i [kg]
  { system.mass() } -> std::convertible_to<typename S::Dofs>;
  // f = F [N] for displacements q [m] and velocities v [m/s] of tissue; matrix = K [N/m] or C [N s/m]
  system.force(t, q, v, f);
  system.stiffness(t, q, v, matrix);
  system.damping(t, q, v, matrix);
};

/// The operators of a linear second-order system that has no matrices to write, by its verb
/// `structure_operator`; null for others.
template <System S>
std::shared_ptr<const StructureOperator> structure_operator_of(const S& system) {
  if constexpr (requires { system.structure_operator(); })
    return system.structure_operator();
  else
    return nullptr;
}

/// The largest of the numbers that the holders of the unknowns of a system have, of which this one has `own`.
/// A system whose unknowns are dealt out to processes has a verb of that name, which is not finite where one
/// number is not; others are alone. What is decided about a step depends on such numbers, so that all decide
/// the same.
template <System S>
constexpr real_of<typename S::State> largest_of_all(const S& system, real_of<typename S::State> own) {
  if constexpr (requires { system.largest_of_all(own); })
    return system.largest_of_all(own);
  else
    return own;
}

/// Whether a second-order system writes sparse K and C; an erased one answers at run time.
template <SecondOrderSystem S>
constexpr bool has_sparse_matrices(const S& system) {
  if constexpr (requires { system.has_sparse_matrices(); })
    return system.has_sparse_matrices();
  else
    return requires(const typename S::DofMatrix& K) { K.outerIndexPtr(); };
}

/// A system that declares a stiff part, f = stiff + nonstiff, with the Jacobian of the stiff part: IMEX
/// methods treat it implicitly and the rest explicitly.
template <class S>
concept SplitSystem = System<S> &&
    requires(const S& system, real_of<typename S::State> t, const typename S::State& y,
             typename S::State& dydt, jacobian_type<S>& J) {
  // f = stiff + nonstiff, and d stiff_i / d y_j
  system.rhs_stiff(t, y, dydt);
  system.rhs_nonstiff(t, y, dydt);
  system.jacobian_stiff(t, y, J);
};

/// A split second-order system whose stiff part is that of a linear structure, (v, -M^-1 (K0 q + C0 v)). It
/// writes the constant matrices K0 and C0, shape (dofs, dofs); jacobian_stiff has the same in one matrix of
/// twice the size, which is not symmetric.
template <class S>
concept SplitStructure = SplitSystem<S> && SecondOrderSystem<S> &&
    requires(const S& system, typename S::DofMatrix& matrix) {
  // matrix = K0 [N/m] or C0 [N s/m]
  system.stiffness_stiff(matrix);
  system.damping_stiff(matrix);
};

/// Whether the stiff part of a system is given as the matrices of a structure, and these are sparse.
template <SplitSystem S>
constexpr bool has_stiff_structure(const S& system) {
  if constexpr (requires { system.has_stiff_structure(); })
    return system.has_stiff_structure();
  else if constexpr (SplitStructure<S>)
    return has_sparse_matrices(system);
  else
    return false;
}

/// True when the stiff part of a split system is known to be linear in y, with a Jacobian that never changes:
/// one Newton correction then solves its equations. A type says so by
/// `static constexpr bool linear_stiff_part = true`.
template <SplitSystem S>
constexpr bool has_linear_stiff_part(const S& system) {
  if constexpr (requires { system.has_linear_stiff_part(); })
    return system.has_linear_stiff_part();
  else if constexpr (requires { S::linear_stiff_part; })
    return S::linear_stiff_part;
  else
    return false;
}

/// A system that bounds the spectral radius of its Jacobian [1/s], which stabilised methods ask for.
template <class S>
concept BoundedSpectrumSystem = System<S> &&
    requires(const S& system, real_of<typename S::State> t, const typename S::State& y) {
  { system.spectral_radius(t, y) } -> std::convertible_to<real_of<typename S::State>>;
};

/// A system that adds numbers larger than those of its state: positions X + q in space, of which the state
/// holds the displacements q. `offset` writes |X|, shape (dim), in the units of the state; the rounding of f
/// is that of numbers of the size |y_i| + |X_i|.
template <class S>
concept OffsetSystem = System<S> && requires(const S& system, typename S::State& X) {
  system.offset(X);
};

/// Whether a system offers a verb. A type that has it says so by having it; an erased system, which has every
/// verb, answers at run time through has_jacobian(), has_time_derivative(), and so on.
template <System S>
constexpr bool has_jacobian(const S& system) {
  if constexpr (requires { system.has_jacobian(); })
    return system.has_jacobian();
  else
    return DifferentiableSystem<S>;
}
/// Whether the system writes df/dt itself.
template <System S>
constexpr bool has_time_derivative(const S& system) {
  if constexpr (requires { system.has_time_derivative(); })
    return system.has_time_derivative();
  else
    return TimeDifferentiableSystem<S>;
}
/// Whether the system bounds the spectral radius of df/dy.
template <System S>
constexpr bool has_spectral_radius(const S& system) {
  if constexpr (requires { system.has_spectral_radius(); })
    return system.has_spectral_radius();
  else
    return BoundedSpectrumSystem<S>;
}

/// Whether the numbers of the state are added to larger ones.
template <System S>
constexpr bool has_offset(const S& system) {
  if constexpr (requires { system.has_offset(); })
    return system.has_offset();
  else
    return OffsetSystem<S>;
}

/// True when f is known not to depend on time: df/dt = 0, and a difference in t is not worth an evaluation.
template <System S>
constexpr bool is_autonomous(const S& system) {
  if constexpr (requires { system.is_autonomous(); })
    return system.is_autonomous();
  else if constexpr (requires { S::autonomous; })
    return S::autonomous;
  else
    return false;
}

/// True when f is known to be A y + b(t) with one A: one correction of Newton's method then solves the
/// equations of a step.
template <System S>
constexpr bool is_linear(const S& system) {
  if constexpr (requires { system.is_linear(); })
    return system.is_linear();
  else
    return false;
}

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
