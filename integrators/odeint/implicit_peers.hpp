/// The implicit steppers of Boost.Odeint in the form that integrators/odeint/integrate.hpp drives.
#pragma once

#include <variant>
#include <vector>

#include "integrators/implicit/jacobian.hpp"
#include "integrators/odeint/implicit_steppers.hpp"

namespace hmax::odeint {

namespace detail {

/// A system with its derivatives as plain functions on arrays, for sources that do not know its type.
/// calls() hands out its address, so it is neither copied nor moved.
template <System Sys>
class Derivatives {
 public:
  using State = typename Sys::State;
  using Real = real_of<State>;

  /// Prepares differences where the system has no Jacobian.
  explicit Derivatives(const Sys& system) : system_(system) {
    source_.init(system);
    for (State* v : {&y_, &f_, &out_}) v->resize(system.dim());
  }
  Derivatives(const Derivatives&) = delete;
  Derivatives& operator=(const Derivatives&) = delete;

  /// Valid as long as this object. Exceptions of the system pass through: the steppers are C++.
  SystemCalls<Real> calls() {
    return {this, [](void* self, Real t, const Real* y, Real* dydt) { of(self).rhs(t, y, dydt); },
            [](void* self, Real t, const Real* y, Real* J) { of(self).jacobian(t, y, J); },
            [](void* self, Real t, const Real* y, Real* dfdt) { of(self).time_derivative(t, y, dfdt); }};
  }
  /// The step that is tried, which differences in time are taken in.
  void set_step(Real h) { h_ = h; }

 private:
  using Matrix = jacobian_type<Sys>;
  using RowMajor = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// The object behind `system` of SystemCalls.
  static Derivatives& of(void* self) { return *static_cast<Derivatives*>(self); }
  /// y_ = y, shape (n).
  void read(const Real* y) { y_ = Eigen::Map<const State>(y, y_.size()); }

  /// dydt = f(t, y), shape (n).
  void rhs(Real t, const Real* y, Real* dydt) {
    read(y);
    system_.rhs(t, y_, out_);
    Eigen::Map<State>(dydt, out_.size()) = out_;
  }
  /// J = df/dy, dense and row by row, shape (n, n), of the system or by differences.
  void jacobian(Real t, const Real* y, Real* J) {
    read(y);
    source_.evaluate(system_, t, y_, J_);
    // Row by row, as uBLAS stores matrices.
    Eigen::Map<RowMajor> out(J, y_.size(), y_.size());
    if constexpr (hmax::detail::is_variant<Matrix>)
      std::visit([&](const auto& held) { out = held; }, J_);
    else
      out = J_;
  }
  /// dfdt = partial f / partial t, shape (n). Differences need f(t, y), which is evaluated only then.
  void time_derivative(Real t, const Real* y, Real* dfdt) {
    read(y);
    f_.setZero();
    if (!is_autonomous(system_) && !has_time_derivative(system_)) system_.rhs(t, y_, f_);
    evaluate_time_derivative(system_, t, h_, y_, f_, out_);
    Eigen::Map<State>(dfdt, out_.size()) = out_;
  }

  /// Must outlive this object.
  const Sys& system_;
  JacobianSource<State, Matrix> source_;
  Matrix J_;
  /// y, f(t, y) and results, shape (n).
  State y_, f_, out_;
  Real h_ = 0;  ///< see set_step()
};

}  // namespace detail

/// The Rosenbrock method of order 4, RODAS [hairer1996solving], at fixed steps or with Odeint's step
/// control. Linear equations are dense: n^2 numbers, and of the order of n^3 operations a step.
template <System Sys>
class Rosenbrock4Peer {
 public:
  using Real = real_of<typename Sys::State>;
  using Values = std::vector<Real>;

  /// @param system      must outlive the peer
  /// @param rtol, atol  of Odeint's controller
  Rosenbrock4Peer(const Sys& system, Real rtol, Real atol)
      : derivatives_(system),
        stepper_(derivatives_.calls(), static_cast<std::size_t>(system.dim()), rtol, atol) {}
  /// At fixed steps no tolerance matters.
  explicit Rosenbrock4Peer(const Sys& system) : Rosenbrock4Peer(system, 1, 1) {}

  /// @param h  the step to try in, the next one out
  /// @returns whether y_new at t + h is accepted
  /// @throws NotSolved  where the Jacobian is not finite
  bool try_step(const Values& y, Real t, Values& y_new, Real& h) {
    derivatives_.set_step(h);
    return stepper_.try_step(y.data(), t, y_new.data(), h);
  }
  /// y_new at t + h, without a test of its error.
  void step(const Values& y, Real t, Values& y_new, Real h) {
    derivatives_.set_step(h);
    stepper_.step(y.data(), t, y_new.data(), h);
  }
  /// out = y(t), t in (t0, t1), by the method's dense output of the step from t0 to t1, the last one that was
  /// tried.
  void inside(const Values& y0, Real t0, const Values& y1, Real t1, Real t, Values& out) {
    stepper_.inside(y0.data(), t0, y1.data(), t1, t, out.data());
  }

 private:
  detail::Derivatives<Sys> derivatives_;
  Rosenbrock4<Real> stepper_;
};

/// Implicit Euler at fixed steps, y_new = y + h f(t + h, y_new), by Newton's method with the Jacobian at (t
/// + h, y). It has no dense output: inside a step it takes a step to the time that is asked for.
template <System Sys>
class ImplicitEulerPeer {
 public:
  using Real = real_of<typename Sys::State>;
  using Values = std::vector<Real>;

  /// @param system  must outlive the peer
  explicit ImplicitEulerPeer(const Sys& system)
      : derivatives_(system), stepper_(derivatives_.calls(), static_cast<std::size_t>(system.dim())) {}

  /// @throws NotSolved  where Newton's method meets a singular matrix or takes more than most_iterations
  void step(const Values& y, Real t, Values& y_new, Real h) { stepper_.step(y.data(), t, y_new.data(), h); }
  /// out = y(t) by one step of size t - t0 from y0.
  /// @throws NotSolved  as step()
  void inside(const Values& y0, Real t0, const Values&, Real, Real t, Values& out) {
    stepper_.step(y0.data(), t0, out.data(), t - t0);
  }

 private:
  detail::Derivatives<Sys> derivatives_;
  ImplicitEuler<Real> stepper_;
};

}  // namespace hmax::odeint
