/// Counting what a run did. The loop counts steps; this wrapper is the only place that counts evaluations.
#pragma once

#include <cstdint>

#include "integrators/system.hpp"

namespace hmax {

/// What a run did.
struct Stats {
  std::int64_t steps = 0;     ///< accepted steps
  std::int64_t rejected = 0;  ///< rejected attempts
  std::int64_t rhs = 0;       ///< evaluations of f; 0 unless the system was Counted
  std::int64_t jacobian = 0, factorisations = 0, newton = 0;  ///< of implicit methods
};

/// A system that counts the calls of its right-hand side into a counter owned by the caller.
template <System S>
class Counted {
 public:
  using State = typename S::State;
  Counted(const S& system, std::int64_t& rhs_count) : system_(system), rhs_count_(rhs_count) {}
  [[nodiscard]] Eigen::Index dim() const { return system_.dim(); }
  void rhs(real_of<State> t, const State& y, State& dydt) const {
    ++rhs_count_;
    system_.rhs(t, y, dydt);
  }
  auto at(real_of<State> t) const requires TimeSplitSystem<S> { return system_.at(t); }
  template <class TimePart>
  requires TimeSplitSystem<S>
  void rhs_at(const TimePart& part, const State& y, State& dydt) const {
    ++rhs_count_;
    system_.rhs_at(part, y, dydt);
  }

 private:
  const S& system_;
  std::int64_t& rhs_count_;
};

}  // namespace hmax
