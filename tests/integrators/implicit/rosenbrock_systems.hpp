/// What the tests of Rosenbrock methods share: the methods as test types, and systems that know their
/// derivatives.
#pragma once

#include <cmath>

#include "integrators/implicit/rosenbrock.hpp"
#include "integrators/implicit/rosenbrock_tableaux.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {

using EveryRosenbrock = TestTypesOf<tableaux::AllRosenbrock>::type;

/// y' = lambda y, in every component with a factor of its own, with its Jacobian.
template <class StateT>
struct DecayWithJacobian : Decay<StateT> {
  static constexpr bool autonomous = true;
  void jacobian(real_of<StateT>, const StateT& y, jacobian_of<StateT>& J) const {
    J.setZero(y.size(), y.size());
    J.diagonal() = this->lambda;
  }
};

/// The damped, driven pendulum with its derivatives; `wrong` multiplies the Jacobian it tells.
template <class StateT>
struct ToldPendulum : Pendulum<StateT> {
  using Real = real_of<StateT>;
  Real wrong = 1;
  void jacobian(Real, const StateT& y, jacobian_of<StateT>& J) const {
    J.resize(2, 2);
    J << 0, 1, -std::cos(y[0]), Real(-1) / 10;
    J *= wrong;
  }
  void time_derivative(Real t, const StateT&, StateT& dfdt) const {
    dfdt.resize(2);
    dfdt << 0, -3 * std::sin(3 * t);
  }
};

}  // namespace hmax
