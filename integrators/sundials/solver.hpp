/// CVODE and ARKODE behind one face: the parts that need no type of system, compiled once.
#pragma once

#include <limits>
#include <memory>
#include <string_view>

#include <arkode/arkode_arkstep.h>
#include <cvode/cvode.h>

#include "integrators/implicit/jacobian.hpp"
#include "integrators/stats.hpp"
#include "integrators/stepper.hpp"
#include "integrators/sundials/equations.hpp"
#include "integrators/sundials/vector.hpp"
#include "integrators/tolerances.hpp"

namespace hmax::sundials {

/// The integrators of the library.
enum class Package {
  cvode_adams,  ///< Adams-Moulton of order 1 to 12, functional iteration
  cvode_bdf,    ///< BDF of order 1 to 5, Newton iteration
  erk,          ///< ERKStep: embedded explicit Runge-Kutta
  dirk,         ///< ARKStep: diagonally implicit Runge-Kutta
  imex,         ///< ARKStep: an additive pair, the declared stiff part implicit
  mri,          ///< MRIStep over ARKStep: the stiff part in many small explicit steps inside each slow one
};

/// Whether a package solves (I - gamma J) x = b in each step.
constexpr bool solves_equations(Package package) {
  return package == Package::cvode_bdf || package == Package::dirk || package == Package::imex;
}

/// A method of the library, with the options of the catalogue.
struct Method {
  Package package;
  int explicit_table = ARKODE_ERK_NONE;   ///< of erk and imex
  int implicit_table = ARKODE_DIRK_NONE;  ///< of dirk and imex
  bool klu = true;                        ///< sparse equations are solved by KLU, else by LinearSolver
  int fast_steps = 5;                     ///< of mri, per slow step; each slow stage rounds its share up
};

/// How a run chooses its steps, and what is exact enough.
struct Settings {
  bool adaptive = true;
  double h = 0;                                                         ///< when not adaptive
  double rtol = default_rtol, atol = default_atol;                      ///< when adaptive
  double h_first = 0, h_max = std::numeric_limits<double>::infinity();  ///< as in Tolerances; when adaptive
  JacobianUpdate jacobian{};  ///< frozen: J of the start; K: every K-th step; automatic: the library's rule
  Eigen::VectorXd atols{};    ///< an absolute tolerance for each component in place of atol; empty: atol
};

/// What the library calls; `user` is handed to each.
struct Callbacks {
  CVRhsFn rhs = nullptr, stiff = nullptr, nonstiff = nullptr;
  CVLsLinSysFn cvode_system = nullptr;    ///< writes I - gamma J
  ARKLsLinSysFn arkode_system = nullptr;  ///< the same as ARKODE calls it
  void* user = nullptr;                   ///< not owned; the Binding of the run
};

/// The linear equations of a run; both empty for methods that solve none.
struct Equations {
  MatrixHandle matrix;
  LinearSolverHandle solver;
};

/// One run of the library. Its messages go nowhere: a failure is the value of step().
class Solver {
 public:
  Solver() = default;
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;
  virtual ~Solver() = default;

  /// One step towards t_end, which no step passes: y at t.
  /// @returns 0 or 1 (at t_end); a negative flag of the library when it gave up
  virtual int step(double t_end, N_Vector y, double& t) = 0;
  /// out = y(t) by the library's dense output, t within the last step.
  virtual void interpolate(double t, N_Vector out) = 0;
  /// Steps, failed attempts, factorisations and iterations by the library's own counts.
  [[nodiscard]] virtual Stats stats() const = 0;
};

/// @param y0  initial state at t0; its type of vector is that of the run
/// @throws std::runtime_error  when the library refuses the settings
std::unique_ptr<Solver> make_solver(const Method& method, const Settings& settings,
                                    const Callbacks& callbacks, Equations equations, double t0, double t_end,
                                    N_Vector y0, SUNContext context);

/// The context of the calling thread, which every object of the library needs.
SUNContext this_context();

/// What a negative flag means, and the words for it.
struct Failure {
  Outcome outcome;
  std::string_view words;
};
Failure failure_of(int flag);

}  // namespace hmax::sundials
