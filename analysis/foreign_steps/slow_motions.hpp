/// The slow motions of steps of one size among those of another.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/dynamics/shown_mode.hpp"
#include "analysis/foreign_steps/step_spectrum.hpp"

namespace hmax {

/// The slowest that oscillate, or that decay where none does; without those of which differences tell less
/// than a thousandth, as of free motions. Their shapes are numbers of the state.
/// @param scale  of the shapes, shape (coordinates)
std::vector<StepMotion> slowest_motions(const std::vector<StepMotion>& motions, const Eigen::VectorXd& scale,
                                        std::size_t count);

/// What the motion of `motions` that is most like each of `slow` shows: `omega` and `zeta` are those of the
/// slow one. Each of `motions` continues one of them at most.
/// @param slow  of slowest_motions()
std::vector<ShownMode> continued_motions(const std::vector<StepMotion>& slow,
                                         const std::vector<StepMotion>& motions,
                                         const Eigen::VectorXd& scale);

}  // namespace hmax
