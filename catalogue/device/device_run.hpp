/// Runs of a body on a device, with the bits of the processor.
#pragma once

#include <cstdint>
#include <string>

#include "catalogue/device/device.hpp"
#include "catalogue/methods/method.hpp"
#include "catalogue/methods/run.hpp"

namespace hmax {

/// Why no device runs this, a sentence without its end; empty where one does: fixed steps of an explicit
/// structural method on a body that unsuited_for_patches() says nothing against.
std::string unsuited_for_device(const Problem& problem, const Method& method, const RunSpec& spec);

/// What a run came to and what its steps took.
struct DeviceRun {
  RunRecord record;             ///< in double precision the one of the processor, bit by bit
  double seconds = 0;           ///< by events of the device, without copies
  double flops = 0, bytes = 0;  ///< of a step: operations, and what it moves from and to the memory at least
};

/// Of the numbers that a device computes with.
enum class Precision : std::uint8_t { double_precision, single_precision };

/// @param spec  one that suits; `every` is not read
/// @throws InputError  as Device
DeviceRun run_on_device(Device& device, const Problem& problem, const Method& method, const RunSpec& spec,
                        Precision precision = Precision::double_precision);

}  // namespace hmax
