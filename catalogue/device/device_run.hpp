/// Runs of a body on a device, with the bits of the processor.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "catalogue/device/device.hpp"
#include "catalogue/methods/method.hpp"
#include "catalogue/methods/run.hpp"

namespace hmax {

/// Why no device runs fixed steps of the method on the problem, "runs ..."; empty where one does.
std::string unsuited_for_device(const Problem& problem, const Method& method);

/// The method with its runs on a device: fixed steps with the bits of the processor, and times of the device.
/// Its runners share what the device has of the body that was bound last: one runs at a time. What is no body
/// stays on the processor.
Method on_device(Method method, const std::shared_ptr<Device>& device);

/// What a run came to and what its steps took.
struct DeviceRun {
  RunRecord record;             ///< in double precision the one of the processor, bit by bit
  double seconds = 0;           ///< by events of the device, without copies
  double flops = 0, bytes = 0;  ///< of a step of all bodies: operations, and what it moves at least
};

/// Of the numbers that a device computes with.
enum class Precision : std::uint8_t { double_precision, single_precision };

/// @param spec    one that suits; `every` is not read
/// @param bodies  that run at a time, all of them from the start of the problem
/// @throws InputError  as Device
DeviceRun run_on_device(Device& device, const Problem& problem, const Method& method, const RunSpec& spec,
                        Precision precision = Precision::double_precision, std::int32_t bodies = 1);

}  // namespace hmax
