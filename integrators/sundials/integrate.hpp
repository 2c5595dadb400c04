/// A run of CVODE or ARKODE on a system of the house, with the observers of the house.
#pragma once

#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>

#include "core/process/leaving.hpp"
#include "integrators/implicit/jacobian.hpp"
#include "integrators/implicit/stiff_part.hpp"
#include "integrators/integrate.hpp"
#include "integrators/sundials/solver.hpp"

namespace hmax::sundials {

namespace detail {

/// An accepted step as observers see it; what lies inside comes from the dense output of the library.
template <class State>
class View : public StepEnds<State> {
 public:
  /// @param inside  work vector for the states between t0 and t1
  View(Solver& solver, double t0, double t1, const State& y0, const State& y1, N_Vector inside)
      : StepEnds<State>(t0, t1, t1 - t0, y0, y1), solver_(solver), inside_(inside) {}

  /// out = y(t), t in [t0, t1], by the library; at t1 the state itself. Only while the step is the last one:
  /// the library keeps no history of earlier steps.
  void at(double t, State& out) {
    if (t == this->t1()) return copy_state(this->y1(), out);
    solver_.interpolate(t, inside_);
    copy_state(state_of<State>(inside_), out);
  }

 private:
  Solver& solver_;
  N_Vector inside_;  ///< holds the interpolated state
};

/// The system behind the callbacks, to which it refers. The library is C: an exception of the system waits
/// here until the library has returned. Its address is their user data, so a binding must stay where it is.
template <System Sys>
class Binding {
 public:
  using State = typename Sys::State;
  using Matrix = equations_type<Sys>;
  using Shifted = with_scalar<Matrix, double>;

  /// @param split   the Jacobian is that of the declared stiff part
  /// @param update  frozen: every question for a new J after the first is answered with the one at hand
  Binding(const Sys& system, bool split, JacobianUpdate update)
      : system_(system), split_(split), update_(update) {
    source_.init(system);
  }

  /// The functions that the library calls, with this binding as their user data. They are C functions: no
  /// exception may pass through the library.
  Callbacks callbacks() {
    Callbacks calls;
    calls.rhs = call<Part::whole>;
    if constexpr (SplitSystem<Sys>) {
      calls.stiff = call<Part::stiff>;
      calls.nonstiff = call<Part::nonstiff>;
    }
    // Arguments: t, y, f(t, y), A, keep J, J is fresh, gamma, user data, three work vectors.
    calls.cvode_system = [](double t, N_Vector y, N_Vector, SUNMatrix A, booleantype keep, booleantype* fresh,
                            double gamma, void* self, N_Vector, N_Vector, N_Vector) {
      return of(self).write_system(t, state_of<State>(y), A, keep, *fresh, gamma);
    };
    // The same, with a mass matrix after A that is not used.
    calls.arkode_system = [](double t, N_Vector y, N_Vector, SUNMatrix A, SUNMatrix, booleantype keep,
                             booleantype* fresh, double gamma, void* self, N_Vector, N_Vector, N_Vector) {
      return of(self).write_system(t, state_of<State>(y), A, keep, *fresh, gamma);
    };
    calls.user = this;
    return calls;
  }

  /// The matrix and the solver of (I - gamma J) x = b: KLU for sparse Jacobians where it is wanted, ours
  /// otherwise. A matrix for KLU has the pattern of I - J at the start, with the diagonal.
  /// @param t, y  start of the run, shape (n);  @param klu  whether sparse equations go to KLU
  Equations equations(double t, const State& y, bool klu, SUNContext context) {
    if constexpr (hmax::detail::is_variant<Matrix>) {
      // Only the Jacobian itself says whether it is sparse. It serves as that of the start.
      evaluate(t, y);
      if (auto* sparse = std::get_if<Eigen::SparseMatrix<double>>(&J_); sparse != nullptr && klu) {
        set_shifted(*sparse, 1.0, shifted_);
        MatrixHandle matrix = make_klu_matrix(shifted_, context);
        const Vector like = make_vector<State>(y.size(), context);
        LinearSolverHandle solver = make_klu_solver(like.get(), matrix.get(), context);
        klu_ = true;
        return {std::move(matrix), std::move(solver)};
      }
    }
    return {make_matrix<Shifted>(context), make_linear_solver<State, Shifted>(context)};
  }

  /// Throws what the system has thrown in a callback, after the library has returned.
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  /// What a callback returns: 0; > 0, the library may try a shorter step; < 0, it gives up at once. The signs
  /// are what the library asks for, the numbers are ours.
  static constexpr int done = 0, try_shorter = 1, give_up = -1;

  /// The binding behind the user data of a callback.
  static Binding& of(void* self) { return *static_cast<Binding*>(self); }

  /// Which part of f = stiff + nonstiff; whole: f.
  enum class Part { whole, stiff, nonstiff };

  /// A right-hand side as the library calls it, dydt = f(t, y) or a part of it, shape (n). A result that is
  /// not finite asks for a shorter step.
  template <Part part>
  static int call(double t, N_Vector y, N_Vector dydt, void* self) {
    Binding& binding = of(self);
    // After an exception all further calls fail at once.
    if (binding.thrown_) return give_up;
    try {
      const State& in = state_of<State>(y);
      State& out = state_of<State>(dydt);
      if constexpr (part == Part::whole)
        binding.system_.rhs(t, in, out);
      else if constexpr (part == Part::stiff)
        binding.system_.rhs_stiff(t, in, out);
      else
        binding.system_.rhs_nonstiff(t, in, out);
      return is_bounded(out) ? done : try_shorter;
    } catch (...) {
      binding.thrown_ = std::current_exception();
      return give_up;
    }
  }

  /// J_ = df/dy at (t, y), or the Jacobian of the stiff part.
  /// @throws what the system throws
  void evaluate(double t, const State& y) {
    evaluated_ = true;
    if constexpr (SplitSystem<Sys>)
      if (split_) return source_.evaluate(StiffPart<Sys>(system_), t, y, J_);
    source_.evaluate(system_, t, y, J_);
  }

  /// A = I - gamma J, gamma = h times a coefficient of the method [units of t].
  /// @param keep   the library would use the Jacobian at hand again
  /// @param fresh  whether it got a new one: the library counts from there when J is due again
  /// @returns done, or give_up with the exception kept for rethrow()
  int write_system(double t, const State& y, SUNMatrix A, booleantype keep, booleantype& fresh,
                   double gamma) {
    try {
      // frozen: the first J serves the whole run. keep: the library is content with the J at hand.
      const bool frozen = update_.every == JacobianUpdate::frozen && evaluated_;
      fresh = !frozen && !keep ? SUNTRUE : SUNFALSE;
      if (fresh) evaluate(t, y);
      if constexpr (hmax::detail::is_variant<Matrix>) {
        if (klu_) {
          set_shifted(std::get<Eigen::SparseMatrix<double>>(J_), gamma, shifted_);
          copy_to_klu_matrix(shifted_, A);
          return done;
        }
      }
      // Ours: A = I - gamma J in the type of J.
      set_shifted(J_, gamma, matrix_of<Shifted>(A));
      return done;
    } catch (...) {
      thrown_ = std::current_exception();
      return give_up;
    }
  }

  const Sys& system_;
  /// Whether J is that of the stiff part alone.
  bool split_;
  JacobianUpdate update_;
  JacobianSource<State, Matrix> source_;
  /// J_ is kept between calls, since the library may ask for another gamma with the same Jacobian.
  Matrix J_;
  bool evaluated_ = false, klu_ = false;  ///< a J was evaluated; KLU solves
  Eigen::SparseMatrix<double> shifted_;   ///< I - gamma J for KLU
  std::exception_ptr thrown_;             ///< of a callback
};

/// Integrates over a piece of a run, of which nothing else is to be checked.
/// @param settings  with the longest step of the whole run
template <System Sys, class Observer>
RunEnd<double> integrate_piece(const Method& method, const Settings& settings, const Sys& system,
                               Span<double> span, typename Sys::State& y, Observer& observer,
                               std::int64_t max_steps) {
  using State = typename Sys::State;
  // next: memory of the library's state, which copies of y go through; inside: that of dense output.
  // Declared from what is used to what uses it: the solver is freed first, then vectors and binding.
  SUNContext context = this_context();
  Binding<Sys> binding(system, method.package == Package::imex, settings.jacobian);
  const Vector next = make_vector<State>(y.size(), context), inside = make_vector<State>(y.size(), context);
  State& y_next = state_of<State>(next.get());
  copy_state(y, y_next);
  Equations equations;
  if (solves_equations(method.package)) equations = binding.equations(span.t0, y, method.klu, context);
  const std::unique_ptr<Solver> solver = make_solver(
      method, settings, binding.callbacks(), std::move(equations), span.t0, span.t_end, next.get(), context);

  double t = span.t0;
  // y holds the last accepted state, at t; `at` is where the run ended or failed.
  auto finish = [&](Outcome outcome, double at, std::string_view note = {}) {
    RunEnd<double> end{outcome, at, solver->stats()};
    end.note = note;
    end.t_state = t;
    return end;
  };
  // A fixed run of N steps ends at t_end exactly, as FixedStep has it.
  const std::int64_t fixed_steps =
      settings.adaptive ? std::numeric_limits<std::int64_t>::max() : fixed_step_count(span, settings.h);
  for (std::int64_t steps = 1;; ++steps) {
    if (steps > max_steps) return finish(Outcome::too_many_steps, t);
    double t_next = t;
    const int flag = solver->step(span.t_end, next.get(), t_next);
    binding.rethrow();
    leave_when_asked();
    if (flag < 0) {
      const Failure failure = failure_of(flag);
      return finish(failure.outcome, t, failure.words);
    }
    // The library adds up its fixed steps: what rounding leaves after the last one is no step.
    if (steps == fixed_steps) t_next = span.t_end;
    if (!(t_next > t))
      return finish(Outcome::step_too_small, t, "SUNDIALS takes steps that no longer change the time");
    if (!admits(system, y_next)) return finish(Outcome::diverged, t_next);
    if constexpr (!std::is_same_v<Observer, ObserveNothing>) {
      View<State> view(*solver, t, t_next, y, y_next, inside.get());
      observer(view);
      if (view.stop()) {
        t = *view.stop();
        view.at(t, y);
        return finish(Outcome::stopped, t);
      }
    }
    copy_state(y_next, y);
    t = t_next;
    if (t >= span.t_end) return finish(Outcome::reached_end, t);
  }
}

/// The settings of a piece: the library chooses its first step, unless it is given or f says nothing at the
/// start.
template <System Sys>
Settings with_first_step(Settings settings, const Sys& system, Span<double> span,
                         const typename Sys::State& y) {
  if (settings.h_first > 0 || is_autonomous(system)) return settings;
  using State = typename Sys::State;
  const auto size = [&](const State& v) {
    const auto component = [&](Eigen::Index i) { return v[i]; };
    return std::sqrt(settings.atols.size() == 0
                         ? RmsNorm<double>{settings.rtol, settings.atol}.squared(y, y, component)
                         : ComponentRmsNorm<double>{settings.rtol, settings.atols}.squared(y, y, component));
  };
  State slope = y;
  system.rhs(span.t0, y, slope);
  const double length = span.t_end - span.t0;
  if (starts_at_rest(size(slope), length))
    settings.h_first = first_step_from_rest(system, span.t0, y, size, length, settings.h_max);
  return settings;
}

}  // namespace detail

/// Integrates y' = f(t, y) over `span`, as hmax::integrate does, by a method of SUNDIALS. Fixed steps are
/// those of ARKODE; CVODE always chooses its own. Chosen steps land on the breakpoints of the system, where
/// the library begins anew. Only forwards, with states of doubles.
/// @param method     of imex and mri the system must be a SplitSystem
/// @param y          initial state in, last bounded state out, shape (n)
/// @param observer   called as observer(View&) once for each accepted step, in order of time
/// @param max_steps  steps allowed, by our count
/// @throws what the system throws; std::invalid_argument backwards and for `atols` that are not one for each
///         component; std::runtime_error when the library refuses the settings
template <System Sys, class Observer>
RunEnd<double> integrate(const Method& method, Settings settings, const Sys& system, Span<double> span,
                         typename Sys::State& y, Observer&& observer, std::int64_t max_steps) {
  expect_forwards(span, "SUNDIALS");
  if (settings.adaptive && settings.atols.size() > 0) check_atol(settings.atols, y.size());
  if (!admits(system, y)) return {Outcome::diverged, span.t0, {}};
  if (span.t_end == span.t0) return {Outcome::reached_end, span.t0, {}};
  if (!settings.adaptive)
    return detail::integrate_piece(method, settings, system, span, y, observer, max_steps);
  settings.h_max = longest_step(settings.h_max, span.t_end - span.t0);
  return run_by_pieces(
      system, span, y, max_steps, [&](const Sys& of, Span<double> piece, std::int64_t attempts) {
        return detail::integrate_piece(method, detail::with_first_step(settings, of, piece, y), of, piece, y,
                                       observer, attempts);
      });
}

}  // namespace hmax::sundials
