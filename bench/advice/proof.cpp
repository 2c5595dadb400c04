#include "bench/advice/proof.hpp"

#include <algorithm>
#include <cmath>

namespace hmax {

namespace {

ProofRun judged(const MotionRun& run, std::string words, const ProofPlan& plan) {
  ProofRun proof;
  proof.motion = std::move(words);
  proof.frames = run.frames_s.size();
  proof.seconds = static_cast<double>(proof.frames) * plan.frame;
  proof.stable = run.reached_end();
  proof.missed = static_cast<std::size_t>(
      std::ranges::count_if(run.frames_s, [&](double s) { return s > plan.budget; }));
  proof.frame_p999 = quantile(run.frames_s, 0.999);
  return proof;
}

}  // namespace

std::vector<ProofRun> prove(const Candidate& candidate, std::int64_t steps_per_frame, const ProbingMotion& motion,
                            const ReferenceMotion& reference, const ProofPlan& plan, const Watcher& watcher) {
  const auto frames = static_cast<std::size_t>(std::ceil(plan.seconds / plan.frame));
  std::vector<ProofRun> proofs;
  const auto run = [&](const ProbingMotion& of, const ReferenceMotion& against) {
    proofs.push_back(judged(run_motion(candidate, of, against, plan.frame, steps_per_frame, {.frames = frames}, watcher), of.words, plan));
  };
  const double h = plan.frame / static_cast<double>(steps_per_frame);
  run(motion, reference);
  proofs.back().stable = proofs.back().stable && holds(candidate, motion, reference, h);
  // One more: the first frame of a run is not timed.
  const ProbingMotion other = other_motion(motion, static_cast<double>(frames + 1) * plan.frame, plan.slowest);
  run(other, {});
  if (proofs.back().stable) {
    ProbingMotion shorter = other;
    shorter.t_end = std::min(other.t_end, 10 * motion.t_end);
    proofs.back().stable = holds(candidate, shorter, reference, h);
  }
  return proofs;
}

}  // namespace hmax
