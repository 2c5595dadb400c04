/// The largest stable step of a method on a linear model, and the mode that sets it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/amplification/amplification.hpp"

namespace hmax {

/// The answer for a whole spectrum.
struct StepLimit {
  double h_max = 0;                ///< [s]; infinity when no step of any size is unstable
  std::size_t limiting = 0;        ///< index of the mode that sets it
  std::vector<double> of_modes{};  ///< the first exit of each mode alone [s]; infinity without one
  /// Modes that grow in the model itself, Re lambda > 0. They are no limit of a step: a method that followed
  /// them would grow as well.
  std::vector<std::size_t> growing{};
};

/// Re lambda of an eigenvalue that was computed in double is zero when it is less than this of |lambda|.
inline constexpr double eigenvalue_rounding = 1e-13;

/// 4 (count + 1) epsilon radius, the rounding that the largest |lambda| leaves in all others [1/s]: an
/// eigenvalue that should be zero comes out as some of it.
double noise_of(std::size_t count, double radius);

/// The modes of a spectrum that grow in the model itself: Re lambda is beyond eigenvalue_rounding of |lambda|
/// and beyond noise_of() the spectrum.
std::vector<std::size_t> growing_modes(std::span<const Complex> spectrum);

/// Which first exits are sought.
enum class Exits {
  all,   ///< of every mode
  least  ///< from the last mode on those below the least so far; infinity stands for others: where exits are
         ///< sampled, those far beyond the limit take nearly all of the time
};

/// The first exit of every mode from the origin, h' in (0, h]: what lies behind a gap is of no use to anybody
/// who lowers a step. The smallest is the limit; with damping it is often not that of the largest eigenvalue.
/// h_max = min over modes of first_exit(); growing modes take no part, nor do those with |lambda| below
/// the rounding of the spectrum.
/// @return  h_max infinity and limiting 0 where no mode has an exit
/// @param modes  not empty
StepLimit largest_stable_step(const Amplification& amplification, std::span<const Eigenmode> modes,
                              Exits wanted = Exits::all);

/// The same of eigenvalues that the method is told exactly.
StepLimit largest_stable_step(const Amplification& amplification, std::span<const Complex> spectrum);

/// The same of oscillations, for methods of both kinds: two eigenvalues each.
StepLimit largest_stable_step(const Amplification& amplification, std::span<const MechanicalMode> modes);

}  // namespace hmax
