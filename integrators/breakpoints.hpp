/// Runs of chosen steps on a right-hand side that jumps: one piece after the other, between the times of the
/// jumps.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <ranges>
#include <vector>

#include "integrators/run_end.hpp"
#include "integrators/state.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// A system that knows its breakpoints: times in the open interval (a, b), a < b, where f or one of its
/// derivatives jumps whatever the state, in increasing order.
/// It may also have confine(a, b), after which it evaluates f(t, y) at the time of [a, b] that is nearest to
/// t: a stage at a breakpoint then reads f on the side of its own piece. Without it a piece ends a few
/// roundings before the breakpoint, and the next begins as far behind it.
template <class S>
concept BreakpointSystem = System<S> && requires(const S& system) {
  { system.breakpoints(0.0, 1.0) } -> std::convertible_to<std::vector<double>>;
};

namespace detail {

/// The breakpoints inside of the span in the order of the run, without those that rounding cannot tell from
/// one another or from its ends.
template <BreakpointSystem Sys, class Real>
std::vector<Real> breakpoints_in(const Sys& system, Span<Real> span) {
  const double a = static_cast<double>(std::min(span.t0, span.t_end)),
               b = static_cast<double>(std::max(span.t0, span.t_end));
  std::vector<double> known = system.breakpoints(a, b);
  if (span.t_end < span.t0) std::ranges::reverse(known);
  const Real apart = 8 * rounding_of(span);
  std::vector<Real> times;
  for (const double time : known) {
    const auto t = static_cast<Real>(time);
    const Real before = times.empty() ? span.t0 : times.back();
    if (span.direction() * (t - before) > apart && span.direction() * (span.t_end - t) > apart)
      times.push_back(t);
  }
  return times;
}

/// Whether f(t, y) jumps at t: it changes by more than a thousandth of itself within some roundings of t.
template <System Sys, class State>
bool jumps_at(const Sys& system, real_of<State> t, const State& y) {
  using Real = real_of<State>;
  if (is_autonomous(system)) return false;
  const Real near =
      std::max(64 * std::numeric_limits<Real>::epsilon() * std::abs(t), std::numeric_limits<Real>::min());
  State before = y, after = y;
  system.rhs(t - near, y, before);
  system.rhs(t + near, y, after);
  const Real size = std::max(largest_component(before), largest_component(after));
  after -= before;
  return largest_component(after) > size / 1000;
}

/// The system on one piece, and the span of the piece.
template <System Sys, class Real>
struct Piece {
  Sys system;
  Span<Real> span;
};

/// @param at_start, at_end  whether these ends of the piece are breakpoints
template <System Sys, class Real>
Piece<Sys, Real> piece_of(const Sys& system, Span<Real> piece, Real margin, bool at_start, bool at_end) {
  const Real direction = piece.direction();
  const Real first = at_start ? piece.t0 + direction * margin : piece.t0;
  const Real last = at_end ? piece.t_end - direction * margin : piece.t_end;
  if constexpr (requires(Sys & confined) { confined.confine(first, last); }) {
    constexpr Real infinity = std::numeric_limits<Real>::infinity();
    const Real from = at_start ? first : -direction * infinity, to = at_end ? last : direction * infinity;
    Piece<Sys, Real> made{system, piece};
    made.system.confine(std::min(from, to), std::max(from, to));
    return made;
  } else {
    return {system, {first, last}};
  }
}

/// The pieces of a span, each confined to its side of the breakpoints at its ends.
/// @param breaks  in the order of the span, inside of it; none: one piece, not confined
template <System Sys, class Real>
std::vector<Piece<Sys, Real>> pieces_of(const Sys& system, Span<Real> span, const std::vector<Real>& breaks) {
  const Real margin = rounding_of(span);
  std::vector<Piece<Sys, Real>> pieces;
  for (std::size_t i = 0; i <= breaks.size(); ++i) {
    const bool first = i == 0, last = i == breaks.size();
    const Span<Real> between{first ? span.t0 : breaks[i - 1], last ? span.t_end : breaks[i]};
    pieces.push_back(piece_of(system, between, margin, !first, !last));
  }
  return pieces;
}

}  // namespace detail

/// A run of chosen steps over `span`, one piece after the other between the breakpoints that the system
/// knows: steps land on them, and a method begins anew there, since what it remembers is of another function.
/// A run that fails at a time where f jumps, which the system does not know, says so.
/// @param y          as the pieces leave it
/// @param max_steps  attempts allowed, of all pieces together
/// @param run        run(system, span, max_steps) -> RunEnd<Real> integrates y over one piece
template <System Sys, class Run>
RunEnd<real_of<typename Sys::State>> run_by_pieces(const Sys& system, Span<real_of<typename Sys::State>> span,
                                                   const typename Sys::State& y, std::int64_t max_steps,
                                                   const Run& run) {
  using Real = real_of<typename Sys::State>;
  const auto with_note = [&](RunEnd<Real> end) {
    if (end.outcome == Outcome::step_too_small || end.outcome == Outcome::newton_failed)
      if (end.t != span.t_end && detail::jumps_at(system, end.t, y)) end.note = jump_note;
    return end;
  };
  std::vector<Real> breaks;
  if constexpr (BreakpointSystem<Sys>) breaks = detail::breakpoints_in(system, span);
  if (breaks.empty()) return with_note(run(system, span, max_steps));
  RunEnd<Real> end{Outcome::reached_end, span.t0, {}};
  Stats stats;
  for (const auto& piece : detail::pieces_of(system, span, breaks)) {
    end = run(piece.system, piece.span, max_steps - stats.steps - stats.rejected);
    stats += end.stats;
    end.stats = stats;
    if (end.outcome != Outcome::reached_end) return with_note(end);
  }
  return end;
}

}  // namespace hmax
