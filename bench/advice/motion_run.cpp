#include "bench/advice/motion_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/timing/timing.hpp"
#include "core/pinned_thread.hpp"

namespace hmax {

namespace {

/// One run from the start; adds to `result`.
void run_once(const Candidate& candidate, const Runner& runner, const ProbingMotion& motion,
              const ReferenceMotion& reference, double frame, std::int64_t steps_per_frame, MotionRun& result) {
  const double frames = std::max(1.0, std::floor(motion.t_end / frame * (1 + 1e-12)));
  const double h = frame / static_cast<double>(steps_per_frame);
  std::int64_t step = -1;
  std::size_t instant = 0;
  double last = thread_cpu_seconds();
  const Sink sink = [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    ++step;
    if (step % steps_per_frame == 0 && step > 0) {
      const double now = thread_cpu_seconds();
      (step == steps_per_frame ? result.first_frame_s : result.frames_s.emplace_back()) = now - last;
    }
    if (instant < reference.t.size() && t >= reference.t[instant] - 0.25 * h)
      result.error = std::max(result.error, relative_error(motion, reference, instant++, y));
    if (step % steps_per_frame == 0) last = thread_cpu_seconds();
  };
  const RunRecord record = runner.run(candidate.spec(h, frames * frame), sink);
  result.outcome = record.outcome;
  result.t = record.t;
  result.steps += record.stats.steps;
  result.stats = record.stats;
  result.note = record.note;
  if (!result.reached_end() || !std::isfinite(result.error))
    result.error = std::numeric_limits<double>::infinity();
}

}  // namespace

FrameTimes frame_times(std::vector<double> frames_s) {
  if (frames_s.empty()) return {};
  std::ranges::sort(frames_s);
  const auto quantile = [&](double share) {
    return frames_s[static_cast<std::size_t>(std::ceil(share * static_cast<double>(frames_s.size()))) - 1];
  };
  return {quantile(0.5), quantile(0.99), frames_s.back()};
}

MotionRun run_motion(const Candidate& candidate, const ProbingMotion& motion, const ReferenceMotion& reference,
                     double frame, std::int64_t steps_per_frame, std::size_t frames, const Watcher& watcher) {
  const PinnedThread pinned;
  const Runner runner = candidate.method.bind(motion.problem);
  MotionRun result;
  do {
    if (watcher) watcher();
    const std::size_t before = result.frames_s.size();
    run_once(candidate, runner, motion, reference, frame, steps_per_frame, result);
    if (result.frames_s.size() == before) break;  // a motion of one frame
  } while (result.reached_end() && result.frames_s.size() < frames);
  return result;
}

bool holds(const Candidate& candidate, const ProbingMotion& motion, const ReferenceMotion& reference, double h) {
  constexpr double least_steps = 500, apart = 1e-8, parted = 1e-4;
  const bool of_body = motion.problem.body != nullptr;
  const double scale = std::max(reference.scale, std::numeric_limits<double>::min()),
               t_end = std::max(motion.t_end, least_steps * h);
  const auto end_of = [&](const Problem& problem) {
    return candidate.method.bind(problem).run(candidate.spec(h, t_end), {});
  };
  const RunRecord run = end_of(motion.problem);
  if (run.outcome != Outcome::reached_end) return false;
  // Another direction for each number, so that every mode has a part.
  Problem beside = motion.problem;
  const Eigen::Index moved = of_body ? beside.y0.size() / 2 : beside.y0.size();
  for (Eigen::Index i = 0; i < moved; ++i)
    beside.y0[i] += apart * scale * (2 * std::fmod(0.618033988749895 * static_cast<double>(i + 1), 1.0) - 1);
  const RunRecord neighbour = end_of(beside);
  return neighbour.outcome == Outcome::reached_end &&
         (neighbour.y - run.y).head(moved).cwiseAbs().maxCoeff() <= parted * scale;
}

}  // namespace hmax
