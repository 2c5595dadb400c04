/// What a probe tells of the step size that a scene asks for, and of the part that its limit rests on.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "analysis/foreign_steps/step_probe.hpp"

namespace hmax {

/// The largest number of the owner, and of all alike together, at which steps of the scene's own size do not
/// grow; infinity where a million times its own is stable, 0 where a millionth is not, NaN where it was not
/// sought.
struct LargestNumber {
  double alone = std::numeric_limits<double>::quiet_NaN(), together = alone;
};

/// Of the parts of one kind, stiffness and damping that have the largest share together (step_shares.hpp),
/// the one with the largest.
struct LimitOwner {
  ScenePart part;
  double share = 0, share_of_alike = 0;
  std::size_t alike = 1;  ///< with itself
  LargestNumber stiffness, damping;
};

struct OwnStep {
  double h = 0;  ///< [s]
  /// h <= h_max, at a kink also that steps of h do not grow, at a jump h <= observed; nothing beyond h1, or
  /// where growth may hide
  std::optional<bool> stable{};
  std::optional<std::int64_t> substeps{};  ///< the smallest n with stable h / n
  std::optional<bool> settles{};           ///< as StepSpectrum
  /// (omega_shown / omega)^2 of the slowest mode; NaN where it is not known
  double stiffness_shown = std::numeric_limits<double>::quiet_NaN();
  std::optional<LimitOwner> owner{};
};

using ProbeWatch = std::function<void(double share, std::string_view detail)>;

/// Where steps of h settle, what they show, and the largest stiffness are found of up to 300 numbers.
/// @param found  of this engine, which has its state at the end
/// @return nothing where the scene asks for no step size
/// @throws InputError  as probe_steps()
std::optional<OwnStep> examine_own_step(ForeignStepper& engine, const ProbedLimit& found,
                                        const ProbeWatch& watch);

/// The largest factor of the stiffness of these parts, or of their damping, at which steps of size h do not
/// grow: by doubling or halving from 1, then bisection to 1e-3. The state of rest is followed.
/// @return infinity where a factor of a million is stable, 0 where a millionth is not
double largest_factor(ForeignStepper& engine, const std::vector<std::size_t>& parts, bool of_damping,
                      double h, const ProbeWatch& watch);

}  // namespace hmax
