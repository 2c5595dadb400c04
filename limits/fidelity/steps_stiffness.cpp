#include "limits/fidelity/steps_stiffness.hpp"

#include <cmath>

#include "analysis/foreign_steps/step_probe.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {

double stiffness_ceiling(const std::function<double(double c)>& shown, double most) {
  constexpr double stride = 100;
  double before = shown(1);
  for (double c = stride; c <= most; c *= stride) {
    const double now = shown(c);
    if (std::isnan(now) || std::isnan(before)) return now + before;
    // Beyond, E_shown = ceiling (1 - c / E): the last of a geometric sequence.
    if (now < 1.05 * before) return now + (now - before) / (stride - 1);
    before = now;
  }
  // Of exact equations all that is entered.
  return infinity;
}

StepsStiffness stiffness_of_steps(const std::function<std::unique_ptr<ForeignStepper>(double c)>& with,
                                  double h0, double h,
                                  const std::function<void(double share, std::string_view detail)>& watch) {
  Eigen::VectorXd start;
  const auto rows = [&](double c) {
    const std::unique_ptr<ForeignStepper> engine = with(c);
    start = engine->state();
    return compare_steps(*engine, {.h0 = h0, .h1 = h, .watch = watch}).rows;
  };
  const auto model = [&](double c) -> Eigen::VectorXd {
    Eigen::VectorXd rest = rows(c).front().settled;
    if (rest.size() == 0)
      throw InputError("no state of rest of steps of h0 was found with " + short_number(c) +
                       " times the stiffness; take another h0");
    return rest;
  };
  // y(h0, c) = y_r + d / c, but for what is beyond c = 100.
  const Eigen::VectorXd soft = model(1), stiff = model(1e4), none = stiff - (model(100) - stiff) / 99;
  const Eigen::VectorXd sag = soft - none;
  // Of no sag there is rounding, and what is left of the way to rest.
  if (!(sag.norm() > 1e-9 * soft.norm() + 1e-7 * (soft - start).norm()))
    throw InputError("where steps of h0 rest does not depend on the stiffness; load the body");
  const auto shown = [&](double c) {
    const StepSpectrum row = rows(c).back();
    if (!row.settles || !*row.settles) return std::numeric_limits<double>::quiet_NaN();
    const double left = sag.dot(row.settled - none) / sag.squaredNorm();
    constexpr double rounding = 1e-7;
    return std::abs(left) > rounding ? 1 / left : infinity;
  };
  return {.h = h, .shown = shown(1), .ceiling = stiffness_ceiling(shown, 1e6)};
}

}  // namespace hmax
