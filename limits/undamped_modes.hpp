/// The slow undamped modes of a structure and their damping ratios, which steps are asked to keep.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "limits/point/operating_point.hpp"

namespace hmax {

/// Eigenvectors x of K x = kappa M x, x^T M x = 1, with the diagonal gamma = x^T C x of the modal damping
/// matrix. Non-proportional damping has other elements too, which are left out: those of beta K at rest are
/// small where a body is deformed.
struct UndampedModes {
  std::vector<MechanicalMode> slowest{};  ///< kappa > 0, the slowest first; of large structures one, or none
  Eigen::MatrixXd shapes{};               ///< of these, shape (dofs, modes) [kg^-1/2]
  std::optional<MechanicalMode> fastest{};  ///< nothing of large structures
  bool stiff = true;                        ///< whether a kappa is positive
};

/// @param point  with a mechanical model whose K is symmetric
/// @param most   of the slowest
/// @cost  that of mode_set(), and a factor of K - kappa M for each shape
/// @throws InputError  as mode_set()
UndampedModes undamped_modes(OperatingPoint point, std::size_t most);

}  // namespace hmax
