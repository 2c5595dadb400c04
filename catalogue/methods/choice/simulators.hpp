/// What simulators of soft bodies step with.
#pragma once

#include <array>

namespace hmax {

/// Implicit Euler by a fixed number of iterations, of bodies alone: names with parameters.
inline constexpr std::array<const char*, 7> iterated_by_simulators{"vbd",
                                                                   "vbd:iterations=1,substeps=10",
                                                                   "xpbd",
                                                                   "xpbd:iterations=1,substeps=10",
                                                                   "newton_truncated",
                                                                   "projective_dynamics",
                                                                   "pbd"};

}  // namespace hmax
