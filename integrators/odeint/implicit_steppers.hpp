/// The implicit steppers of Boost.Odeint behind plain pointers. They compute in uBLAS, which as of Boost 1.74
/// does not compile as C++20: their source is C++17, and this header is read by both.
#pragma once

#include <cstddef>
#include <memory>
#include <stdexcept>

namespace hmax::odeint {

/// A system as the steppers call it; `system` is handed to each function. Arrays have shape (n), J has shape
/// (n, n) row by row.
template <class Real>
struct SystemCalls {
  void* system;                                                              ///< not owned
  void (*rhs)(void* system, Real t, const Real* y, Real* dydt);              ///< dydt = f(t, y)
  void (*jacobian)(void* system, Real t, const Real* y, Real* J);            ///< J_ij = d f_i / d y_j
  void (*time_derivative)(void* system, Real t, const Real* y, Real* dfdt);  ///< df/dt
};

/// A stage equation that a stepper of Odeint would not have solved.
struct NotSolved : std::runtime_error {
  NotSolved() : std::runtime_error("Odeint does not solve the stage equation") {}
};

/// The Rosenbrock method of order 4, RODAS, with Odeint's own step control and dense output. In Boost 1.74
/// its coefficient d_4 has the wrong sign, which makes it a method of order 1 wherever f depends on time;
/// here it has the published one [hairer1996solving].
template <class Real>
class Rosenbrock4 {
 public:
  /// @param n           dimension
  /// @param rtol, atol  of the step control; step() does not use them
  Rosenbrock4(const SystemCalls<Real>& calls, std::size_t n, Real rtol, Real atol);
  ~Rosenbrock4();

  /// One attempt from y at t.
  /// @param h  the step to try in, the next one out
  /// @returns whether y_new at t + h stands
  bool try_step(const Real* y, Real t, Real* y_new, Real& h);
  /// One step from y at t to y_new at t + h, without a test of its error.
  void step(const Real* y, Real t, Real* y_new, Real h);
  /// out = y(t) inside the last step, which led from y0 at t0 to y1 at t1.
  void inside(const Real* y0, Real t0, const Real* y1, Real t1, Real t, Real* out);

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

/// Implicit Euler. Two things of Boost 1.74 are to be known: on a singular matrix it ends the process with
/// std::exit(0), and from the second iteration on it factors the matrix that it has factored already. So each
/// factorisation is rehearsed on a copy, which throws NotSolved instead, and iterations are limited: where
/// they should converge they converge slowly, and where they do not Odeint would go on for ever.
template <class Real>
class ImplicitEuler {
 public:
  /// The iteration ends when its increment is below this in the 2-norm, in the units of the state.
  static constexpr double tolerance = 1e-13;
  static constexpr int most_iterations = 100;  ///< of one step

  /// @param n  dimension
  ImplicitEuler(const SystemCalls<Real>& calls, std::size_t n);
  ~ImplicitEuler();

  /// @throws NotSolved
  void step(const Real* y, Real t, Real* y_new, Real h);

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace hmax::odeint
