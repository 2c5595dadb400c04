#include "bench/two_threads.hpp"

#include <array>
#include <atomic>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

const auto quiet = [](std::size_t) {};
const auto never = [] { return false; };

TEST(TwoThreads, DoEveryPieceOnceAndSayWhoDoesIt) {
  std::vector<std::atomic<int>> times(1000);
  std::array<std::atomic<int>, 2> workers{};
  in_two_threads(
      times.size(),
      [&](std::size_t i, std::size_t worker) {
        ++times[i];
        ++workers.at(worker);
      },
      quiet, never);
  for (const auto& each : times) EXPECT_EQ(each, 1);
  EXPECT_EQ(workers[0] + workers[1], 1000);
}

TEST(TwoThreads, ThrowWhatOneOfThemThrew) {
  std::atomic<int> done = 0;
  const auto work = [&](std::size_t i, std::size_t) {
    if (i == 3) throw std::runtime_error("three");
    ++done;
  };
  EXPECT_THROW(in_two_threads(1000, work, quiet, never), std::runtime_error);
  EXPECT_LT(done, 1000);
}

TEST(TwoThreads, BeginNothingAfterAnInterruption) {
  std::atomic<int> done = 0;
  in_two_threads(
      1000, [&](std::size_t, std::size_t) { ++done; }, quiet, [&] { return done >= 5; });
  EXPECT_GE(done, 5);
  EXPECT_LE(done, 6);
}

}  // namespace
}  // namespace hmax
