/// The implicit steppers of Boost.Odeint in the form that integrators/odeint/integrate.hpp drives.
#pragma once

#include <variant>
#include <vector>

#include "integrators/implicit/jacobian.hpp"
#include "integrators/odeint/implicit_steppers.hpp"

namespace hmax::odeint {

namespace detail {

/// A system with its derivatives as plain functions on arrays.
template <System Sys>
class Derivatives {
 public:
  using State = typename Sys::State;
  using Real = real_of<State>;

  explicit Derivatives(const Sys& system) : system_(system) {
    source_.init(system);
    for (State* v : {&y_, &f_, &out_}) v->resize(system.dim());
  }
  Derivatives(const Derivatives&) = delete;
  Derivatives& operator=(const Derivatives&) = delete;

  SystemCalls<Real> calls() {
    return {this, [](void* self, Real t, const Real* y, Real* dydt) { of(self).rhs(t, y, dydt); },
            [](void* self, Real t, const Real* y, Real* J) { of(self).jacobian(t, y, J); },
            [](void* self, Real t, const Real* y, Real* dfdt) { of(self).time_derivative(t, y, dfdt); }};
  }

 private:
  using Matrix = jacobian_type<Sys>;
  using RowMajor = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  static Derivatives& of(void* self) { return *static_cast<Derivatives*>(self); }
  void read(const Real* y) { y_ = Eigen::Map<const State>(y, y_.size()); }

  void rhs(Real t, const Real* y, Real* dydt) {
    read(y);
    system_.rhs(t, y_, out_);
    Eigen::Map<State>(dydt, out_.size()) = out_;
  }
  void jacobian(Real t, const Real* y, Real* J) {
    read(y);
    source_.evaluate(system_, t, y_, J_);
    Eigen::Map<RowMajor> out(J, y_.size(), y_.size());
    if constexpr (hmax::detail::is_variant<Matrix>)
      std::visit([&](const auto& held) { out = held; }, J_);
    else
      out = J_;
  }
  void time_derivative(Real t, const Real* y, Real* dfdt) {
    read(y);
    f_.setZero();
    if (!is_autonomous(system_) && !has_time_derivative(system_)) system_.rhs(t, y_, f_);
    evaluate_time_derivative(system_, t, y_, f_, out_);
    Eigen::Map<State>(dfdt, out_.size()) = out_;
  }

  const Sys& system_;
  JacobianSource<State, Matrix> source_;
  Matrix J_;
  State y_, f_, out_;
};

}  // namespace detail

/// The Rosenbrock method of order 4, at fixed steps or with Odeint's step control.
template <System Sys>
class Rosenbrock4Peer {
 public:
  using Real = real_of<typename Sys::State>;
  using Values = std::vector<Real>;

  Rosenbrock4Peer(const Sys& system, Real rtol, Real atol)
      : derivatives_(system),
        stepper_(derivatives_.calls(), static_cast<std::size_t>(system.dim()), rtol, atol) {}
  explicit Rosenbrock4Peer(const Sys& system) : Rosenbrock4Peer(system, 1, 1) {}

  bool try_step(const Values& y, Real t, Values& y_new, Real& h) {
    return stepper_.try_step(y.data(), t, y_new.data(), h);
  }
  void step(const Values& y, Real t, Values& y_new, Real h) { stepper_.step(y.data(), t, y_new.data(), h); }
  void inside(const Values& y0, Real t0, const Values& y1, Real t1, Real t, Values& out) {
    stepper_.inside(y0.data(), t0, y1.data(), t1, t, out.data());
  }

 private:
  detail::Derivatives<Sys> derivatives_;
  Rosenbrock4<Real> stepper_;
};

/// Implicit Euler at fixed steps; inside one, a step to the time that is asked for.
template <System Sys>
class ImplicitEulerPeer {
 public:
  using Real = real_of<typename Sys::State>;
  using Values = std::vector<Real>;

  explicit ImplicitEulerPeer(const Sys& system)
      : derivatives_(system), stepper_(derivatives_.calls(), static_cast<std::size_t>(system.dim())) {}

  void step(const Values& y, Real t, Values& y_new, Real h) { stepper_.step(y.data(), t, y_new.data(), h); }
  void inside(const Values& y0, Real t0, const Values&, Real, Real t, Values& out) {
    stepper_.step(y0.data(), t0, out.data(), t - t0);
  }

 private:
  detail::Derivatives<Sys> derivatives_;
  ImplicitEuler<Real> stepper_;
};

}  // namespace hmax::odeint
