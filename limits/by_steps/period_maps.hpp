/// The period map of a driven problem, and those of many problems side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "analysis/dynamics/oscillator_lanes.hpp"
#include "analysis/dynamics/poincare.hpp"
#include "catalogue/methods/method.hpp"
#include "catalogue/models/planar.hpp"

namespace hmax {

/// Steps of one size between two looks, instead of those that the tolerances of stroboscope() ask for.
struct FixedSteps {
  Method method;
  double h;  ///< [s], at most; the largest size that divides the period is taken
};

/// After so many adaptive steps a period is taken for one that diverges.
inline constexpr std::int64_t most_period_steps = 1'000'000;

/// y -> P(y), the state one period after y, by steps of stroboscope() or by fixed ones.
/// @param most_steps  of an adaptive period, after which it is taken for one that diverges
/// @throws InputError as steps_map() where the steps are fixed
VectorFunction stroboscope(const Problem& problem, double period, const std::optional<FixedSteps>& steps,
                           std::int64_t most_steps = most_period_steps,
                           const Tolerances<double>& tolerances = stroboscope_tolerances);

/// The period maps of problem_at(i). Images have the bits of stroboscope().
///
/// Maps of oscillators are applied side by side: adaptive ones each at a time of its own,
/// those of fixed steps of an explicit Runge-Kutta method at the same time, so that the cosine of the force
/// is known beforehand for all periods; they need one w and one period. Those of formulas go through the same
/// steps, adaptive or of such a method. Others are applied one by one.
/// @param problem_at  called by several threads at once where problems are no oscillators
/// @param periods     [s], of each problem
/// @param runner      where motions of oscillators and formulas go; it changes times, not images
/// @param tolerances  of adaptive periods
/// @throws InputError as steps_map() where the steps are fixed, and where a device does not run them
MapEnsemble period_maps(const std::function<Problem(std::size_t i)>& problem_at,
                        const std::vector<double>& periods, const std::optional<FixedSteps>& steps,
                        const MotionRunner& runner = in_lanes(),
                        const Tolerances<double>& tolerances = stroboscope_tolerances);

}  // namespace hmax
