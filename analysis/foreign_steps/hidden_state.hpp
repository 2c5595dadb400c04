/// What the steps of an engine depend on besides the state that it shows.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/foreign_steps/foreign_stepper.hpp"

namespace hmax {

/// All differences in units of scales.
struct HiddenState {
  double repeated = 0;   ///< between steps from a saved state, or one beside it, and the same again
  double set_again = 0;  ///< between three steps from it, and from it after its own state was set
  /// Between steps from one state after two histories, per unit of the difference of the histories.
  double history = 0;
  double restored = 0;  ///< between a saved state and what restoring it shows

  /// Sentences for what is larger than `noise`.
  [[nodiscard]] std::vector<std::string> remarks(double noise, bool has_save) const;
};

/// @param slot  with the state y
HiddenState examine_hidden_state(ForeignStepper& engine, const StateCoordinates& coordinates,
                                 const Eigen::VectorXd& scale, int slot, const Eigen::VectorXd& y, double h);

}  // namespace hmax
