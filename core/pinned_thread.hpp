/// Timing without migration from one processor to another.
#pragma once

#include <sched.h>

namespace hmax {

/// Keeps the calling thread on the processor that it runs on, as long as this lives. Where the system refuses,
/// nothing changes.
class PinnedThread {
 public:
  PinnedThread();
  ~PinnedThread();
  PinnedThread(const PinnedThread&) = delete;
  PinnedThread& operator=(const PinnedThread&) = delete;

  /// Whether the thread is kept.
  [[nodiscard]] bool pinned() const { return pinned_; }

 private:
  cpu_set_t before_{};
  bool pinned_ = false;
};

}  // namespace hmax
