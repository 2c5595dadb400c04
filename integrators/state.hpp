/// The arithmetic of states: weighted sums in one pass, copies, norms. The only place that knows how a state
/// is laid out.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>

#include "core/instructions/device_code.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// States of at most this many numbers are treated number by number. Eigen would move two doubles as one
/// packet, and a packet load right after two scalar stores (as in a right-hand side) waits for the store
/// buffer.
inline constexpr int max_scalar_states = 8;

/// Whether a state has a fixed size of at most max_scalar_states numbers.
template <class State>
inline constexpr bool is_small_state =
    State::SizeAtCompileTime != Eigen::Dynamic&& State::SizeAtCompileTime <= max_scalar_states;

namespace detail {
/// f(0), ..., f(N - 1), without a loop.
template <class F, std::size_t... D>
HMAX_DEVICE inline void unrolled(F&& f, std::index_sequence<D...>) {
  (f(static_cast<Eigen::Index>(D)), ...);
}
}  // namespace detail

/// Calls f(d) for each component of a small state, unrolled.
template <class State, class F>
requires is_small_state<State> HMAX_DEVICE inline void for_each_component(F&& f) {
  detail::unrolled(f, std::make_index_sequence<State::SizeAtCompileTime>{});
}

/// A state for a member that init() will size: zero where the size is fixed, since a stepper is copied into
/// its run and numbers without a value must not be.
/// @returns an empty vector where the size is not known, zeros where it is
template <class State>
inline State blank_state() {
  if constexpr (State::SizeAtCompileTime == Eigen::Dynamic)
    return State();
  else
    return State::Zero();
}

/// out = y.
template <class State>
inline void copy_state(const State& y, State& out) {
  if constexpr (is_small_state<State>)
    for_each_component<State>([&](Eigen::Index d) { out[d] = y[d]; });
  else
    out = y;
}

/// True when the squares of the components can still be summed: false for NaN, infinity and magnitudes beyond
/// the square root of the largest number.
template <class State>
HMAX_DEVICE inline bool is_bounded(const State& y) {
  using Real = real_of<State>;
  if constexpr (is_small_state<State>) {
    // One pass without a branch: any overflow or NaN reaches the sum.
    Real sum{0};
    for_each_component<State>([&](Eigen::Index d) { sum += Eigen::numext::abs2(y[d]); });
    return sum <= std::numeric_limits<Real>::max();
  } else {
    return y.squaredNorm() <= std::numeric_limits<Real>::max();
  }
}

/// Whether a solution of the system can be at y. A run that leaves what its system admits is
/// `diverged`: of concentrations that add up to one, of a body that would be a million times its size. A type
/// says so by `bool admits(const State& y) const`; others admit every bounded state.
template <System S>
constexpr bool admits(const S& system, const typename S::State& y) {
  if constexpr (requires { system.admits(y); })
    return is_bounded(y) && system.admits(y);
  else
    return is_bounded(y);
}

/// max |v_i|; NaN when there is one.
template <class State>
inline real_of<State> largest_component(const State& v) {
  real_of<State> most{0};
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    // A comparison would overlook NaN.
    const real_of<State> size = std::abs(v[i]);
    if (std::isnan(size)) return size;
    most = std::max(most, size);
  }
  return most;
}

/// A row of weights known at compile time: Row::size and constexpr Row::weight(j). Zero weights cost nothing.
template <class Row>
concept StaticRow = requires {
  { std::integral_constant<std::size_t, Row::size>::value } -> std::convertible_to<std::size_t>;
};

namespace detail {
/// The first j' >= j with a weight that is not zero.
template <StaticRow Row>
constexpr std::size_t next_weight(std::size_t j) {
  while (j < Row::size && Row::weight(j) == 0) ++j;
  return j;
}

/// left + sum_{j >= J} (h weight_j) term(j) as one expression, from left to right.
/// @tparam J  the first weight that is used; zero weights are skipped by the compiler
template <StaticRow Row, class Real, std::size_t J, class Term, class Left>
HMAX_DEVICE inline auto fold_weights(Real h, const Term& term, const Left& left) {
  if constexpr (J >= Row::size)
    return left;
  else
    return fold_weights<Row, Real, next_weight<Row>(J + 1)>(
        h, term, left + (h * static_cast<Real>(Row::weight(J))) * term(J));
}

/// sum_j (h weight_j) term(j) as one expression; the row has at least one weight that is not zero, else it
/// does not compile.
template <StaticRow Row, class Real, class Term>
HMAX_DEVICE inline auto weighted_sum(Real h, const Term& term) {
  constexpr std::size_t first = next_weight<Row>(0);
  static_assert(first < Row::size, "all weights are zero");
  return fold_weights<Row, Real, next_weight<Row>(first + 1)>(
      h, term, (h * static_cast<Real>(Row::weight(first))) * term(first));
}

/// Writes expression(access) into out, where access(v) is a component or the whole of a vector: number by
/// number for small states, one Eigen expression and one pass over memory for the others.
/// The expression may contain out: number i of the result depends on number i of each vector alone.
template <class State, class Expression>
inline void assign(State& out, const Expression& expression) {
  if constexpr (is_small_state<State>)
    for_each_component<State>(
        [&](Eigen::Index d) { out[d] = expression([d](const State& v) { return v[d]; }); });
  else
    out.noalias() = expression([](const State& v) -> const State& { return v; });
}
}  // namespace detail

/// The argument of a stage, out = y + h sum_j weight_j k_j; k[j] of shape (n). Summed from y onwards, so that
/// only one multiplication and one addition wait for the newest k; the rounding this costs enters the step
/// multiplied by h.
template <StaticRow Row, class State, class Stages>
inline void stage_argument(Row, const State& y, real_of<State> h, const Stages& k, State& out) {
  using Real = real_of<State>;
  if constexpr (detail::next_weight<Row>(0) >= Row::size)
    copy_state(y, out);
  else
    detail::assign(out, [&](auto access) {
      return detail::fold_weights<Row, Real, detail::next_weight<Row>(0)>(
          h, [&](std::size_t j) -> decltype(auto) { return access(k[j]); }, access(y));
    });
}

/// The end of a step, out = y + (h sum_j weight_j k_j). The small increment is summed first: this rounding
/// stays.
template <StaticRow Row, class State, class Stages>
inline void add_increment(Row, const State& y, real_of<State> h, const Stages& k, State& out) {
  using Real = real_of<State>;
  detail::assign(out, [&](auto access) {
    return access(y) +
           detail::weighted_sum<Row, Real>(h, [&](std::size_t j) -> decltype(auto) { return access(k[j]); });
  });
}

/// Component d of h sum_j weight_j k_j; k[j] of shape (n).
template <StaticRow Row, class Stages, class Real>
inline auto increment_component(Row, Real h, const Stages& k, Eigen::Index d) {
  return detail::weighted_sum<Row, Real>(h, [&](std::size_t j) { return k[j][d]; });
}

/// The same with weights known at run time; k holds at least as many stages as there are weights.
template <class Stages, class Real>
inline auto increment_component(std::span<const long double> weights, Real h, const Stages& k,
                                Eigen::Index d) {
  // Zero weights are tested at run time here.
  typename std::remove_cvref_t<decltype(k[0])>::Scalar sum{0};
  for (std::size_t j = 0; j < weights.size(); ++j)
    if (weights[j] != 0) sum += (h * static_cast<Real>(weights[j])) * k[j][d];
  return sum;
}
/// out = y + h sum_j weights_j k_j, with weights known at run time; k[j] and y of shape (n).
template <class State, class Stages>
inline void add_increment(std::span<const long double> weights, const State& y, real_of<State> h,
                          const Stages& k, State& out) {
  for (Eigen::Index d = 0; d < y.size(); ++d) out[d] = y[d] + increment_component(weights, h, k, d);
}
template <class State, class Stages>
inline void stage_argument(std::span<const long double> weights, const State& y, real_of<State> h,
                           const Stages& k, State& out) {
  add_increment(weights, y, h, k, out);
}

namespace detail {
/// Numbers of a vector that stay in the innermost cache while all terms are added to them.
inline constexpr Eigen::Index block_size = 256;

/// Calls f(first, length) for the blocks of a vector of n numbers.
template <class F>
inline void for_each_block(Eigen::Index n, F&& f) {
  for (Eigen::Index first = 0; first < n; first += block_size) f(first, std::min(block_size, n - first));
}
}  // namespace detail

/// out = sum_j weights_j terms[j], with weights known at run time: at least one, and at least as many terms
/// of shape (n). One pass over memory.
template <class Real, class Terms, class State>
inline void combine(std::span<const Real> weights, const Terms& terms, State& out) {
  // Small: numbers in registers; large: blocks that stay in the cache while all terms are added.
  if constexpr (is_small_state<State>) {
    for_each_component<State>([&](Eigen::Index d) {
      typename State::Scalar sum = weights[0] * terms[0][d];
      for (std::size_t j = 1; j < weights.size(); ++j) sum += weights[j] * terms[j][d];
      out[d] = sum;
    });
  } else {
    detail::for_each_block(out.size(), [&](Eigen::Index first, Eigen::Index length) {
      auto part = out.segment(first, length);
      part = weights[0] * terms[0].segment(first, length);
      for (std::size_t j = 1; j < weights.size(); ++j) part += weights[j] * terms[j].segment(first, length);
    });
  }
}

/// out = y + h sum_j weights_j terms[j]. The small increment is summed first: this rounding stays.
template <class Real, class Terms, class State>
inline void add_combination(const State& y, Real h, std::span<const Real> weights, const Terms& terms,
                            State& out) {
  if constexpr (is_small_state<State>) {
    for_each_component<State>([&](Eigen::Index d) {
      typename State::Scalar sum = weights[0] * terms[0][d];
      for (std::size_t j = 1; j < weights.size(); ++j) sum += weights[j] * terms[j][d];
      out[d] = y[d] + h * sum;
    });
  } else {
    detail::for_each_block(out.size(), [&](Eigen::Index first, Eigen::Index length) {
      auto part = out.segment(first, length);
      part = weights[0] * terms[0].segment(first, length);
      for (std::size_t j = 1; j < weights.size(); ++j) part += weights[j] * terms[j].segment(first, length);
      part = y.segment(first, length) + h * part;
    });
  }
}

}  // namespace hmax
