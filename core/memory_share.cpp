#include "core/memory_share.hpp"

#include <condition_variable>
#include <mutex>
#include <unistd.h>

namespace hmax {

namespace {

struct Shared {
  std::mutex mutex;
  std::condition_variable freed;
  double taken = 0;
  int holders = 0;
};

Shared& shared() {
  static Shared one;
  return one;
}

}  // namespace

double shared_memory() {
  return 0.5 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

MemoryShare::MemoryShare(double bytes) : bytes_(bytes) {
  Shared& all = shared();
  std::unique_lock lock(all.mutex);
  all.freed.wait(lock, [&] { return all.holders == 0 || all.taken + bytes_ <= shared_memory(); });
  all.taken += bytes_;
  ++all.holders;
}

MemoryShare::~MemoryShare() {
  Shared& all = shared();
  {
    const std::lock_guard lock(all.mutex);
    --all.holders;
    all.taken = all.holders == 0 ? 0 : all.taken - bytes_;
  }
  all.freed.notify_all();
}

}  // namespace hmax
