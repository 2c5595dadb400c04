/// Which parts of a scene its largest stable step rests on.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "analysis/foreign_steps/step_spectrum.hpp"

namespace hmax {

/// Of -d ln h_max where a part becomes faster: its stiffness by s^2, its damping by s. Shares of all that
/// gives a scene its time scale sum to 1, since a scene whose time runs s times as fast has steps of h / s. A
/// part that damps what grows has a negative one.
struct PartShare {
  double of_stiffness = 0, of_damping = 0;
  [[nodiscard]] double sum() const { return of_stiffness + of_damping; }
};

/// From the derivatives of the growing multiplier mu of a step: d ln |mu| = Re(w* dJ v / (mu w* v)) with its
/// left and right eigenvectors, at the same state, dJ by differences of steps with the part changed by a
/// hundredth. Of a multiple mu their mean.
/// @param y         the state of rest, with the engine's in `slot`
/// @param critical  a step that grows there, of up to `most` coordinates
/// @return one for each part; empty where the growth does not depend on the step size
std::vector<PartShare> shares_of_limit(ForeignStepper& engine, const StateCoordinates& coordinates,
                                       const Eigen::VectorXd& scale, int slot, const Eigen::VectorXd& y,
                                       const StepSpectrum& critical, const std::function<void()>& watch);

}  // namespace hmax
