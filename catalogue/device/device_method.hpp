/// The methods that devices run, as data for body_step().
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "integrators/structural/structural.hpp"

namespace hmax {

/// What a step of a method does.
struct DeviceMethod {
  enum class Kind : std::uint8_t { symplectic_euler, kicks, runge_kutta };
  Kind kind;
  /// Of kicks: what damping meets, see KickDriftKick.
  KickDamping damping = KickDamping::half_step;
  /// Of Runge-Kutta methods: what the slopes are multiplied with in the argument of each later stage, then at
  /// the end of the step. Without a last stage that is the first of the next step.
  std::vector<std::vector<long double>> rows{};
  std::vector<long double> nodes{};  ///< c_i of its stages
  bool first_same_as_last = false;

  /// Evaluations of a step, and of those before the first one.
  [[nodiscard]] std::int64_t evaluations() const {
    return kind == Kind::runge_kutta ? static_cast<std::int64_t>(rows.size()) : 1;
  }
  [[nodiscard]] std::int64_t first_evaluations() const {
    return kind == Kind::kicks || first_same_as_last ? 1 : 0;
  }
  /// Appends where the evaluations of a step from t to t + h stand.
  /// @param before  t + h of the step before [s], where there was one
  void append_times(double t, double h, std::optional<double> before, std::vector<double>& times) const;
};

/// Nothing where no device runs it.
std::optional<DeviceMethod> device_method(const Method& method);

}  // namespace hmax
