#include "core/parallel_for.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

const auto quiet = [](std::size_t) {};
const auto never = [] { return false; };

/// So many threads as long as this lives.
class Jobs {
 public:
  explicit Jobs(std::size_t count) : before_(jobs()) { set_jobs(count); }
  ~Jobs() { set_jobs(before_); }
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

 private:
  std::size_t before_;
};

TEST(ParallelFor, DoesEveryPieceOnceAndSaysWhoDoesIt) {
  const Jobs four(4);
  std::vector<std::atomic<int>> times(1000);
  std::array<std::atomic<int>, 4> workers{};
  parallel_for(
      times.size(),
      [&](std::size_t i, std::size_t worker) {
        ++times[i];
        ++workers.at(worker);
      },
      quiet, never);
  for (const auto& each : times) EXPECT_EQ(each, 1);
  EXPECT_EQ(workers[0] + workers[1] + workers[2] + workers[3], 1000);
}

TEST(ParallelFor, ThrowsWhatOneOfThemThrew) {
  const Jobs two(2);
  std::atomic<int> done = 0;
  const auto work = [&](std::size_t i, std::size_t) {
    if (i == 0) throw std::runtime_error("the first");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ++done;
  };
  EXPECT_THROW(parallel_for(1000, work, quiet, never), std::runtime_error);
  EXPECT_LT(done, 500);  // the others stop
}

TEST(ParallelFor, BeginsNothingAfterAnInterruption) {
  const Jobs two(2);
  std::atomic<int> done = 0;
  parallel_for(
      1000, [&](std::size_t, std::size_t) { ++done; }, quiet, [&] { return done >= 5; });
  EXPECT_GE(done, 5);
  EXPECT_LE(done, 6);
}

TEST(ParallelFor, GivesTheSameForAnyNumberOfThreads) {
  const auto results = [](std::size_t threads) {
    const Jobs those(threads);
    std::vector<double> values(100);
    parallel_for(
        values.size(), [&](std::size_t i, std::size_t) { values[i] = 1.0 / (3.0 + static_cast<double>(i)); },
        quiet, never);
    return values;
  };
  EXPECT_EQ(results(1), results(3));
  EXPECT_EQ(results(1), results(7));
}

TEST(ParallelFor, TakesNoMoreThreadsThanThereArePieces) {
  const Jobs many(64);
  std::atomic<std::size_t> highest = 0;
  parallel_for(
      2, [&](std::size_t, std::size_t worker) { highest = std::max<std::size_t>(highest, worker); }, quiet,
      never);
  EXPECT_LT(highest, 2U);
  parallel_for(
      0, [](std::size_t, std::size_t) { FAIL(); }, quiet, never);
}

}  // namespace
}  // namespace hmax
