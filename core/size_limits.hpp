/// How large a model may be for each computation, in one place. A limit stands where people would no longer
/// wait; beyond it something cheaper is computed, or a sentence says what is left out.
#pragma once

#include <cstddef>

namespace hmax {

// Dense matrices: the work grows with the cube of their rows, the memory with the square.

/// Rows of a matrix with all its eigenvalues: each copy of it has 128 MB.
/// 4000^2 doubles of 8 bytes are 128 MB; the QR algorithm takes some 10 n^3 operations for eigenvalues
/// alone and 25 n^3 with the Schur form and its vectors (Golub and Van Loan, Matrix Computations).
inline constexpr std::ptrdiff_t most_dense_rows = 4000;
/// Rows of a mass matrix that couples degrees of freedom where M^-1 K is needed as one matrix, which is full.
inline constexpr std::ptrdiff_t most_coupled_masses = 1500;
/// Rows of a companion matrix whose eigenvalues are asked for at one step size after another.
inline constexpr std::ptrdiff_t most_coupled_rows = 1500;
/// Degrees of freedom of linear tissue whose exact motion is summed from all its modes: beyond, they take
/// minutes.
inline constexpr std::ptrdiff_t most_modal_dofs = 1500;
/// Rows of a singular Jacobian whose kernel is sought by a complete orthogonal decomposition.
inline constexpr std::ptrdiff_t most_dense_kernel = 1000;
/// States of a model that a foreign engine steps with a dense factor in every step.
inline constexpr std::ptrdiff_t most_dense_equations = 600;
/// States of a model whose departure from normality is computed: ten operations with dense matrices.
/// The Schur form and an eigenproblem among them.
inline constexpr std::ptrdiff_t most_measured_normality = 400;
/// Degrees of freedom of a structure with all its eigenvalues where damping couples its modes.
inline constexpr std::ptrdiff_t most_dense_coupled = 300;
/// Rows of a matrix for which a Krylov method is not worth its set-up.
inline constexpr std::ptrdiff_t small_enough_for_dense = 200;
/// States of a model whose spectrum explains a work-precision diagram: a larger one takes longer than the
/// runs.
inline constexpr std::ptrdiff_t most_explained_states = 200;
/// States of a system of which linear invariants are sought whatever its Jacobian says.
inline constexpr std::ptrdiff_t most_searched_invariants = 64;
/// Degrees of freedom of a structure whose verification starts from all of its modes.
inline constexpr std::ptrdiff_t most_dense_start = 20;
/// States of a driven model that is verified: its whole motion is kept, to be subtracted.
inline constexpr std::ptrdiff_t most_driven_states = 20;
/// States of a model whose Kreiss constant is computed: some hundred spectra of twice the size.
inline constexpr std::ptrdiff_t most_kreiss_states = 12;

// Sparse factors of a mesh: the memory grows with about the power 4/3 of the degrees of freedom.

/// Degrees of freedom beyond which one factor of the stiffness takes minutes and gigabytes.
inline constexpr std::ptrdiff_t most_factored = 200'000;
/// Tetrahedra from which on a time is the best of two repetitions instead of five.
inline constexpr std::ptrdiff_t least_timed_twice = 100'000;
/// Unknowns of a factor that may be made in every step, or that tells whether an equilibrium is stable:
/// seconds and a gigabyte.
inline constexpr std::ptrdiff_t most_factored_often = 60'000;
/// Degrees of freedom of a body for which changes of its mesh are tried, each with a Lanczos iteration.
inline constexpr std::ptrdiff_t most_tried_gains = 30'000;
/// Degrees of freedom of a body whose steps are tried one after another until Newton's method fails.
inline constexpr std::ptrdiff_t most_newton_step_dofs = 10'000;

}  // namespace hmax
