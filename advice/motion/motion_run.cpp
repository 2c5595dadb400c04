#include "advice/motion/motion_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/timing/timing.hpp"
#include "core/process/pinned_thread.hpp"

namespace hmax {

namespace {

/// Ends a run from its sink.
struct TooSlow {};

/// What a run has done to solve its equations, frame by frame.
struct WorkOfFrames {
  ImplicitWork work;
  std::int64_t newton = 0, linear_iterations = 0;  ///< up to the frame before

  void end_frame(MotionRun& result) {
    result.newton.push_back(static_cast<double>(work.newton - newton));
    result.linear_iterations.push_back(static_cast<double>(work.linear_iterations - linear_iterations));
    newton = work.newton;
    linear_iterations = work.linear_iterations;
  }
};

/// One run from the start; adds to `result`.
/// @param most_per_frame  as RunLength has it
void run_once(const Candidate& candidate, const Runner& runner, const ProbingMotion& motion,
              const ReferenceMotion& reference, double frame, std::int64_t steps_per_frame,
              double most_per_frame, const Watcher& watcher, MotionRun& result) {
  constexpr double least_run = 1, least_first_frame = 20;  // [s]
  constexpr std::int64_t least_frames = 5, looked_every = 256;
  const double frames = std::max(1.0, std::floor(motion.t_end / frame * (1 + 1e-12)));
  const double h = frame / static_cast<double>(steps_per_frame);
  // Instants are ends of frames.
  const std::int64_t seen_every = runner.seconds ? steps_per_frame : 1;
  const auto clock = clock_of(runner);
  std::int64_t step = -seen_every;
  std::size_t instant = 0;
  WorkOfFrames work;
  double last = clock(), start = last;
  const auto look_at_the_clock = [&] {
    const double now = clock();
    const bool in_first = step < steps_per_frame;
    if (step == steps_per_frame) start = now;
    const std::int64_t begun = std::max(least_frames, step / steps_per_frame);
    const double least = in_first ? least_first_frame : least_run;
    if (now - start < std::max(least, most_per_frame * static_cast<double>(begun))) return;
    // The frame at hand takes at least this long.
    if (step % steps_per_frame != 0)
      (in_first ? result.first_frame_s : result.frames_s.emplace_back()) = now - last;
    throw TooSlow{};
  };
  const Sink sink = [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    step += seen_every;
    if (step % steps_per_frame == 0 && step > 0) {
      const double now = clock();
      (step == steps_per_frame ? result.first_frame_s : result.frames_s.emplace_back()) = now - last;
      work.end_frame(result);
    }
    if (instant < reference.t.size() && t >= reference.t[instant] - 0.25 * h)
      result.error = std::max(result.error, relative_error(motion, reference, instant++, y));
    if (step % steps_per_frame == 0 || step % looked_every == 0) {
      if (watcher) watcher();
      if (std::isfinite(most_per_frame)) look_at_the_clock();
    }
    if (step % steps_per_frame == 0) last = clock();
  };
  RunSpec spec = candidate.spec(h, frames * frame);
  spec.work = &work.work;
  spec.seen_every = seen_every;
  RunRecord record;
  try {
    record = runner.run(spec, sink);
  } catch (const TooSlow&) {
    record.outcome = Outcome::stopped;
    record.t = static_cast<double>(step) * h;
    record.stats.steps = step;
  }
  result.outcome = record.outcome;
  result.t = record.t;
  result.steps += record.stats.steps;
  result.stats = record.stats;
  result.note = record.note;
  if (!result.reached_end() || !std::isfinite(result.error))
    result.error = std::numeric_limits<double>::infinity();
}

}  // namespace

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(at));
  return values[at];
}

FrameTimes frame_times(const std::vector<double>& frames_s) {
  FrameTimes times{quantile(frames_s, 0.5), quantile(frames_s, 0.99), quantile(frames_s, 1)};
  for (const double share : frame_shares)
    if (share * static_cast<double>(frames_s.size()) >= 1)
      times.tail.push_back(quantile(frames_s, 1 - share));
  return times;
}

std::vector<double> middle_times(const std::array<std::vector<double>, 3>& runs) {
  std::vector<double> middle(runs[0].size());
  for (std::size_t i = 0; i < middle.size(); ++i) {
    const double a = runs[0][i], b = runs[1][i], c = runs[2][i];
    middle[i] = std::max(std::min(a, b), std::min(std::max(a, b), c));
  }
  return middle;
}

namespace {

/// From the start again until there are as many frames as asked for.
MotionRun repeated(const Candidate& candidate, const Runner& runner, const ProbingMotion& motion,
                   const ReferenceMotion& reference, double frame, std::int64_t steps_per_frame,
                   const RunLength& length, const Watcher& watcher) {
  MotionRun result;
  do {
    const std::size_t before = result.frames_s.size();
    run_once(candidate, runner, motion, reference, frame, steps_per_frame, length.most_per_frame, watcher,
             result);
    if (result.frames_s.size() == before) break;  // a motion of one frame
  } while (result.reached_end() && result.frames_s.size() < length.frames);
  return result;
}

}  // namespace

MotionRun run_motion(const Candidate& candidate, const ProbingMotion& motion,
                     const ReferenceMotion& reference, double frame, std::int64_t steps_per_frame,
                     const RunLength& length, const Watcher& watcher) {
  const PinnedThread pinned;
  const Runner runner = candidate.method.bind(motion.problem);
  const auto run = [&] {
    return repeated(candidate, runner, motion, reference, frame, steps_per_frame, length, watcher);
  };
  const auto late = [&](const std::vector<double>& frames_s) {
    return static_cast<std::size_t>(
        std::ranges::count_if(frames_s, [&](double s) { return s > length.budget; }));
  };
  const auto clock = clock_of(runner);
  const double begun = clock();
  MotionRun result = run();
  const double taken = clock() - begun;
  result.missed = late(result.frames_s);
  const std::size_t frames = result.frames_s.size();
  if (!result.reached_end() || !is_late(result.missed, frames) || is_surely_late(result.missed, frames) ||
      3 * taken > length.with_repeats)
    return result;
  std::array<std::vector<double>, 3> times{result.frames_s};
  for (std::size_t i = 1; i < times.size(); ++i) {
    times[i] = run().frames_s;
    if (times[i].size() != frames) return result;
  }
  result.frames_s = middle_times(times);
  for (std::size_t i = 0; i < frames; ++i)
    if (times[0][i] > length.budget && result.frames_s[i] <= length.budget) ++result.disturbed;
  result.missed = late(result.frames_s);
  return result;
}

}  // namespace hmax
