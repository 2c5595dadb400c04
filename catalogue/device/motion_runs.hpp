/// Motions of many oscillators, or of formulas, on a device, with the bits of the processor.
#pragma once

#include <cstddef>

#include "analysis/dynamics/oscillator_lanes.hpp"
#include "catalogue/device/device.hpp"

namespace hmax {

/// Runs on a device, one motion a thread. Several threads may call them: while the motions of one are on the
/// device, the others begin and judge theirs.
/// @param device   outlives the runs
/// @param at_once  motions of one call of the device, at most: a thread that has more takes several calls
/// @throws InputError  from `adaptive` and `own_steps`, where cosines are not those of musl, and from their
///                     runs, for forces of more than some 10^6 rad; from `formulas` and `formula_steps`, for
///                     operations that have other bits there or are too many; and as Device
MotionRunner motions_on(Device& device, std::size_t at_once);

}  // namespace hmax
