/// Guests of the loop: sampling, events, and several of them in one run. They read accepted steps and never
/// change them.
#pragma once

#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "integrators/integrate.hpp"

namespace hmax {

/// Calls sink(t, y) for t0 and for every multiple of the interval up to t_end, and at t_end, read off the
/// dense output. Sample times are t0 + j interval, computed; backwards t0 - j interval.
template <class State, class Sink>
class SampleEvery {
 public:
  using Real = real_of<State>;
  /// Calls sink(t0, y0) at once.
  /// @param interval  > 0; its sign is taken from the span
  /// @param sink      callable sink(t, y), y of shape (n); y is valid during the call only
  SampleEvery(Span<Real> span, Real interval, const State& y0, Sink sink)
      : span_(span),
        interval_(span.t_end < span.t0 ? -std::abs(interval) : interval),
        count_(fixed_step_count(span, interval_)),
        sample_(y0),
        sink_(std::move(sink)) {
    sink_(span.t0, y0);
  }

  /// Samples of one step: those in (t0, t1], or up to the stop that an observer before has requested.
  template <class View>
  void operator()(View& view) {
    for (; j_ <= count_; ++j_) {
      const Real t = j_ == count_ ? span_.t_end : span_.t0 + static_cast<Real>(j_) * interval_;
      if (span_.direction() * (t - view.t_end()) > 0) return;
      view.at(t, sample_);
      sink_(t, sample_);
    }
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) { visit(j_); }

 private:
  Span<Real> span_;
  Real interval_;               ///< signed
  std::int64_t count_, j_ = 1;  ///< number of samples after t0, and the next one
  State sample_;
  Sink sink_;
};

/// Which sign changes of an event function count, in the order of the run.
/// rising: g < 0 before and g >= 0 after the step. falling: g > 0 before and g <= 0 after it.
enum class Crossing { rising, falling, any };

/// A located event.
template <class State>
struct Event {
  real_of<State> t;
  State y;  ///< by dense output at t, shape (n)
};

/// Records the zeros of g(t, y) along the dense output; a terminal event ends the run there.
/// One sign change a step is seen, as in every solver that looks at step ends; the zero is located by
/// bisection to the resolution of t.
/// @param g  callable g(t, y) -> real
template <class State, class G>
class EventFinder {
 public:
  using Real = real_of<State>;
  /// @param terminal  whether the first event ends the run
  /// @param found     events are appended in the order of the run; must outlive the run
  EventFinder(G g, Crossing crossing, bool terminal, std::vector<Event<State>>& found)
      : g_(std::move(g)), crossing_(crossing), terminal_(terminal), found_(found) {}

  /// Looks for a sign change of g between the ends of the step, and for its place by bisection.
  template <class View>
  void operator()(View& view) {
    const Real g0 = g_(view.t0(), view.y0()), g1 = end_value(view);
    // A zero at the end of the step counts, one at its start belongs to the step before.
    const bool rises = g0 < 0 && g1 >= 0, falls = g0 > 0 && g1 <= 0;
    if (!(rises && crossing_ != Crossing::falling) && !(falls && crossing_ != Crossing::rising)) return;
    Real before = view.t0(), after = view.t_end();
    State y = view.y1();
    // [before, after] always brackets the zero; it ends when no number lies between them.
    for (;;) {
      const Real middle = before + (after - before) / 2;
      if (middle == before || middle == after) break;
      view.at(middle, y);
      const Real g = g_(middle, y);
      if (rises ? g < 0 : g > 0)
        before = middle;
      else
        after = middle;
    }
    view.at(after, y);
    found_.push_back({after, y});
    if (terminal_) view.stop_at(after);
  }

 private:
  /// g where the step ends, or where an observer before this one has ended the run.
  template <class View>
  Real end_value(View& view) {
    if (!view.stop()) return g_(view.t1(), view.y1());
    State y = view.y1();
    view.at(view.t_end(), y);
    return g_(view.t_end(), y);
  }

  G g_;
  Crossing crossing_;
  bool terminal_;
  std::vector<Event<State>>& found_;
};

/// Several observers as one, called in their order for each step. One made by observe() refers to those that
/// have a name and owns the others.
/// @tparam Observers  lvalue references for observers that have a name, values for the others
template <class... Observers>
class ObserverList {
 public:
  explicit ObserverList(Observers&&... observers) : observers_(std::forward<Observers>(observers)...) {}

  /// Shows the step to each observer in turn.
  template <class View>
  void operator()(View& view) {
    std::apply([&](auto&... observer) { (observer(view), ...); }, observers_);
  }

 private:
  std::tuple<Observers...> observers_;
};

/// integrate(..., observe(contact, samples)): any number of observers in one run. Each sees every step and
/// may ask for dense output. Each may end the run, and the earliest stop counts: samples and events beyond a
/// stop that an observer before them has requested are left out, so those that may end the run are named
/// first.
template <class... Observers>
requires(sizeof...(Observers) > 0) ObserverList<Observers...> observe(Observers&&... observers) {
  return ObserverList<Observers...>(std::forward<Observers>(observers)...);
}

}  // namespace hmax
