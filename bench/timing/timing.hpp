/// Time of repeated runs, by the CPU or by a clock of their own; several candidates in turn.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace hmax {

/// CPU time that the calling thread has used so far [s]. One reading costs about 200 ns: time batches.
double thread_cpu_seconds();

/// The clock of what the calling thread does next: thread_cpu_seconds(), or where it may use others the CPU
/// time of all threads of the process [s]. Both readings of a difference are of one clock.
using CpuClock = double (*)();
CpuClock cpu_clock();

struct Runner;  // catalogue/methods/run.hpp
/// The clock of what its runs take: of their device, or thread_cpu_seconds() [s].
std::function<double()> clock_of(const Runner& runner);

/// Of a clock that only goes forwards [s].
double elapsed_seconds();

struct TimingOptions {
  int repetitions = 9;  ///< samples of each candidate, at least 1
  /// Time of one sample, for the clock to resolve it well, unless it takes 1000 times as long [s].
  double min_sample_s = 2e-3;
  /// Of all candidates, such as that of their device [s]. Empty: thread_cpu_seconds().
  std::function<double()> clock{};
  /// Asked before every sample; false ends the timing. Empty: never asked.
  std::function<bool()> keep_going{};
};

/// What was measured of one candidate.
struct Timing {
  std::vector<double> samples;       ///< time of one run, one entry for each repetition in order [s]
  std::int64_t runs_per_sample = 1;  ///< runs timed together

  /// Of the fastest sample; there must be one [s].
  [[nodiscard]] double least() const { return std::ranges::min(samples); }
};

/// `once` as a candidate.
template <class Once>
std::function<void(std::int64_t)> repeated(Once once) {
  return [once = std::move(once)](std::int64_t runs) mutable {
    for (std::int64_t i = 0; i < runs; ++i) once();
  };
}

/// Times candidates against one another. First each is tried with one run, then with more, until a sample
/// takes min_sample_s; the last of these trials is also its warm-up. Then every repetition goes over all
/// candidates (A B C A B C ...), so that a machine that slows down for a while slows all of them. All of it
/// runs on the calling thread, see OneThread.
/// @param candidates  each called as candidate(runs), runs >= 1; must do the same work each time
/// @returns one entry for each candidate, in their order; empty when keep_going ended it
std::vector<Timing> time_interleaved(std::span<const std::function<void(std::int64_t runs)>> candidates,
                                     const TimingOptions& options = {});

}  // namespace hmax
