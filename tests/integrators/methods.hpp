/// What the typed suites share: every explicit method as a test type, and small systems with known solutions.
#pragma once

#include <functional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include <gtest/gtest.h>

#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"

namespace hmax {

template <class Tuple>
struct TestTypesOf;
template <class... Methods>
struct TestTypesOf<std::tuple<Methods...>> {
  using type = testing::Types<Methods...>;
};

/// Every explicit method; a test of the suite is named Suite/rk4.Sentence.
using EveryMethod = TestTypesOf<tableaux::All>::type;
struct MethodId {
  template <class Method>
  static std::string GetName(int) {
    return std::string(Method::id);
  }
};

/// With and without the slope at the end as the next first stage, an error estimate, and stages of an
/// interpolant: for what the coefficients have no part in.
using OneOfEachKind = testing::Types<tableaux::ExplicitEuler, tableaux::Rk4, tableaux::BogackiShampine32,
                                     tableaux::DormandPrince54, tableaux::Fehlberg78, tableaux::Dop853>;

/// y' = lambda y, in every component with a factor of its own: y_i(t) = y_i(0) exp(lambda_i t).
template <class StateT>
struct Decay {
  using State = StateT;
  State lambda;  // shape (n)
  [[nodiscard]] Eigen::Index dim() const { return lambda.size(); }
  void rhs(real_of<State>, const State& y, State& dydt) const {
    for (Eigen::Index i = 0; i < y.size(); ++i) dydt[i] = lambda[i] * y[i];
  }
};

/// A pendulum with damping and a drive, nonlinear in y and in t: x' = v, v' = -sin x - v / 10 + cos(3 t).
template <class StateT>
struct Pendulum {
  using State = StateT;
  using Scalar = typename State::Scalar;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(real_of<State> t, const State& y, State& dydt) const {
    dydt[0] = y[1];
    dydt[1] = std::cos(3 * t) - std::sin(y[0]) - y[1] / Scalar(10);
  }
};

/// A function f(t, y, dydt) as a system of n equations. One type for all functions of a kind of state: a
/// method is compiled once for them.
template <class StateT>
struct SystemOf {
  using State = StateT;
  std::function<void(real_of<State> t, const State& y, State& dydt)> f;
  Eigen::Index n = State::RowsAtCompileTime;
  [[nodiscard]] Eigen::Index dim() const { return n; }
  void rhs(real_of<State> t, const State& y, State& dydt) const { f(t, y, dydt); }
};
template <class State, class F>
SystemOf<State> system_of(F f, Eigen::Index n = State::RowsAtCompileTime) {
  return {std::move(f), n};
}

/// x' = v, v' = -x: x = sin t, v = cos t from (0, 1).
template <class State>
const auto rotation = system_of<State>([](real_of<State>, const State& y, State& dydt) {
  dydt[0] = y[1];
  dydt[1] = -y[0];
});

/// Any system with what implicit methods ask of it, behind one type for each kind of state: a method is
/// compiled once for all of them.
template <class StateT>
class ErasedSystem {
 public:
  using State = StateT;
  using Real = real_of<State>;
  using Jacobian = jacobian_of<State>;

  template <class S>
  requires(!std::is_same_v<S, ErasedSystem>) explicit ErasedSystem(const S& system)
      : dim_(system.dim()),
        autonomous_(hmax::is_autonomous(system)),
        rhs_([system](Real t, const State& y, State& dydt) { system.rhs(t, y, dydt); }) {
    if constexpr (DifferentiableSystem<S>)
      jacobian_ = [system](Real t, const State& y, Jacobian& J) { system.jacobian(t, y, J); };
    if constexpr (TimeDifferentiableSystem<S>)
      time_derivative_ = [system](Real t, const State& y, State& dfdt) {
        system.time_derivative(t, y, dfdt);
      };
  }

  [[nodiscard]] Eigen::Index dim() const { return dim_; }
  [[nodiscard]] bool is_autonomous() const { return autonomous_; }
  void rhs(Real t, const State& y, State& dydt) const { rhs_(t, y, dydt); }
  [[nodiscard]] bool has_jacobian() const { return jacobian_ != nullptr; }
  void jacobian(Real t, const State& y, Jacobian& J) const { jacobian_(t, y, J); }
  [[nodiscard]] bool has_time_derivative() const { return time_derivative_ != nullptr; }
  void time_derivative(Real t, const State& y, State& dfdt) const { time_derivative_(t, y, dfdt); }

 private:
  Eigen::Index dim_;
  bool autonomous_;
  std::function<void(Real, const State&, State&)> rhs_, time_derivative_;
  std::function<void(Real, const State&, Jacobian&)> jacobian_;
};
template <class S>
ErasedSystem(const S&) -> ErasedSystem<typename S::State>;

/// A norm that shows one component of the error estimate as it is.
struct Component {
  Eigen::Index i;
  template <class State, class Error>
  real_of<State> squared(const State&, const State&, const Error& error) const {
    return Eigen::numext::abs2(error(i));
  }
};

/// One step of a run that begins at t with y, and what its stepper tells of it.
template <class StepperT, class System>
class FirstStep {
 public:
  using State = typename StepperT::State;
  using Real = real_of<State>;

  FirstStep(const System& system, Real t, const State& start, Real h)
      : y(start), y_new(start), system_(system), t_(t), h_(h) {
    stepper.init(system, t, y);
    status = stepper.attempt(system, t, y, h, y_new);
  }
  /// y(t + theta h)
  State at(Real theta) {
    State out = y;
    stepper.interpolate(system_, t_, h_, y, y_new, theta, out);
    return out;
  }
  template <class Norm>
  [[nodiscard]] Real error(const Norm& norm) const {
    return std::sqrt(stepper.error_squared(h_, y, y_new, norm));
  }

  StepperT stepper;
  State y, y_new;
  StepStatus status;

 private:
  const System& system_;
  Real t_, h_;
};
/// @param system  outlives the step
template <class StepperT, class System, class State>
FirstStep<StepperT, System> first_step(const System& system, real_of<State> t, const State& y,
                                       real_of<State> h) {
  return {system, t, y, h};
}

}  // namespace hmax
