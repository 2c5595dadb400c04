/// Static solutions of mechanical systems, F(q) = 0 under a load that is brought on in steps, by the methods
/// of the field and with the history of their residuals.
/// Newton's method for F(q) = 0 with K = -dF/dq: K(q) d = F(q), q <- q + a d, 0 < a <= 1. Loads act in
/// equal steps: step i of N solves F(q) = (1 - i / N) F(0).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/size_limits.hpp"

namespace hmax {

/// The forces on a body at rest. They are those of the body itself and dead loads, which do not depend on q,
/// so that F at q = 0, where a body that is not strained resists nothing, is the whole load.
/// q has shape (dofs) [m] and is zero at rest.
struct StaticModel {
  using Matrix = Eigen::SparseMatrix<double>;
  Eigen::Index dofs = 0;
  /// f = F(q), shape (dofs) [N].
  std::function<void(const Eigen::VectorXd& q, Eigen::VectorXd& f)> force;
  /// K = -dF/dq, shape (dofs, dofs) [N/m], symmetric.
  std::function<void(const Eigen::VectorXd& q, Matrix& K)> stiffness;
  /// E(q) [J], of which F is the downward slope, F = -dE/dq. Empty: line searches have the residual alone.
  std::function<double(const Eigen::VectorXd& q)> energy{};
  /// |F| that is rounding: no iteration can be asked for less [N].
  double rounding = 0;
  /// Whether line searches may go there: an element turned inside out has equilibria of its own, which no
  /// body comes to. Empty: everywhere.
  std::function<bool(const Eigen::VectorXd& q)> admissible{};
};

/// How the equations are linearised.
/// Newton's method converges quadratically near a regular solution, the modified one linearly, with one
/// factorisation in all.
enum class StaticMethod {
  linear,           ///< one solution with the stiffness at rest
  newton,           ///< the stiffness of every iterate
  modified_newton,  ///< the stiffness at rest for all of them
};
/// "linear", "newton", "modified_newton".
std::string_view name_of(StaticMethod method);

/// How K d = F is solved.
/// A direct solution needs the memory of a factor; sor needs none and takes more sweeps the finer the
/// mesh; conjugate gradients need a positive definite K.
enum class InnerSolver {
  direct,              ///< L D L^T
  sor,                 ///< successive over-relaxation
  conjugate_gradients  ///< preconditioned; falls back to L D L^T where K is not positive definite
};
/// "direct", "sor", "cg".
std::string_view name_of(InnerSolver solver);

/// One iterate.
struct StaticIterate {
  int load_step;       ///< from 1
  int load_steps;      ///< of so many
  double residual;     ///< |F| / |F(0)| under the load of the step
  double seconds;      ///< since the start, with the analysis of the pattern
  std::int64_t inner;  ///< iterations of the inner solver so far; 0 for direct
  int iteration = 0;   ///< linear systems solved so far; load steps begin where the last one has ended
};

/// Settings of solve_static(), checked by it.
struct StaticSettings {
  StaticMethod method = StaticMethod::newton;
  InnerSolver inner = InnerSolver::direct;
  double tolerance = 1e-9;  ///< |F| <= tolerance |F(0)|
  /// At most, in each load step: limp bodies, whose equilibrium is far from rest, need hundreds.
  int iterations = 1000;
  std::optional<int> load_steps{};  ///< equal ones; none: one, and for bodies as many as it takes
  /// Halves a step until the energy or the residual falls. With an energy, where K is not positive definite,
  /// as in a body that buckles, steps with K + tau I, downhill, and leaves an equilibrium that is not stable
  /// [nocedal2006numerical, sections 3.1 and 3.4].
  bool line_search = true;
  /// Else line searches end in a saddle too, as the straight equilibrium of a column that buckles is one.
  bool leave_saddles = true;
  /// Of sor and conjugate gradients, relative to the right-hand side. None: in Newton's method as loose as
  /// its convergence allows [eisenstat1996choosing], else 1e-4.
  std::optional<double> inner_tolerance{};
  /// At most, of sor. Newton's methods go on with what these have brought them near to.
  int inner_iterations = 2000;
  double relaxation = 1.5;                           ///< omega of SOR, in (0, 2)
  std::function<void(const StaticIterate&)> seen{};  ///< called with every iterate
};

/// That there is no solution is an answer, not an error: `note` and `remedy` tell.
struct StaticSolution {
  bool converged = false;
  Eigen::VectorXd q;                   ///< the last iterate, shape (dofs) [m]
  std::vector<StaticIterate> history;  ///< the state at rest first
  int iterations = 0;                  ///< linear systems solved
  bool unstable = false;               ///< q is an equilibrium, but not a stable one, and none was found
  /// Whether K is positive definite at q, an equilibrium. None where nobody looked: of linear solutions,
  /// where none was found, and of more than most_factored_often unknowns.
  std::optional<bool> stable{};
  bool singular = false;  ///< the stiffness at rest has no inverse: supports leave motions free
  bool barred = false;    ///< the search ended where its steps led to what is not admissible
  std::string note;       ///< why it did not converge, or only to rounding
  std::string remedy;     ///< what settings may help: "more load steps"; empty: none
};

/// Tells the time [s] that histories record.
/// Differences of its values count; the zero is free.
using Clock = std::function<double()>;

/// Solves for q from rest.
/// Converged when |F| <= tolerance |F(0)| under the full load, or when what is left is rounding. A load
/// below rounding gives q = 0.
/// @param clock  read for the history only
/// @throws InputError  for settings out of range
StaticSolution solve_static(const StaticModel& model, const StaticSettings& settings, const Clock& clock);

/// The relaxation of 1, 1.1, ..., 1.9 and 1.95 with which SOR solves K d = F at rest in the fewest sweeps.
/// SOR converges for symmetric positive definite K and omega in (0, 2) (Golub and Van Loan, Matrix
/// Computations); the best omega depends on the mesh.
/// @return  where none converges in settings.inner_iterations sweeps, the one that leaves least;
/// settings.relaxation where all diverge
double best_relaxation(const StaticModel& model, const StaticSettings& settings);

/// One frame of a load that moves, for which there is time for a fixed number of iterations.
struct StaticFrame {
  double load;      ///< share of the load that acts
  double residual;  ///< |F| / |F(0)| that the frame is left with
  double error;    ///< |q - q*| / |q*| against the solution q* of the frame; not a number where none is found
  double seconds;  ///< that the frame took
};

/// Brings the load on linearly over `frames` frames, each of which begins where the last one ended and has
/// `iterations` iterations without line searches, as interactive simulators do.
/// Frame i of N acts with the share i / N; ends early when the residual is not finite.
/// @param frames, iterations  at least 1
/// @return  no frames for a body without load
/// @throws InputError  for settings out of range
std::vector<StaticFrame> pseudo_dynamic(const StaticModel& model, const StaticSettings& settings, int frames,
                                        int iterations, const Clock& clock);

}  // namespace hmax
