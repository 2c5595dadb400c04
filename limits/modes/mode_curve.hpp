/// Limits on structures so large that only their slowest and their fastest mode are known.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/size_limits.hpp"
#include "limits/point/operating_point.hpp"
#include "limits/point/prediction.hpp"

namespace hmax {

/// The least kappa of a structure, found when a limit asks for it.
class SlowEnd {
 public:
  SlowEnd() = default;
  /// Of a structure whose matrices are elsewhere: none is below `bound` [1/s^2], and no part tells more.
  explicit SlowEnd(double bound) : kappa_(bound), is_bound_(true) {}

  /// [1/s^2]; 0, which none is below, beyond most_factored degrees of freedom.
  double of(const MechanicalPart& part, const DampingCurve& curve);
  [[nodiscard]] bool is_bound() const { return is_bound_; }

 private:
  std::once_flag once_;
  double kappa_ = 0;
  bool is_bound_ = false;
};

/// Whether a factor of K, which tells of the least kappa, is affordable, and worth its time: a body without
/// displacement has none below zero.
/// @param is_body  whether the model is that of a body
bool affords_slow_end(const LinearModel& model, bool is_body);

/// The least eigenvalue of K u = kappa M u where it is negative beyond rounding [1/s^2]; nothing where some
/// hundred products, which find those far from zero, find none, and for a body without displacement.
std::optional<double> negative_stiffness(const LinearModel& model, double kappa_max, bool is_body);

/// Puts the ends of the spectrum of a large structure with proportional damping into `modes`; beyond
/// most_cheaply_factored degrees of freedom its fast end alone, which limits explicit methods, with 0 for the
/// slow one. False, and nothing done, for all other models.
/// @param small    up to so many degrees of freedom a structure is not large
/// @param is_body  then its stiffness without displacement has no negative eigenvalue
bool set_curve(const LinearModel& model, ModeSet& modes, Eigen::Index small = most_dense_modes,
               bool is_body = true);

/// The least limit of a method along the curve of all modes between those ends.
struct LimitOnCurve {
  double h_max = 0;  ///< [s]
  Mode mode;         ///< that sets it
  std::vector<ModeMargin>
      modes{};         ///< both ends as far as known, and the limiting mode where it lies between
  std::string note{};  ///< a sentence where it does: no mode may lie exactly there
};

/// @param radius  that the method is told [1/s]
LimitOnCurve limit_on_curve(const Amplification& amplification, const MechanicalPart& part,
                            const ModeSet& modes, double radius);

}  // namespace hmax
