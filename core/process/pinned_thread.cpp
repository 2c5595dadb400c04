#include "core/process/pinned_thread.hpp"

namespace hmax {

PinnedThread::PinnedThread() {
  // A migration costs the contents of the caches and, between cores of different clocks, the comparability
  // of timings.
  const int here = sched_getcpu();
  if (here < 0 || sched_getaffinity(0, sizeof before_, &before_) != 0) return;
  // The first argument 0 of these calls is the calling thread, not the process.
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<unsigned>(here), &one);
  pinned_ = sched_setaffinity(0, sizeof one, &one) == 0;
}

PinnedThread::~PinnedThread() {
  if (pinned_) sched_setaffinity(0, sizeof before_, &before_);
}

}  // namespace hmax
