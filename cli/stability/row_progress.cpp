#include "cli/stability/row_progress.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <stop_token>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "bench/timing/timing.hpp"

namespace hmax {

Ticker::Ticker(int first, std::function<void(int seconds)> show) {
  const auto tick = [first, show = std::move(show)](const std::stop_token& end) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    int seconds = 0;
    for (int wait = first;; wait = 1) {
      wake.wait_for(lock, end, std::chrono::seconds(wait), [] { return false; });
      if (end.stop_requested()) return;
      show(seconds += wait);
    }
  };
  // Progress that there is no memory for is not shown; nothing may leave a thread.
  try {
    thread_ = std::jthread([tick](const std::stop_token& end) {
      try {
        tick(end);
      } catch (const std::bad_alloc&) {
      }
    });
  } catch (const std::system_error&) {
  }
}

long seconds_since(double start) { return static_cast<long>(elapsed_seconds() - start); }

std::string words_of_search(double residual, long seconds) {
  const std::string search =
      residual > 0 ? fmt::format("static equilibrium (residual {:.1e}), ", residual) : std::string();
  return fmt::format("{}fastest modes, {} s", search, seconds);
}

}  // namespace hmax
