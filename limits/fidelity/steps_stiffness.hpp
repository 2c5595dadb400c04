/// The stiffness that steps of an engine of one's own show.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string_view>

#include "analysis/foreign_steps/foreign_stepper.hpp"

namespace hmax {

/// What steps of size h show of a stiffness, in multiples of that entered. Steps of h0 stand for the model:
/// with y(h, c) where steps of h rest with c times the stiffness, y_r the limit of y(h0, c) for large c and
/// d = y(h0, 1) - y_r the sag of the model, c times the stiffness shows d.d / d.(y(h, c) - y_r).
struct StepsStiffness {
  double h = 0;  ///< [s]
  /// NaN where nothing settles.
  double shown = std::numeric_limits<double>::quiet_NaN();
  /// The limit of what is shown as c grows; infinity where there is none up to a million, NaN where steps
  /// grow.
  double ceiling = std::numeric_limits<double>::quiet_NaN();
};

/// @param with  makes the engine with c times its stiffness
/// @param h0    [s], the smaller step size; @param h  [s]
/// @param watch  told now and then what is done; may throw
/// @throws InputError  as compare_steps(), and where the rest of steps of h0 is not found or does not depend
///                     on the stiffness
StepsStiffness stiffness_of_steps(
    const std::function<std::unique_ptr<ForeignStepper>(double c)>& with, double h0, double h,
    const std::function<void(double share, std::string_view detail)>& watch = {});

/// The limit of shown(c) for large c, from a geometric sequence up to `most`; infinity where it still grows
/// there, NaN where shown() is.
double stiffness_ceiling(const std::function<double(double c)>& shown, double most);

}  // namespace hmax
