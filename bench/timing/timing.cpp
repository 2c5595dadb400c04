#include "bench/timing/timing.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <ctime>

#include "catalogue/methods/run.hpp"
#include "core/parallel_for.hpp"

namespace hmax {

namespace {

double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double thread_cpu_seconds() { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }

CpuClock cpu_clock() {
  return threads() > 1 ? [] { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); } : CpuClock(thread_cpu_seconds);
}

std::function<double()> clock_of(const Runner& runner) {
  return runner.seconds ? runner.seconds : thread_cpu_seconds;
}

double elapsed_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<Timing> time_interleaved(std::span<const std::function<void(std::int64_t runs)>> candidates,
                                     const TimingOptions& options) {
  const OneThread alone;
  const std::function<double()> clock = options.clock ? options.clock : thread_cpu_seconds;
  const auto seconds_of_runs = [&](const std::function<void(std::int64_t)>& candidate, std::int64_t runs) {
    const double before = clock();
    candidate(runs);
    return clock() - before;
  };
  const auto stopped = [&] { return options.keep_going && !options.keep_going(); };
  // A clock may never move, as that of a device that has nothing to do.
  const double longest = 1000 * options.min_sample_s;
  std::vector<Timing> timings(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    std::int64_t& runs = timings[i].runs_per_sample;
    for (;;) {
      if (stopped()) return {};
      const double begun = elapsed_seconds(), seconds = seconds_of_runs(candidates[i], runs);
      if (seconds >= options.min_sample_s || elapsed_seconds() - begun > longest) break;
      // Aims a little beyond the target: a sample at its edge would be tried again.
      const double wanted = seconds > 0 ? 1.2 * options.min_sample_s / seconds : 1024;
      runs *= static_cast<std::int64_t>(std::clamp(std::ceil(wanted), 2.0, 1024.0));
    }
  }
  for (int repetition = 0; repetition < options.repetitions; ++repetition) {
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (stopped()) return {};
      const std::int64_t runs = timings[i].runs_per_sample;
      timings[i].samples.push_back(seconds_of_runs(candidates[i], runs) / static_cast<double>(runs));
    }
  }
  return timings;
}

}  // namespace hmax
