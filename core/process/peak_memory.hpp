/// The memory that a stretch of work needs.
#pragma once

#include <cstdint>
#include <optional>

namespace hmax {

/// Begins a stretch: what peak_memory() tells counts from here on. Nothing happens where the system has no
/// such peak.
void reset_peak_memory();

/// The largest resident memory of this process since then [bytes]; nothing where the system does not tell.
/// Linux: the high-water mark VmHWM of /proc/self/status, which counts all threads and shared pages that
/// are resident.
std::optional<std::int64_t> peak_memory();

}  // namespace hmax
