/// f with its time held fast, for methods that evaluate it there again and again.
#pragma once

#include <utility>

#include "integrators/system.hpp"

namespace hmax {

/// f at one time, for all iterations of a stage: what depends on time alone is evaluated once. It refers to
/// the system.
template <System Sys>
class SlopeAt {
  using State = typename Sys::State;
  using Real = real_of<State>;

 public:
  /// @param t  the time of the stage, t_n + c_i h
  SlopeAt(const Sys& system, Real t) : system_(system), t_(part(system, t)) {}
  /// dydt = f(t, y).
  void operator()(const State& y, State& dydt) const {
    if constexpr (TimeSplitSystem<Sys>)
      system_.rhs_at(t_, y, dydt);
    else
      system_.rhs(t_, y, dydt);
  }

 private:
  /// g(t) of a system that splits it off, else t itself.
  static auto part(const Sys& system, Real t) {
    if constexpr (TimeSplitSystem<Sys>)
      return system.at(t);
    else
      return t;
  }
  const Sys& system_;
  /// g(t) or t.
  decltype(part(std::declval<const Sys&>(), Real{})) t_;
};

}  // namespace hmax
