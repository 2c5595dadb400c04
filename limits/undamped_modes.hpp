/// The slow oscillations of a structure, each alone: what steps are asked to keep.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "limits/point/operating_point.hpp"

namespace hmax {

/// The modes of a structure without its damping, and what its damping makes of each alone: it may couple
/// them, as beta K at rest does a little where a body is deformed.
struct ModesAlone {
  std::vector<MechanicalMode> slowest{};  ///< kappa > 0, the slowest first; of large structures one, or none
  Eigen::MatrixXd shapes{};  ///< of these, columns of length 1 in the norm of M, shape (dofs, modes)
  std::optional<MechanicalMode> fastest{};  ///< nothing where the ends are known alone
  bool stiff = true;                        ///< whether a mode has a positive stiffness
};

/// @param point  mechanical, with symmetric K
/// @param most   modes
ModesAlone modes_alone(OperatingPoint point, std::size_t most);

}  // namespace hmax
