/// Force feedback at 1 kHz from tissue that is computed at 100 Hz.
#pragma once

#include <string>
#include <vector>

#include "results/json.hpp"
#include "studies/thigh/thigh_model.hpp"

namespace hmax {

/// A probe that presses a point of a thigh through a penalty spring, F = k (x(t) - u). It is pushed in within
/// 0.3 s and then shakes.
struct HapticContact {
  Eigen::Index point = 0;
  double stiffness = 300;               ///< k of the contact [N/m]
  double depth = 0.012;                 ///< of the probe [m]
  double shake = 0.002, frequency = 4;  ///< about that depth [m], [Hz]
  double mass = 0.01, damping = 50;     ///< of a point of the tissue [kg], force over velocity and mass [1/s]
  double t_end = 1;                     ///< [s]

  /// Where the probe stands [m].
  [[nodiscard]] double position(double t) const;
};

/// What the hand feels each millisecond.
struct HapticForce {
  std::string name;
  std::vector<double> t, force;  ///< [s], [N]
  double rms = 0, largest = 0;   ///< error over the largest force of the reference [1]
  double jump = 0;               ///< the largest change within a millisecond [N]
};
HMAX_RECORD(HapticForce, name, rms, largest, jump);

/// The reference, tissue and contact at one rate by an adaptive method of order 8; tissue at 1 kHz; and
/// tissue at 100 Hz, by linearly implicit Euler, with the force held for a frame, the tissue held for a
/// frame, and a local model: the tissue gives way by the compliance that its own step has at the point,
///   F(t) = F_n + k / (1 + k s) (x(t) - x_n),   s = ((M / h^2 + C / h + K)^-1)_pp,   h = 10 ms.
/// @throws std::invalid_argument  for a point that the thigh does not have
std::vector<HapticForce> haptic_forces(const Thigh& thigh, const HapticContact& contact);

}  // namespace hmax
