/// One step of an explicit Runge-Kutta method for many states at once, each in a lane of its own.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "integrators/explicit/explicit_rk.hpp"

namespace hmax {

/// N independent states of one autonomous system, and what ExplicitRk<StaticCoefficients<Method>> would
/// compute of each: the same operations in the same order, so the same bits. No lane depends on another.
///
/// Numbers of all lanes stand side by side. The compiler turns the loops over lanes into vector operations of
/// whatever instruction set the caller is compiled for, which changes times, not results: nothing is
/// contracted or reordered.
/// @tparam Method  first same as last, with an error estimate, like tableaux::Dop853
/// @tparam Sys     whose g(t) does not change; its rhs_at() has to be inlined
/// @tparam N       lanes; some registers full, so that additions of some fill the latency of others
/// @source [hairer1993solving] II.4, II.10, as ExplicitRk
template <class Method, TimeSplitSystem Sys, std::size_t N>
class LaneRk {
  using Coefficients = StaticCoefficients<Method>;
  static_assert(Coefficients::fsal && Coefficients::has_error);
  static constexpr std::size_t stages = Coefficients::stages();

 public:
  using State = typename Sys::State;
  using Real = real_of<State>;
  static constexpr std::size_t lanes = N;
  static_assert(is_small_state<State>);

  /// Puts a state into a lane and evaluates its first slope.
  /// @param y  shape (n)
  void start(const Sys& system, std::size_t lane, const State& y) {
    State slope = y;
    system.rhs_at(system.at(Real(0)), y, slope);
    set(y_, lane, y);
    set(k_[0], lane, slope);
  }

  /// The size of the next attempt of a lane; 0 for one that rests.
  void set_step(std::size_t lane, Real h) { h_[lane] = h; }

  /// A step of every lane from its state: y_new and the square of its error in this norm.
  /// @param norm  carries the tolerances, as in ExplicitRk::error_squared
  template <class Norm>
  [[gnu::always_inline]] void attempt(const Sys& system, const Norm& norm) {
    const auto g = system.at(Real(0));
    [&]<std::size_t... I>(std::index_sequence<I...>) __attribute__((always_inline)) {
      (evaluate<I + 1>(system, g), ...);
    }
    (std::make_index_sequence<stages - 1>{});
    weigh(norm);
  }

  /// Of the last attempt, at most 1 where it is good enough.
  [[nodiscard]] Real error_squared(std::size_t lane) const { return error_squared_[lane]; }
  /// The candidate of the last attempt, shape (n).
  [[nodiscard]] State candidate(std::size_t lane) const { return get(y_new_, lane); }

  /// Commits the last attempt of a lane: its last slope is the first of the next step.
  void accept(std::size_t lane) {
    for (std::size_t d = 0; d < n; ++d) {
      y_[d][lane] = y_new_[d][lane];
      k_[0][d][lane] = k_[stages - 1][d][lane];
    }
  }

 private:
  static constexpr std::size_t n = State::SizeAtCompileTime;
  using Lanes = std::array<std::array<Real, N>, n>;  ///< [component][lane]

  static void set(Lanes& lanes_of, std::size_t lane, const State& y) {
    for (std::size_t d = 0; d < n; ++d) lanes_of[d][lane] = y[static_cast<Eigen::Index>(d)];
  }
  [[gnu::always_inline]] static State get(const Lanes& lanes_of, std::size_t lane) {
    State y;
    for_each_component<State>([&](Eigen::Index d) { y[d] = lanes_of[static_cast<std::size_t>(d)][lane]; });
    return y;
  }

  /// Stage I of every lane, k_I = f(y + h sum_j a_Ij k_j). The argument of the last one is y_new.
  template <std::size_t I, class Part>
  [[gnu::always_inline]] void evaluate(const Sys& system, const Part& g) {
    using Row = decltype(Coefficients::stage_row(std::integral_constant<std::size_t, I>{}));
    using Weights = decltype(Coefficients::weights());
    for (std::size_t lane = 0; lane < N; ++lane) {
      State argument, slope;
      for_each_component<State>([&](Eigen::Index i) {
        const auto d = static_cast<std::size_t>(i);
        const auto term = [&](std::size_t j) { return k_[j][d][lane]; };
        if constexpr (I + 1 == stages)
          argument[i] = y_[d][lane] + detail::weighted_sum<Weights, Real>(h_[lane], term);
        else
          argument[i] =
              detail::fold_weights<Row, Real, detail::next_weight<Row>(0)>(h_[lane], term, Real(y_[d][lane]));
      });
      system.rhs_at(g, argument, slope);
      for_each_component<State>([&](Eigen::Index i) {
        const auto d = static_cast<std::size_t>(i);
        k_[I][d][lane] = slope[i];
        if constexpr (I + 1 == stages) y_new_[d][lane] = argument[i];
      });
    }
  }

  /// Square of the norm of h sum_i row_i k_i in one lane.
  template <class Row, class Norm>
  [[gnu::always_inline]] Real weighted_square(std::size_t lane, const Norm& norm) const {
    State error;
    for_each_component<State>([&](Eigen::Index i) {
      const auto d = static_cast<std::size_t>(i);
      error[i] = detail::weighted_sum<Row, Real>(h_[lane], [&](std::size_t j) { return k_[j][d][lane]; });
    });
    return norm.squared(get(y_, lane), get(y_new_, lane), [&](Eigen::Index i) { return error[i]; });
  }

  /// As ExplicitRk::error_squared.
  template <class Norm>
  [[gnu::always_inline]] void weigh(const Norm& norm) {
    for (std::size_t lane = 0; lane < N; ++lane) {
      const Real e = weighted_square<typename Coefficients::ErrorWeights>(lane, norm);
      if constexpr (Coefficients::has_low_error) {
        const Real e_low = weighted_square<typename Coefficients::LowErrorWeights>(lane, norm);
        const Real denominator = e + Real(0.01) * e_low;
        // Divided in every lane, used where it is not 0 / 0: a choice between two numbers is no branch.
        const Real quotient = e * e / denominator;
        error_squared_[lane] = denominator == 0 ? Real(0) : quotient;
      } else {
        error_squared_[lane] = e;
      }
    }
  }

  alignas(64) Lanes y_{}, y_new_{};
  alignas(64) std::array<Lanes, stages> k_{};  ///< slopes, [stage][component][lane]
  alignas(64) std::array<Real, N> h_{}, error_squared_{};
};

}  // namespace hmax
