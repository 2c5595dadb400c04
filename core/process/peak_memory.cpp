#include "core/process/peak_memory.hpp"

#include <fstream>
#include <string>

#include "core/process/heap.hpp"

namespace hmax {

// Writing 5 to clear_refs sets the high-water mark back to the present resident size (Linux 4.0 and later,
// proc(5)).
void reset_peak_memory() {
  return_freed_memory();
  std::ofstream("/proc/self/clear_refs") << "5";
}

std::optional<std::int64_t> peak_memory() {
  std::ifstream status("/proc/self/status");
  std::string word;
  // A line of the form "VmHWM:   123456 kB".
  while (status >> word)
    if (std::int64_t kilobytes = 0; word == "VmHWM:" && status >> kilobytes) return 1024 * kilobytes;
  return std::nullopt;
}

}  // namespace hmax
