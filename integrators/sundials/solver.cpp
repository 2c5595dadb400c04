/// CVODE, ERKStep, ARKStep and MRIStep of SUNDIALS 6.4 [hindmarsh2005sundials, reynolds2023arkode] as
/// Solvers. Every call of the library returns a flag; negative ones are failures.
#include "integrators/sundials/solver.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <arkode/arkode_erkstep.h>
#include <arkode/arkode_mristep.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "integrators/sundials/tables.hpp"

namespace hmax::sundials {

namespace {

/// At fixed steps nothing but rounding is to disturb the order: the stage equations are solved to this, as
/// relative tolerance and as absolute one, in the units of the state.
constexpr double tight = 1e-12;
/// Newton iterations of a stage at fixed steps, where a step cannot be cut; by default the library gives up
/// after three.
constexpr int patient_iterations = 20;
/// ARKStep takes the iteration of a stage for converged where rate |correction| is within the tolerance. Its
/// rate falls by this factor (0.3 by default) with each iteration, and is forgotten at a factorisation only:
/// on linear equations to 1e-5 and less. When gamma then changes by up to a fifth without a new factorisation
/// the error left is a tenth of the correction, and the first correction is that of y_n: too large by far.
/// With 1 the rate is never below 1.
constexpr double lasting_rate = 1;
/// The library counts steps of one call, and a call is one step here.
constexpr long no_limit = -1;

/// In the place of the library's handler, which prints to standard error. Arguments: flag, module, function,
/// message, user data.
void be_silent(int, const char*, const char*, char*, void*) {}

/// @throws std::runtime_error  where the flag is negative; `what` names what was to be set
void check(int flag, const char* what) {
  if (flag < 0)
    throw std::runtime_error("SUNDIALS refuses " + std::string(what) + " (flag " + std::to_string(flag) +
                             ")");
}
/// @throws std::runtime_error  where the library returns no object
void* checked(void* made, const char* what) {
  if (made == nullptr) throw std::runtime_error("SUNDIALS cannot make " + std::string(what));
  return made;
}

/// Flags ARK_RHSFUNC_FAIL = -8 down to ARK_UNREC_RHSFUNC_ERR = -11: f failed, or was not finite.
bool is_rhs_failure(int flag) { return flag <= ARK_RHSFUNC_FAIL && flag >= ARK_UNREC_RHSFUNC_ERR; }

/// One count of an integrator, by its own function. The flag of `read` is not looked at: it fails where
/// `memory` is null, and own() has seen to that.
std::int64_t count_of(int (*read)(void*, long int*), void* memory) {
  long int count = 0;
  read(memory, &count);
  return count;
}

/// The memory of one integrator, freed by the function of its kind, which stands beside the pointer: the
/// library has void* for all kinds.
using Memory = std::unique_ptr<void, void (*)(void*)>;
/// Takes over what a creating function has returned.
/// @tparam Free  takes the address of a pointer, which it sets to null: here that of a copy
/// @throws std::runtime_error  where `made` is null
template <void (*Free)(void**)>
Memory own(void* made, const char* what) {
  return {checked(made, what), [](void* memory) { Free(&memory); }};
}

/// Tells an integrator its tolerances.
/// @param scalar, vector  its functions for one absolute tolerance and for one for each component
/// @param y0  of the type and the length of the run's vectors; its values do not matter
/// @throws std::runtime_error  where the library refuses them, as negative ones
void set_tolerances(void* memory, const Settings& settings, N_Vector y0, int (*scalar)(void*, double, double),
                    int (*vector)(void*, double, N_Vector)) {
  if (settings.atols.size() == 0)
    return check(scalar(memory, settings.rtol, settings.atol), "the tolerances");
  // The library copies the vector.
  const Vector atols(static_cast<N_Vector>(checked(N_VClone(y0), "a vector of tolerances")));
  std::copy(settings.atols.begin(), settings.atols.end(), N_VGetArrayPointer(atols.get()));
  check(vector(memory, settings.rtol, atols.get()), "the tolerances");
}

/// Tells an integrator its longest step, and its first one where that is given.
/// @throws std::runtime_error  where the library refuses them
void set_steps(void* memory, const Settings& settings, int (*longest)(void*, double),
               int (*first)(void*, double)) {
  check(longest(memory, settings.h_max), "the longest step");
  if (settings.h_first > 0) check(first(memory, settings.h_first), "the first step");
}

/// Of functional iteration; Newton's is the default of the library and owned by it.
struct FreeNonlinearSolver {
  void operator()(SUNNonlinearSolver solver) const { SUNNonlinSolFree(solver); }
};

/// CVODE, variable order and step: BDF of order 1 to 5, or Adams-Moulton of order 1 to 12, in Nordsieck
/// form. Each step solves
///   y_new - gamma f(t_new, y_new) = known,   (I - gamma J) d = residual for BDF,
/// by Newton's method, or y_new = gamma f(t_new, y_new) + known by functional iteration for Adams.
class Cvode final : public Solver {
 public:
  /// @param equations  of BDF, taken over: the library refers to them and frees neither; empty for Adams
  /// @param y0         copied by the library, shape (n)
  /// @throws std::runtime_error  where the library refuses a setting
  Cvode(const Method& method, const Settings& settings, const Callbacks& calls, Equations equations,
        double t0, double t_end, N_Vector y0, SUNContext context)
      : equations_(std::move(equations)),
        memory_(own<CVodeFree>(CVodeCreate(method.package == Package::cvode_bdf ? CV_BDF : CV_ADAMS, context),
                               "CVODE")) {
    void* cvode = memory_.get();
    check(CVodeSetErrHandlerFn(cvode, be_silent, nullptr), "an error handler");
    check(CVodeInit(cvode, calls.rhs, t0, y0), "the initial state");
    check(CVodeSetUserData(cvode, calls.user), "the system");
    set_tolerances(cvode, settings, y0, CVodeSStolerances, CVodeSVtolerances);
    set_steps(cvode, settings, CVodeSetMaxStep, CVodeSetInitStep);
    check(CVodeSetMaxNumSteps(cvode, no_limit), "steps without limit");
    // The stop time is exact: no step passes the end of the run.
    check(CVodeSetStopTime(cvode, t_end), "the end time");
    if (method.package == Package::cvode_adams) {
      // No Jacobian and no factorisation: the iteration converges where gamma |J| < 1. With 0 vectors
      // of Anderson's acceleration it is the plain one.
      functional_iteration_.reset(SUNNonlinSol_FixedPoint(y0, 0, context));
      checked(functional_iteration_.get(), "a functional iteration");
      check(CVodeSetNonlinearSolver(cvode, functional_iteration_.get()), "the functional iteration");
      return;
    }
    // The solver first: the function that writes its matrix is refused without one.
    check(CVodeSetLinearSolver(cvode, equations_.solver.get(), equations_.matrix.get()), "the linear solver");
    check(CVodeSetLinSysFn(cvode, calls.cvode_system), "the linear equations");
    // K >= 1: J at every K-th step. frozen is the business of the callback, automatic that of CVODE.
    if (settings.jacobian.every >= 1) {
      check(CVodeSetJacEvalFrequency(cvode, settings.jacobian.every), "the interval of Jacobians");
      check(CVodeSetLSetupFrequency(cvode, settings.jacobian.every), "the interval of factorisations");
    }
  }

  /// One step of the library's own size. t_end serves the first call, for the direction and the scale of the
  /// first step; where the run ends the stop time says.
  int step(double t_end, N_Vector y, double& t) override {
    return CVode(memory_.get(), t_end, y, &t, CV_ONE_STEP);
  }
  /// Derivative of order 0 of the Nordsieck polynomial of the last step. The library refuses a t outside
  /// of that; observers ask inside.
  void interpolate(double t, N_Vector out) override { CVodeGetDky(memory_.get(), t, 0, out); }
  /// A step is rejected by its error test or by its iteration. `newton` counts the functional iterations of
  /// Adams too; a factorisation is a setup of the linear solver.
  [[nodiscard]] Stats stats() const override {
    void* cvode = memory_.get();
    Stats stats;
    stats.steps = count_of(CVodeGetNumSteps, cvode);
    stats.rejected = count_of(CVodeGetNumErrTestFails, cvode) + count_of(CVodeGetNumStepSolveFails, cvode);
    stats.newton = count_of(CVodeGetNumNonlinSolvIters, cvode);
    if (equations_.solver) stats.factorisations = count_of(CVodeGetNumLinSolvSetups, cvode);
    return stats;
  }

 private:
  Equations equations_;
  std::unique_ptr<_generic_SUNNonlinearSolver, FreeNonlinearSolver> functional_iteration_;  ///< of Adams only
  /// Declared last: freed before the equations that it uses.
  Memory memory_;
};

/// Embedded explicit Runge-Kutta methods,
///   k_i = f(t + c_i h, y + h sum_{j < i} a_ij k_j),   y_new = y + h sum_i b_i k_i.
/// The error estimate is the difference to the embedded weights; the library tests it and chooses h.
class ErkStep final : public Solver {
 public:
  /// @throws std::runtime_error, std::invalid_argument  where the library refuses a setting or has no such
  ///   table
  ErkStep(const Method& method, const Settings& settings, const Callbacks& calls, double t0, double t_end,
          N_Vector y0, SUNContext context)
      : memory_(own<ERKStepFree>(ERKStepCreate(calls.rhs, t0, y0, context), "ERKStep")),
        adaptive_(settings.adaptive) {
    void* erk = memory_.get();
    check(ERKStepSetErrHandlerFn(erk, be_silent, nullptr), "an error handler");
    check(ERKStepSetUserData(erk, calls.user), "the system");
    // Corrected where ERKStep would take it wrongly for first-same-as-last.
    const Table table = explicit_table(method.explicit_table);
    check(ERKStepSetTable(erk, table.get()), "the table");
    check(ERKStepSetMaxNumSteps(erk, no_limit), "steps without limit");
    check(ERKStepSetStopTime(erk, t_end), "the end time");
    // At fixed steps there is no error test.
    if (settings.adaptive) {
      set_tolerances(erk, settings, y0, ERKStepSStolerances, ERKStepSVtolerances);
      set_steps(erk, settings, ERKStepSetMaxStep, ERKStepSetInitStep);
    } else {
      check(ERKStepSetFixedStep(erk, settings.h), "the step");
    }
  }

  /// Where f is not finite the step is cut to a quarter, until it no longer moves t.
  /// @returns the flag of the library
  int step(double t_end, N_Vector y, double& t) override {
    void* erk = memory_.get();
    const double start = t;
    int flag = ERKStepEvolve(erk, t_end, y, &t, ARK_ONE_STEP);
    // Where CVODE and ARKStep try a shorter step, ERKStep gives up: it is begun anew at the last good state.
    // The step that failed; the rest of the run where the library does not tell it.
    double h = t_end - start;
    if (is_rhs_failure(flag)) ERKStepGetCurrentStep(erk, &h);
    while (is_rhs_failure(flag) && adaptive_) {
      // As CVODE and ARKStep cut a step whose iteration does not converge.
      h /= 4;
      // The flag of the last failure goes back: failure_of() calls it diverged.
      if (!(start + h > start)) break;
      // Counts go on after a reset, but the stop time is forgotten. y is the state at `start`.
      check(ERKStepReset(erk, start, y), "a restart");
      check(ERKStepSetInitStep(erk, h), "the step of a restart");
      check(ERKStepSetStopTime(erk, t_end), "the end time");
      flag = ERKStepEvolve(erk, t_end, y, &t, ARK_ONE_STEP);
    }
    return flag;
  }
  void interpolate(double t, N_Vector out) override { ERKStepGetDky(memory_.get(), t, 0, out); }
  [[nodiscard]] Stats stats() const override {
    Stats stats;
    stats.steps = count_of(ERKStepGetNumSteps, memory_.get());
    // Accepted steps are attempts too.
    stats.rejected = count_of(ERKStepGetNumStepAttempts, memory_.get()) - stats.steps;
    return stats;
  }

 private:
  Memory memory_;
  bool adaptive_;  ///< a fixed step is not cut
};

/// Diagonally implicit methods, (I - h gamma J) d = residual in each stage, and additive pairs with f =
/// nonstiff + stiff, of which the second is implicit. Without a pair f has no explicit part.
class ArkStep final : public Solver {
 public:
  /// @param calls      nonstiff and stiff of a pair; of dirk rhs alone, all of it implicit
  /// @param equations  taken over: the library refers to them and frees neither
  /// @throws std::runtime_error  where the library refuses a setting
  ArkStep(const Method& method, const Settings& settings, const Callbacks& calls, Equations equations,
          double t0, double t_end, N_Vector y0, SUNContext context)
      : equations_(std::move(equations)),
        memory_(own<ARKStepFree>(method.package == Package::imex
                                     ? ARKStepCreate(calls.nonstiff, calls.stiff, t0, y0, context)
                                     : ARKStepCreate(nullptr, calls.rhs, t0, y0, context),
                                 "ARKStep")) {
    void* ark = memory_.get();
    check(ARKStepSetErrHandlerFn(ark, be_silent, nullptr), "an error handler");
    check(ARKStepSetUserData(ark, calls.user), "the system");
    check(ARKStepSetTableNum(ark, static_cast<ARKODE_DIRKTableID>(method.implicit_table),
                             static_cast<ARKODE_ERKTableID>(method.explicit_table)),
          "the tables");
    check(ARKStepSetMaxNumSteps(ark, no_limit), "steps without limit");
    check(ARKStepSetStopTime(ark, t_end), "the end time");
    check(ARKStepSetLinearSolver(ark, equations_.solver.get(), equations_.matrix.get()), "the linear solver");
    check(ARKStepSetLinSysFn(ark, calls.arkode_system), "the linear equations");
    if (settings.adaptive) {
      set_tolerances(ark, settings, y0, ARKStepSStolerances, ARKStepSVtolerances);
      set_steps(ark, settings, ARKStepSetMaxStep, ARKStepSetInitStep);
      check(ARKStepSetNonlinCRDown(ark, lasting_rate), "the estimate of the rate of convergence");
    } else {
      // gamma does not change, and tolerances near rounding ask for what the library makes of its rate.
      // Without an error test the tolerances serve the stage equations alone.
      check(ARKStepSStolerances(ark, tight, tight), "the tolerances");
      check(ARKStepSetMaxNonlinIters(ark, patient_iterations), "the number of iterations");
      check(ARKStepSetFixedStep(ark, settings.h), "the step");
    }
    // As in CVODE.
    if (settings.jacobian.every >= 1) {
      check(ARKStepSetJacEvalFrequency(ark, settings.jacobian.every), "the interval of Jacobians");
      check(ARKStepSetLSetupFrequency(ark, settings.jacobian.every), "the interval of factorisations");
    }
  }

  int step(double t_end, N_Vector y, double& t) override {
    return ARKStepEvolve(memory_.get(), t_end, y, &t, ARK_ONE_STEP);
  }
  void interpolate(double t, N_Vector out) override { ARKStepGetDky(memory_.get(), t, 0, out); }
  [[nodiscard]] Stats stats() const override {
    void* ark = memory_.get();
    Stats stats;
    stats.steps = count_of(ARKStepGetNumSteps, ark);
    // Accepted steps are attempts too; setups are factorisations, as in CVODE.
    stats.rejected = count_of(ARKStepGetNumStepAttempts, ark) - stats.steps;
    stats.newton = count_of(ARKStepGetNumNonlinSolvIters, ark);
    stats.factorisations = count_of(ARKStepGetNumLinSolvSetups, ark);
    return stats;
  }

 private:
  Equations equations_;
  /// Declared last: freed before the equations that it uses.
  Memory memory_;
};

/// Multirate, explicit in both parts. The slow method is the library's of order 3, whose three stages run
/// through 1/3, 5/12 and 1/4 of a step of size h. In each the fast part takes explicit steps of order 3 too,
/// of size h / method.fast_steps, the last one cut to the end of the stage: 2 + 3 + 2 of them for h / 5.
/// Neither size is adapted.
class MriStep final : public Solver {
 public:
  /// @param calls  stiff is the fast part, nonstiff the slow one; both are explicit
  /// @param y0     copied by both integrators, shape (n)
  /// @throws std::runtime_error  where the library refuses a setting
  MriStep(const Method& method, const Settings& settings, const Callbacks& calls, double t0, double t_end,
          N_Vector y0, SUNContext context)
      : fast_(own<ARKStepFree>(ARKStepCreate(calls.stiff, nullptr, t0, y0, context), "ARKStep")),
        bridge_(nullptr,
                [](void* bridge) {
                  auto stepper = static_cast<MRIStepInnerStepper>(bridge);
                  MRIStepInnerStepper_Free(&stepper);
                }),
        slow_(nullptr, nullptr) {
    check(ARKStepSetErrHandlerFn(fast_.get(), be_silent, nullptr), "an error handler");
    check(ARKStepSetUserData(fast_.get(), calls.user), "the system");
    // The formula of order 3 of Bogacki and Shampine; at fixed steps its error estimate is not used.
    check(ARKStepSetTableNum(fast_.get(), ARKODE_DIRK_NONE, ARKODE_BOGACKI_SHAMPINE_4_2_3), "the fast table");
    check(ARKStepSetMaxNumSteps(fast_.get(), no_limit), "steps without limit");
    check(ARKStepSetFixedStep(fast_.get(), settings.h / method.fast_steps), "the fast step");
    // Through this MRIStep drives the fast integrator, to the end of one stage at a time. It owns neither.
    MRIStepInnerStepper stepper = nullptr;
    check(ARKStepCreateMRIStepInnerStepper(fast_.get(), &stepper), "the fast part");
    bridge_.reset(stepper);
    slow_ = own<MRIStepFree>(MRIStepCreate(calls.nonstiff, nullptr, t0, y0, stepper, context), "MRIStep");
    check(MRIStepSetErrHandlerFn(slow_.get(), be_silent, nullptr), "an error handler");
    check(MRIStepSetUserData(slow_.get(), calls.user), "the system");
    check(MRIStepSetMaxNumSteps(slow_.get(), no_limit), "steps without limit");
    check(MRIStepSetStopTime(slow_.get(), t_end), "the end time");
    check(MRIStepSetFixedStep(slow_.get(), settings.h), "the slow step");
  }

  int step(double t_end, N_Vector y, double& t) override {
    return MRIStepEvolve(slow_.get(), t_end, y, &t, ARK_ONE_STEP);
  }
  void interpolate(double t, N_Vector out) override { MRIStepGetDky(slow_.get(), t, 0, out); }
  [[nodiscard]] Stats stats() const override {
    Stats stats;
    // Slow steps alone; a fixed step without an error test is never rejected.
    stats.steps = count_of(MRIStepGetNumSteps, slow_.get());
    return stats;
  }

 private:
  Memory fast_, bridge_, slow_;  ///< freed from the last to the first
};

}  // namespace

std::unique_ptr<Solver> make_solver(const Method& method, const Settings& settings,
                                    const Callbacks& callbacks, Equations equations, double t0, double t_end,
                                    N_Vector y0, SUNContext context) {
  // Without a default, so that the compiler names a package that is missing here.
  switch (method.package) {
    case Package::cvode_adams:
    case Package::cvode_bdf:
      return std::make_unique<Cvode>(method, settings, callbacks, std::move(equations), t0, t_end, y0,
                                     context);
    case Package::erk:
      return std::make_unique<ErkStep>(method, settings, callbacks, t0, t_end, y0, context);
    case Package::dirk:
    case Package::imex:
      return std::make_unique<ArkStep>(method, settings, callbacks, std::move(equations), t0, t_end, y0,
                                       context);
    case Package::mri:
      return std::make_unique<MriStep>(method, settings, callbacks, t0, t_end, y0, context);
  }
  throw std::logic_error("no such package of SUNDIALS");
}

/// A context must not be shared between threads: each has its own, which is freed when the thread ends.
SUNContext this_context() {
  struct Context {
    SUNContext context = nullptr;
    // No MPI communicator: vectors are serial.
    Context() { check(SUNContext_Create(nullptr, &context), "a context"); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context() { SUNContext_Free(&context); }
  };
  thread_local const Context mine;
  return mine.context;
}

/// Flags that no case lists give step_too_small. The words are literals, so they outlive the run.
/// @param flag  < 0, as step() returned it
Failure failure_of(int flag) {
  // CVODE and ARKODE number the failures of a run alike down to -11, and ARK_TOO_CLOSE too.
  // ARK_INNERSTEP_FAIL is of MRIStep alone: its fast steps are explicit and fixed, so only f can fail there.
  switch (flag) {
    case ARK_TOO_MUCH_WORK:
      return {Outcome::too_many_steps, "SUNDIALS reports that it took too many steps"};
    case ARK_TOO_MUCH_ACC:
      return {Outcome::step_too_small,
              "SUNDIALS reports that the tolerances ask for more than the rounding gives"};
    case ARK_ERR_FAILURE:
      return {Outcome::step_too_small, "SUNDIALS reports that the error test fails however short the step"};
    case ARK_CONV_FAILURE:
      return {Outcome::newton_failed, "SUNDIALS reports that its iteration does not converge"};
    case ARK_LINIT_FAIL:
    case ARK_LSETUP_FAIL:
    case ARK_LSOLVE_FAIL:
      return {Outcome::newton_failed, "SUNDIALS reports that the linear equations cannot be solved"};
    case ARK_RHSFUNC_FAIL:
    case ARK_FIRST_RHSFUNC_ERR:
    case ARK_REPTD_RHSFUNC_ERR:
    case ARK_UNREC_RHSFUNC_ERR:
    case ARK_INNERSTEP_FAIL:
      return {Outcome::diverged, "SUNDIALS reports that the derivative is not finite however short the step"};
    case ARK_TOO_CLOSE:
      return {Outcome::step_too_small, "SUNDIALS reports that the end is too close to the start"};
    default:
      return {Outcome::step_too_small, "SUNDIALS gives up for another reason"};
  }
}

}  // namespace hmax::sundials
