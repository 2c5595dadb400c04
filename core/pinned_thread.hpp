/// Timing without migration from one processor to another.
#pragma once

#include <sched.h>

namespace hmax {

/// Keeps the calling thread on the processor that it runs on, as long as this lives. Where the system
/// refuses, nothing changes.
class PinnedThread {
 public:
  /// Narrows the affinity mask of the calling thread to the processor that it runs on now.
  PinnedThread();
  /// Restores the mask; to be called by the same thread.
  ~PinnedThread();
  PinnedThread(const PinnedThread&) = delete;
  PinnedThread& operator=(const PinnedThread&) = delete;

  /// Whether the thread is kept.
  [[nodiscard]] bool pinned() const { return pinned_; }

 private:
  // The mask of the thread before, restored at the end.
  cpu_set_t before_{};
  bool pinned_ = false;
};

}  // namespace hmax
