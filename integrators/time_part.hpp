/// The part of f that depends on time alone, kept from one evaluation to the next.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "integrators/system.hpp"

namespace hmax {

/// Evaluates f(t, y) and keeps g(t) of a TimeSplitSystem whose g is one number: methods that evaluate f twice
/// at the end of a step compute g once. Times that agree up to rounding are the same time, since fixed steps
/// compute t0 + n h where the step before ended at t + h.
template <class Real>
class TimePart {
 public:
  /// dydt = f(t, y); g(t) is evaluated only where t differs by more than 4 eps |t| from the time before.
  template <System Sys>
  void rhs(const Sys& system, Real t, const typename Sys::State& y, typename Sys::State& dydt) {
    if constexpr (is_kept<Sys>()) {
      if (!(std::abs(t - t_) <= 4 * std::numeric_limits<Real>::epsilon() * std::abs(t))) {
        part_ = system.at(t);
        t_ = t;
      }
      system.rhs_at(part_, y, dydt);
    } else {
      system.rhs(t, y, dydt);
    }
  }
  /// For a new run: the next evaluation computes g.
  void forget() { t_ = std::numeric_limits<Real>::quiet_NaN(); }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) { visit(t_, part_); }

 private:
  /// Whether g of the system is one number of the type Real.
  template <class Sys>
  static constexpr bool is_kept() {
    if constexpr (TimeSplitSystem<Sys>)
      return std::is_same_v<decltype(std::declval<const Sys&>().at(Real{})), Real>;
    else
      return false;
  }

  Real t_ = std::numeric_limits<Real>::quiet_NaN(), part_{};  ///< time of part_, NaN: none; g at that time
};

}  // namespace hmax
