/// Timing without migration from one processor to another.
#pragma once

#include <sched.h>

#include "core/parallel_for.hpp"

namespace hmax {

/// Keeps the calling thread on the processor that it runs on, without threads of parallel_for() beside it, as
/// long as this lives. Where the system refuses, it stays one thread.
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
  OneThread alone_;
  cpu_set_t before_{};  ///< the mask of the thread, restored at the end
  bool pinned_ = false;
};

}  // namespace hmax
