/// One step of an explicit Runge-Kutta method for many states of the plane at once, each in a lane of its
/// own.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include <Eigen/Core>

#include "core/instructions/device_code.hpp"
#include "integrators/explicit/explicit_rk.hpp"

namespace hmax {

/// N independent states, and what ExplicitRk<StaticCoefficients<Method>> would compute of each: the same
/// operations in the same order, so the same bits. No lane depends on another.
///
/// Numbers of all lanes stand side by side. The compiler turns the loops over lanes into vector operations of
/// whatever instruction set the caller is compiled for, which changes times, not results: nothing is
/// contracted or reordered.
/// @tparam Method  like tableaux::Dop853
/// @tparam N       lanes: one, as in a thread of a device, or a multiple of 8: some registers full, so that
///                 additions of some fill the latency of others
/// @source [hairer1993solving] II.4, II.10, as ExplicitRk
template <class Method, std::size_t N>
class LaneRk {
  using State = Eigen::Vector2d;
  using Coefficients = StaticCoefficients<Method>;
  static constexpr std::size_t stages = Coefficients::stages();
  static constexpr std::size_t group = N == 1 ? 1 : 8;  ///< numbers in a register of the widest kind
  static_assert(N % group == 0);

 public:
  /// Attempts are made in the first `count` lanes and those that share a register with them.
  HMAX_DEVICE void use(std::size_t count) { used_ = (count + group - 1) / group * group; }
  /// How many these are.
  [[gnu::always_inline]] [[nodiscard]] HMAX_DEVICE std::size_t used() const { return N == 1 ? 1 : used_; }

  /// Puts a state into a lane.
  /// @param slope  f(t, y); read where the last stage of a step is the first of the next
  HMAX_DEVICE void start(std::size_t lane, const State& y, const State& slope) {
    set(y_, lane, y);
    set(k_[0], lane, slope);
  }
  /// Puts the state of a lane and its first slope into another one.
  HMAX_DEVICE void move(std::size_t from, std::size_t to) { start(to, get(y_, from), get(k_[0], from)); }
  /// The next attempt of a lane: from t with a size of h.
  HMAX_DEVICE void set_step(std::size_t lane, double t, double h) {
    t_[lane] = t;
    h_[lane] = h;
  }

  /// t + c_I h, where stage I of a lane stands.
  template <std::size_t I>
  [[gnu::always_inline]] [[nodiscard]] HMAX_DEVICE double stage_time(std::integral_constant<std::size_t, I>,
                                                                     std::size_t lane) const {
    return t_[lane] + static_cast<double>(Coefficients::node(I)) * h_[lane];
  }

  /// A step of every lane from its state: y_new.
  /// @param slope  called as slope(i, lane, y, dydt): writes f at the node of stage i; has to be inlined. A
  ///               method whose last stage is not the first of the next step asks for stage 0 too.
  template <class Slope>
  [[gnu::always_inline]] HMAX_DEVICE void attempt(const Slope& slope) {
    if constexpr (!Coefficients::fsal) evaluate<0>(slope);
    [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
      (evaluate<I + 1>(slope), ...);
    }
    (std::make_index_sequence<stages - 1>{});
    if constexpr (!Coefficients::fsal)
      for (std::size_t lane = 0; lane < used(); ++lane) set(y_new_, lane, end_of_step(lane));
  }

  /// The square of the error of the last attempt of every lane, see error_squared().
  /// @param norm  carries the tolerances, as in ExplicitRk::error_squared
  template <class Norm>
  [[gnu::always_inline]] HMAX_DEVICE void weigh(const Norm& norm) {
    static_assert(Coefficients::has_low_error, "two error rows, as of DOP853");
    for (std::size_t lane = 0; lane < used(); ++lane) {
      const double e = weighted_square<typename Coefficients::ErrorWeights>(lane, norm);
      const double e_low = weighted_square<typename Coefficients::LowErrorWeights>(lane, norm);
      const double denominator = e + 0.01 * e_low;
      // Divided in every lane, used where it is not 0 / 0: a choice between two numbers is no branch.
      const double quotient = e * e / denominator;
      error_squared_[lane] = denominator == 0 ? 0.0 : quotient;
    }
  }

  /// Of the last attempt, at most 1 where it is good enough.
  [[nodiscard]] HMAX_DEVICE double error_squared(std::size_t lane) const { return error_squared_[lane]; }
  /// Where the next attempt begins.
  [[nodiscard]] HMAX_DEVICE State state(std::size_t lane) const { return get(y_, lane); }
  /// The first slope of the next attempt, where the last stage of a step is that.
  [[nodiscard]] HMAX_DEVICE State slope(std::size_t lane) const { return get(k_[0], lane); }
  /// The candidate of the last attempt.
  [[gnu::always_inline]] [[nodiscard]] HMAX_DEVICE State candidate(std::size_t lane) const {
    return get(y_new_, lane);
  }

  /// Commits the last attempt of a lane. Its last slope is the first of the next step if the method has that.
  [[gnu::always_inline]] HMAX_DEVICE void accept(std::size_t lane) {
    set(y_, lane, get(y_new_, lane));
    if constexpr (Coefficients::fsal) set(k_[0], lane, get(k_[stages - 1], lane));
  }

 private:
  using Lanes = std::array<std::array<double, N>, 2>;  ///< [component][lane]

  [[gnu::always_inline]] HMAX_DEVICE static void set(Lanes& lanes, std::size_t lane, const State& y) {
    lanes[0][lane] = y[0];
    lanes[1][lane] = y[1];
  }
  [[gnu::always_inline]] HMAX_DEVICE static State get(const Lanes& lanes, std::size_t lane) {
    return {lanes[0][lane], lanes[1][lane]};
  }

  /// h sum_i row_i k_i of a lane.
  template <class Row>
  [[gnu::always_inline]] HMAX_DEVICE State increment(std::size_t lane) const {
    State sum;
    for_each_component<State>([&](Eigen::Index i) {
      sum[i] = detail::weighted_sum<Row, double>(
          h_[lane], [&](std::size_t j) { return k_[j][static_cast<std::size_t>(i)][lane]; });
    });
    return sum;
  }
  [[gnu::always_inline]] HMAX_DEVICE State end_of_step(std::size_t lane) const {
    const State sum = increment<decltype(Coefficients::weights())>(lane);
    return {y_[0][lane] + sum[0], y_[1][lane] + sum[1]};
  }

  /// The argument of stage I of a lane, y + h sum_j a_Ij k_j.
  template <std::size_t I>
  [[gnu::always_inline]] HMAX_DEVICE State argument_of(std::size_t lane) const {
    using Row = decltype(Coefficients::stage_row(std::integral_constant<std::size_t, I>{}));
    State argument;
    for_each_component<State>([&](Eigen::Index i) {
      const auto d = static_cast<std::size_t>(i);
      argument[i] = detail::fold_weights<Row, double, detail::next_weight<Row>(0)>(
          h_[lane], [&](std::size_t j) { return k_[j][d][lane]; }, y_[d][lane]);
    });
    return argument;
  }

  /// Stage I of every lane, k_I = f(argument). The argument of the last one is y_new if its slope is the
  /// first of the next step.
  template <std::size_t I, class Slope>
  [[gnu::always_inline]] HMAX_DEVICE void evaluate(const Slope& slope) {
    constexpr bool at_end = Coefficients::fsal && I + 1 == stages;
    for (std::size_t lane = 0; lane < used(); ++lane) {
      State argument, dydt;
      if constexpr (at_end)
        argument = end_of_step(lane);
      else
        argument = argument_of<I>(lane);
      slope(std::integral_constant<std::size_t, I>{}, lane, argument, dydt);
      set(k_[I], lane, dydt);
      if constexpr (at_end) set(y_new_, lane, argument);
    }
  }

  /// Square of the norm of h sum_i row_i k_i in one lane.
  template <class Row, class Norm>
  [[gnu::always_inline]] HMAX_DEVICE double weighted_square(std::size_t lane, const Norm& norm) const {
    const State error = increment<Row>(lane);
    return norm.squared(get(y_, lane), get(y_new_, lane), [&](Eigen::Index i) { return error[i]; });
  }

  std::size_t used_ = N;
  alignas(64) Lanes y_{}, y_new_{};
  alignas(64) std::array<Lanes, stages> k_{};  ///< slopes, [stage][component][lane]
  alignas(64) std::array<double, N> t_{}, h_{}, error_squared_{};
};

}  // namespace hmax
