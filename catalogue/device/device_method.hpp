/// The methods that devices run, as data for body_step().
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "integrators/explicit/stabilized_stages.hpp"
#include "integrators/structural/structural.hpp"

namespace hmax {

/// Steps of implicit Euler by a fixed number of iterations.
struct IteratedSteps {
  std::int32_t iterations = 0, substeps = 0;
  std::int32_t gradients = 0;     ///< of truncated Newton: conjugate gradients of an iteration
  bool frozen = false;            ///< of truncated Newton: K and C are those of the start
  bool resets = false;            ///< of constraints, as CompliantConstraints: multipliers begin at 0
  std::optional<double> share{};  ///< of constraints without compliance
  double rho = 0;                 ///< of points, as VertexBlockDescent
  /// Iterations of a step.
  [[nodiscard]] std::int64_t all() const { return std::int64_t{iterations} * substeps; }
  /// Programs of a step of truncated Newton, and those that a list may have.
  [[nodiscard]] std::int64_t programs() const {
    return substeps + all() * ((frozen ? 3 : 5) + 2 * std::int64_t{gradients});
  }
  static constexpr std::int64_t most_programs = 4096;
};

/// Stages that follow the spectral radius.
struct StagesByRadius {
  /// choose_stages() and longest_stabilized_step() of the polynomials.
  void (*choose)(double h, double radius, std::vector<StabilizedStage<double>>& stages) = nullptr;
  double (*longest_step)(double radius) = nullptr;
  std::vector<StabilizedStage<double>> stages{};  ///< of the step that is next
  static constexpr std::int32_t slopes = 2;       ///< that are kept: of the beginning and of the end
};

/// What a step of a method does.
struct DeviceMethod {
  enum class Kind : std::uint8_t {
    symplectic_euler,
    kicks,
    runge_kutta,
    stabilised,
    newton,
    constraints,
    points
  };
  Kind kind;
  /// Of kicks: what damping meets, see KickDriftKick.
  KickDamping damping = KickDamping::half_step;
  /// Of Runge-Kutta methods: what the slopes are multiplied with in the argument of each later stage, then at
  /// the end of the step. Without a last stage that is the first of the next step.
  std::vector<std::vector<long double>> rows{};
  std::vector<long double>
      nodes{};  ///< c_i of its stages; of stabilised methods those of the step that is next
  bool first_same_as_last = false;
  /// b_err of each estimate of the error, none where steps cannot be chosen; err = O(h^error_order).
  std::vector<std::vector<long double>> errors{};
  int error_order = 0;
  StagesByRadius by_radius{};
  IteratedSteps iterated{};

  /// Its programs move points or meet constraints one after the other.
  [[nodiscard]] bool is_positional() const { return kind == Kind::constraints || kind == Kind::points; }
  [[nodiscard]] bool is_iterated() const { return kind == Kind::newton || is_positional(); }
  [[nodiscard]] bool has_stages() const { return kind == Kind::runge_kutta || kind == Kind::stabilised; }
  /// @param is_double  whether steps are in double precision;  @param bodies  at a time
  /// @param adaptive   whether steps are chosen by their error
  /// @throws InputError  where the method has no such steps
  void check(bool is_double, std::int32_t bodies, bool adaptive) const;
  /// Of truncated Newton: Jacobians of so many steps.
  [[nodiscard]] std::int64_t jacobians(std::int64_t steps) const {
    if (kind != Kind::newton) return 0;
    return iterated.frozen ? std::min<std::int64_t>(steps, 1) : iterated.all() * steps;
  }
  /// Slopes that are kept, and the last one of them.
  [[nodiscard]] std::int32_t slopes() const {
    return kind == Kind::stabilised ? StagesByRadius::slopes : static_cast<std::int32_t>(nodes.size());
  }
  [[nodiscard]] std::int32_t last_stage() const { return slopes() - 1; }
  /// Evaluations of forces of a step, and of those before the first one.
  [[nodiscard]] std::int64_t evaluations() const {
    if (is_positional()) return 0;
    return kind == Kind::newton ? iterated.all() : instants();
  }
  /// At which times they stand: evaluations of loads.
  [[nodiscard]] std::int64_t instants() const {
    if (is_iterated()) return iterated.substeps;
    if (kind == Kind::stabilised) return static_cast<std::int64_t>(nodes.size());
    return kind == Kind::runge_kutta ? static_cast<std::int64_t>(rows.size()) : 1;
  }
  /// The most of them in a step, with that of a last slope; numbers of stages may be rounded up to odd ones.
  [[nodiscard]] std::int64_t most_instants() const {
    return kind == Kind::stabilised ? most_stabilized_stages<double>() + 2 : instants();
  }
  [[nodiscard]] std::int64_t first_evaluations() const {
    return kind == Kind::kicks || first_same_as_last ? 1 : 0;
  }
  /// Appends the instants of a step from t to t + h.
  /// @param before  t + h of the step before [s], where there was one
  void append_times(double t, double h, std::optional<double> before, std::vector<double>& times) const;
};

/// Nothing where no device runs it.
std::optional<DeviceMethod> device_method(const Method& method);

}  // namespace hmax
