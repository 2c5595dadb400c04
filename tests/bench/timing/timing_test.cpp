#include "bench/timing/timing.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

using Candidate = std::function<void(std::int64_t)>;

/// Uses the processor for about `seconds` a run.
Candidate burning(double seconds) {
  return [seconds](std::int64_t runs) {
    for (std::int64_t run = 0; run < runs; ++run)
      for (const double start = thread_cpu_seconds(); thread_cpu_seconds() - start < seconds;) {
      }
  };
}

TEST(Timing, TheClockCountsTheWorkOfThisThreadAndNotItsSleep) {
  const double start = thread_cpu_seconds();
  timespec pause{.tv_sec = 0, .tv_nsec = 50'000'000};
  nanosleep(&pause, nullptr);
  EXPECT_LT(thread_cpu_seconds() - start, 0.02);
  burning(0.01)(1);
  EXPECT_GE(thread_cpu_seconds() - start, 0.01);
}

TEST(Timing, EverySampleIsLongEnoughForTheClockAndGivenPerRun) {
  const std::vector<Candidate> candidates{burning(2e-5), burning(4e-3)};
  const auto timings = time_interleaved(candidates, {.repetitions = 5, .min_sample_s = 2e-3});
  ASSERT_EQ(timings.size(), 2u);
  for (const Timing& timing : timings) EXPECT_EQ(timing.samples.size(), 5u);
  EXPECT_GE(timings[0].runs_per_sample, 20);
  EXPECT_EQ(timings[1].runs_per_sample, 1);
  for (const double sample : timings[0].samples) {
    EXPECT_GE(sample, 2e-5);
    EXPECT_LT(sample, 2e-4);
  }
  for (const double sample : timings[1].samples) EXPECT_GE(sample, 4e-3);
}

TEST(Timing, TheRepetitionsGoOverAllCandidatesInTurnAfterOneWarmUpEach) {
  std::string order;
  const std::vector<Candidate> candidates{
      [&](std::int64_t) { order += 'A', burning(1e-4)(1); },
      [&](std::int64_t) { order += 'B', burning(1e-4)(1); },
      [&](std::int64_t) { order += 'C', burning(1e-4)(1); },
  };
  time_interleaved(candidates, {.repetitions = 3, .min_sample_s = 5e-5});
  EXPECT_EQ(order,
            "ABC"
            "ABCABCABC");
}

TEST(Timing, ACandidateThatCostsNothingStillEnds) {
  const std::vector<Candidate> candidates{[](std::int64_t runs) {
    for (std::int64_t run = 0; run < runs; ++run) asm volatile("");
  }};
  EXPECT_EQ(time_interleaved(candidates, {.repetitions = 2, .min_sample_s = 1e-4})[0].samples.size(), 2u);
}

TEST(Timing, IsByTheClockThatIsGiven) {
  constexpr double of_a_run = 1.0 / 256;  // differences of such times are exact
  double now = 0;
  const std::vector<Candidate> candidates{repeated([&] { now += of_a_run; })};
  const Timing timing = time_interleaved(
      candidates, {.repetitions = 4, .min_sample_s = 1.5 * of_a_run, .clock = [&] { return now; }})[0];
  EXPECT_EQ(timing.runs_per_sample, 2);
  EXPECT_EQ(timing.samples, std::vector<double>(4, of_a_run));
}

TEST(Timing, EndsByAClockThatStandsStill) {
  const std::vector<Candidate> candidates{repeated([] { burning(1e-5)(1); })};
  const Timing timing =
      time_interleaved(candidates, {.repetitions = 2, .min_sample_s = 1e-6, .clock = [] { return 1.0; }})[0];
  EXPECT_EQ(timing.samples, std::vector<double>(2, 0));
  EXPECT_LT(timing.runs_per_sample, std::int64_t{1} << 21);
}

TEST(Timing, CanBeEndedBetweenSamples) {
  int asked = 0, called = 0;
  const std::vector<Candidate> candidates{[&](std::int64_t) { ++called, burning(1e-4)(1); }};
  EXPECT_TRUE(
      time_interleaved(candidates,
                       {.repetitions = 100, .min_sample_s = 5e-5, .keep_going = [&] { return ++asked < 5; }})
          .empty());
  EXPECT_EQ(called, 4);
}

}  // namespace
}  // namespace hmax
