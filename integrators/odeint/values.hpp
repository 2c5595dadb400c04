/// Systems of the house as Boost.Odeint calls them, on its own types of state.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "integrators/system.hpp"

namespace hmax::odeint {

namespace detail {
/// std::array where the size is fixed, else std::vector: numbers in the order of the state, shape (n).
template <class State, int n = State::RowsAtCompileTime>
struct ValuesOf {
  using type = std::array<typename State::Scalar, n>;
};
template <class State>
struct ValuesOf<State, Eigen::Dynamic> {
  using type = std::vector<typename State::Scalar>;
};
}  // namespace detail

/// What Odeint's documentation steps: std::array for a few numbers, std::vector for many.
template <class State>
using values_of = typename detail::ValuesOf<State>::type;

/// values = y, resized where that is possible.
template <class State, class Values>
void to_values(const State& y, Values& values) {
  if constexpr (requires { values.resize(std::size_t{}); }) values.resize(static_cast<std::size_t>(y.size()));
  std::copy(y.data(), y.data() + y.size(), values.begin());
}

/// y = values; y has their size already.
template <class Values, class State>
void to_state(const Values& values, State& y) {
  std::copy(values.begin(), values.end(), y.data());
}

/// f(t, y) in Odeint's order of arguments, f(y, dydt, t). States of fixed size pass through registers;
/// those of dynamic size are copied both ways, which Odeint's choice of std::vector costs.
template <System Sys>
class Rhs {
 public:
  using State = typename Sys::State;
  using Real = real_of<State>;

  /// @param system  must outlive this function; Odeint copies it, and copies share the system
  explicit Rhs(const Sys& system) : system_(&system) {
    in_.resize(system.dim());
    out_.resize(system.dim());
  }

  /// dydt = f(t, y); of dynamic size it gets the size of the system.
  template <class Values>
  void operator()(const Values& y, Values& dydt, Real t) {
    if constexpr (State::RowsAtCompileTime == Eigen::Dynamic) {
      to_state(y, in_);
      system_->rhs(t, in_, out_);
      to_values(out_, dydt);
    } else {
      State in, out;
      to_state(y, in);
      system_->rhs(t, in, out);
      to_values(out, dydt);
    }
  }

 private:
  /// Not owned.
  const Sys* system_;
  State in_, out_;  ///< of dynamic size: the copies of y and dydt, shape (n)
};

}  // namespace hmax::odeint
