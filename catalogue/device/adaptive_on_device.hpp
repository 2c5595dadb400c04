/// Chosen steps of a body on a device.
#pragma once

#include "catalogue/device/body_on_device.hpp"
#include "catalogue/methods/method.hpp"
#include "catalogue/methods/run.hpp"

namespace hmax {

/// A run of the loop and the control of the processor: attempts and their errors are computed on the device,
/// what becomes of them is decided here.
/// @param body     of a method with an error estimate, and that of the problem
/// @param spec     adaptive
/// @throws InputError  where the method has none, and as Device
RunRecord run_adaptive(BodyOnDevice<double>& body, const Problem& problem, const RunSpec& spec);

}  // namespace hmax
