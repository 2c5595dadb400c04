/// Explicit Runge-Kutta methods bound to the systems of the catalogue. Each system has a source of its own,
/// because every method is compiled anew for every type of system.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>

#include "catalogue/methods/bind.hpp"
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"

namespace hmax {

/// Binds method number `method` of tableaux::All.
/// @param y0  shape (dim)
template <System Sys>
Runner bind_explicit_rk(std::size_t method, const Sys& system, const Eigen::VectorXd& y0);

/// Binds a tableau read at run time.
template <System Sys>
Runner bind_explicit_rk(const RuntimeTableau& tableau, const Sys& system, const Eigen::VectorXd& y0);

/// Order of the local error estimate of a tableau read at run time; 0 without one.
inline int error_order_of(const RuntimeTableau& tableau) {
  return tableau.has_error() ? std::min(tableau.computed_order, tableau.embedded_order) + 1 : 0;
}

/// The same in long double, for the order of a method.
decltype(Runner::end_state_extended) extend_explicit_rk(std::size_t method, const Problem& problem);
decltype(Runner::end_state_extended) extend_explicit_rk(const RuntimeTableau& tableau,
                                                        const Problem& problem);

namespace detail {
template <class Coefficients, System Sys>
Runner bind_coefficients(const Coefficients& coefficients, int error_order, const Sys& system,
                         const Eigen::VectorXd& y0) {
  using StepperT = ExplicitRk<Coefficients, typename Sys::State>;
  return make_runner(StepperEngine<StepperT>{StepperT(coefficients), error_order}, system,
                     typename Sys::State(y0));
}
}  // namespace detail

template <System Sys>
Runner bind_explicit_rk(std::size_t method, const Sys& system, const Eigen::VectorXd& y0) {
  return [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    using Bind = Runner (*)(const Sys&, const Eigen::VectorXd&);
    constexpr std::array<Bind, sizeof...(T)> table{[](const Sys& s, const Eigen::VectorXd& y) {
      return detail::bind_coefficients(StaticCoefficients<T>{}, T::error_order, s, y);
    }...};
    return table.at(method)(system, y0);
  }(std::type_identity<tableaux::All>{});
}

template <System Sys>
Runner bind_explicit_rk(const RuntimeTableau& tableau, const Sys& system, const Eigen::VectorXd& y0) {
  return detail::bind_coefficients(tableau, error_order_of(tableau), system, y0);
}

extern template Runner bind_explicit_rk(std::size_t, const Oscillator&, const Eigen::VectorXd&);
extern template Runner bind_explicit_rk(const RuntimeTableau&, const Oscillator&, const Eigen::VectorXd&);
extern template Runner bind_explicit_rk(std::size_t, const AnySystem&, const Eigen::VectorXd&);
extern template Runner bind_explicit_rk(const RuntimeTableau&, const AnySystem&, const Eigen::VectorXd&);

}  // namespace hmax
