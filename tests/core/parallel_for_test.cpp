#include "core/parallel_for.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <set>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "core/process/pinned_thread.hpp"
#include "tests/core/jobs.hpp"

namespace hmax {
namespace {

const auto quiet = [](std::size_t) {};
const auto never = [] { return false; };

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

TEST(ParallelFor, InsideAPieceTakesNoFurtherThread) {
  const Jobs three(3);
  std::vector<std::atomic<int>> times(20);
  parallel_for(4, [&](std::size_t outer, std::size_t) {
    const auto here = std::this_thread::get_id();
    parallel_for(5, [&](std::size_t inner, std::size_t worker) {
      EXPECT_EQ(worker, 0U);
      EXPECT_EQ(std::this_thread::get_id(), here);
      ++times[5 * outer + inner];
    });
  });
  for (const auto& each : times) EXPECT_EQ(each, 1);
}

TEST(ParallelFor, LeavesItsThreadsToWhatItsOnlyPieceCalls) {
  const Jobs two(2);
  std::atomic<bool> met = false;
  parallel_for(1, [&](std::size_t, std::size_t) {
    std::atomic<int> begun = 0;
    // Each of the two waits for the other.
    parallel_for(2, [&](std::size_t, std::size_t) {
      ++begun;
      for (int i = 0; i < 5000 && begun < 2; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      met = begun == 2;
    });
  });
  EXPECT_TRUE(met);
}

/// The threads of the system that do two pieces, each of which waits for the other to begin; one where they
/// never meet.
std::set<pid_t> two_that_meet() {
  std::atomic<int> begun = 0;
  std::array<pid_t, 2> who{};
  parallel_for(2, [&](std::size_t i, std::size_t) {
    who.at(i) = gettid();
    ++begun;
    for (int wait = 0; wait < 5000 && begun < 2; ++wait)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  return {who.begin(), who.end()};
}

TEST(ParallelFor, KeepsItsThreadsFromCallToCall) {
  const Jobs two(2);
  const auto first = two_that_meet();
  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(two_that_meet(), first);
}

TEST(ParallelFor, LeavesSignalsToTheThreadThatCallsIt) {
  const Jobs two(2);
  std::array<int, 2> blocked{};
  std::atomic<int> begun = 0;
  parallel_for(2, [&](std::size_t, std::size_t worker) {
    ++begun;
    for (int wait = 0; wait < 5000 && begun < 2; ++wait)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    sigset_t mask;
    pthread_sigmask(SIG_SETMASK, nullptr, &mask);
    blocked.at(worker) = sigismember(&mask, SIGTERM);
  });
  EXPECT_EQ(blocked, (std::array<int, 2>{0, 1}));
}

TEST(ParallelFor, HasThreadsAfterAFork) {
  const Jobs two(2);
  ASSERT_EQ(two_that_meet().size(), 2U);
  const pid_t child = fork();
  if (child == 0) _exit(static_cast<int>(two_that_meet().size()));
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 2);
}

TEST(ParallelFor, ServesSeveralCallersAtOnce) {
  const Jobs three(3);
  std::atomic<int> done = 0;
  {
    std::vector<std::jthread> callers;
    for (int caller = 0; caller < 4; ++caller)
      callers.emplace_back([&] {
        for (int call = 0; call < 200; ++call) parallel_for(5, [&](std::size_t, std::size_t) { ++done; });
      });
  }
  EXPECT_EQ(done, 4000);
}

TEST(OneThread, KeepsParallelForOnTheCallingThread) {
  const Jobs three(3);
  {
    const OneThread alone;
    parallel_for(100, [here = std::this_thread::get_id()](std::size_t, std::size_t) {
      EXPECT_EQ(std::this_thread::get_id(), here);
    });
  }
  const PinnedThread pinned;
  parallel_for(100, [here = std::this_thread::get_id()](std::size_t, std::size_t) {
    EXPECT_EQ(std::this_thread::get_id(), here);
  });
}

TEST(ThreadLimit, HoldsForTheCallingThreadAndWithinAnother) {
  const Jobs three(3);
  // Waits for a worker that ought to come, a busy machine may start it late, and a moment for one that ought
  // not.
  const auto greatest_worker = [](std::size_t expected) {
    std::atomic<std::size_t> greatest = 0;
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    parallel_for(300, [&](std::size_t, std::size_t worker) {
      for (std::size_t seen = greatest; seen < worker && !greatest.compare_exchange_weak(seen, worker);) {
      }
      do std::this_thread::sleep_for(std::chrono::microseconds(100));
      while (greatest < expected && std::chrono::steady_clock::now() < patience);
    });
    return greatest.load();
  };
  EXPECT_EQ(greatest_worker(2), 2U);
  {
    const ThreadLimit two(2);
    EXPECT_EQ(greatest_worker(1), 1U);
    const ThreadLimit more(3);
    EXPECT_EQ(greatest_worker(1), 1U);
  }
  EXPECT_EQ(greatest_worker(2), 2U);
}

TEST(ParallelMap, KeepsTheOrder) {
  const Jobs three(3);
  const auto squares = parallel_map(100, [](std::size_t i) { return i * i; });
  ASSERT_EQ(squares.size(), 100U);
  for (std::size_t i = 0; i < squares.size(); ++i) EXPECT_EQ(squares[i], i * i);
}

}  // namespace
}  // namespace hmax
