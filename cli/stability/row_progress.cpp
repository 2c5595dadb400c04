#include "cli/stability/row_progress.hpp"

#include <algorithm>
#include <condition_variable>
#include <new>
#include <stop_token>
#include <system_error>
#include <utility>

#include <fmt/format.h>

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

RowProgress::RowProgress(Progress& progress, std::string task, std::function<double(std::size_t done)> share)
    : task_(std::move(task)),
      share_(std::move(share)),
      ticker_(1, [this, &progress](int) { show(progress); }) {}

void RowProgress::begin(const std::string& row) {
  const std::lock_guard lock(mutex_);
  running_.push_back({row, Clock::now()});
}

void RowProgress::end(const std::string& row) {
  const std::lock_guard lock(mutex_);
  std::erase_if(running_, [&](const Running& each) { return each.row == row; });
  ++done_;
}

void RowProgress::show(Progress& progress) {
  const std::lock_guard lock(mutex_);
  if (running_.empty()) return;
  const Running& longest = running_.front();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - longest.start).count();
  progress.update(share_(done_), fmt::format("{}{}, {} s", task_, longest.row, seconds));
}

}  // namespace hmax
