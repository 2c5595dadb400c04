#include "core/process/memory_share.hpp"

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// The most of eight threads that hold a share of so many bytes at the same time.
int most_at_once(double bytes) {
  std::atomic<int> inside = 0, most = 0;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i)
      threads.emplace_back([&] {
        const MemoryShare share(bytes);
        const int now = ++inside;
        for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        --inside;
      });
  }
  return most;
}

TEST(MemoryShare, BoundsHowManyHoldOne) {
  const double all = shared_memory();
  ASSERT_GT(all, 0);
  EXPECT_EQ(most_at_once(0.6 * all), 1);
  EXPECT_LE(most_at_once(0.3 * all), 3);
  EXPECT_EQ(most_at_once(10 * all), 1) << "what is more than all goes alone";
}

}  // namespace
}  // namespace hmax
