#include "bench/advice/motion_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/models/body_balance.hpp"
#include "bench/timing/timing.hpp"
#include "core/pinned_thread.hpp"

namespace hmax {

namespace {

/// Thrown out of a run that has left the motion.
struct Left {};

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
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (frames_s.empty()) return {nan, nan, nan};
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
  constexpr double least_steps = 500, most_size = 3;
  const bool of_body = motion.problem.body != nullptr;
  const Eigen::VectorXd& y0 = motion.problem.y0;
  const Eigen::Index n = y0.size() / 2;
  // Until the motion has ended a run may go as far as the reference goes, times three; after it as well.
  const double most = most_size * std::max(reference.scale, std::numeric_limits<double>::min());
  const double t_end = std::max(motion.t_end, least_steps * h);
  try {
    const RunRecord record = candidate.method.bind(motion.problem)
                                 .run(candidate.spec(h, t_end), [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
                                   const double away = of_body ? largest_displacement(y.head(n) - y0.head(n))
                                                               : y.cwiseAbs().maxCoeff();
                                   if (!(away <= most)) throw Left{};
                                 });
    return record.outcome == Outcome::reached_end;
  } catch (const Left&) {
    return false;
  }
}

}  // namespace hmax
