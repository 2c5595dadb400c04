#include "core/process/memory_share.hpp"

#include <cmath>
#include <condition_variable>
#include <mutex>
#include <unistd.h>

namespace hmax {

namespace {

/// What is taken in this process; guarded by `mutex`.
struct Shared {
  std::mutex mutex;
  std::condition_variable freed;
  double taken = 0;  ///< sum of the shares that are held [bytes]
  int holders = 0;   ///< how many are held: at zero the next one is let in whatever its size
};

/// One for the process, made at the first use, so that the order of static initialisers does not matter.
Shared& shared() {
  static Shared one;
  return one;
}

}  // namespace

double bytes_of_factor(double rows) { return 3e3 * rows + 670 * std::pow(rows, 4.0 / 3); }

double shared_memory() {
  // Physical memory, not what is free at this moment: that would make results depend on other programs.
  return 0.5 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

MemoryShare::MemoryShare(double bytes) : bytes_(bytes) {
  Shared& all = shared();
  std::unique_lock lock(all.mutex);
  // A share of more than the whole is let in only when it is alone, so that no request waits for ever.
  all.freed.wait(lock, [&] { return all.holders == 0 || all.taken + bytes_ <= shared_memory(); });
  all.taken += bytes_;
  ++all.holders;
}

MemoryShare::~MemoryShare() {
  Shared& all = shared();
  {
    const std::lock_guard lock(all.mutex);
    --all.holders;
    // Back to exactly zero when the last one ends: rounding of sums does not build up.
    all.taken = all.holders == 0 ? 0 : all.taken - bytes_;
  }
  // All, since those that wait need different amounts: the first one woken might not fit while another
  // does.
  all.freed.notify_all();
}

}  // namespace hmax
