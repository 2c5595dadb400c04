/// States at which a step has no derivative, and what its one-sided differences make of small disturbances.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include <Eigen/Core>

#include "analysis/foreign_steps/foreign_stepper.hpp"

namespace hmax {

/// At a kink S(y + e v) - S(y) is as long as e, and other than S(y) - S(y - e v): a contact, a joint limit or
/// a tendon that just touches, a muscle at rest. At a jump it is longer than e: contacts that come and go.
enum class StepSmoothness { smooth, kink, jump };
std::string_view name_of(StepSmoothness smoothness);

struct StepKink {
  StepSmoothness kind = StepSmoothness::smooth;
  Eigen::Index number = 0;      ///< of the state, whose disturbance shows it most
  Eigen::VectorXd direction{};  ///< in units of scales, shape (coordinates)
};

/// From S(y + e v) + S(y - e v) - 2 S(y) at increments e from 1e-3 to 1e-7, which shrinks like e^2 where S
/// is smooth, like e at a kink and not at all across a jump: each coordinate of a state of at most 60, for
/// kinks, and random directions, whose changes must add up also.
/// @param y  with the engine's in `slot`
StepKink kink_of_step(ForeignStepper& engine, const StateCoordinates& coordinates,
                      const Eigen::VectorXd& scale, int slot, const Eigen::VectorXd& y, double h,
                      const std::function<void()>& watch);

/// |S(y + e v) + S(y - e v) - 2 S(y)| / e in units of scales.
double kink_along(ForeignStepper& engine, const StateCoordinates& coordinates, const Eigen::VectorXd& scale,
                  int slot, const Eigen::VectorXd& y, double h, const Eigen::VectorXd& v, double increment);

struct OneSidedGrowth {
  bool grows = false;
  double rate = 0;           ///< ln of the factor of a step, at the end; infinite beyond the range of numbers
  Eigen::VectorXd motion{};  ///< moduli at the end, in units of scales, shape (coordinates)
};

/// Steps of one_sided_growth() where nothing grows.
inline constexpr std::int64_t steps_of_one_sided_growth = 8000;

/// Whether v -> lim (S(y + e v) - S(y)) / e, iterated, grows: the derivative of a step as it is at a kink,
/// which is no matrix. Begun with two vectors and their opposites, for 2,000 steps and, where it seems to
/// grow, for 20,000.
/// @param y  at rest, with the engine's in `slot`
OneSidedGrowth one_sided_growth(ForeignStepper& engine, const StateCoordinates& coordinates,
                                const Eigen::VectorXd& scale, int slot, const Eigen::VectorXd& y, double h,
                                const std::function<void()>& watch);

}  // namespace hmax
