#include "advice/proof.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/timing/timing.hpp"

namespace hmax {

namespace {

void record(ProofRun& proof, const MotionRun& run, const ProofPlan& plan) {
  proof.frames = run.frames_s.size();
  proof.seconds = static_cast<double>(proof.frames) * plan.frame;
  proof.missed = run.missed;
  proof.disturbed = run.disturbed;
  proof.frame_p999 = quantile(run.frames_s, 0.999);
  if (run.reached_end()) return;
  proof.stable = false;
  proof.why = fmt::format("it ends at t = {:.4g} s", run.t);
}

}  // namespace

std::vector<ProofRun> prove(const Candidate& candidate, std::int64_t steps_per_frame,
                            const ProbingMotion& motion, const ReferenceMotion& reference,
                            const ProofPlan& plan, const Watcher& watcher) {
  const auto frames = static_cast<std::size_t>(std::ceil(plan.seconds / plan.frame));
  const double h = plan.frame / static_cast<double>(steps_per_frame);
  std::vector<ProofRun> proofs;
  const double begun = thread_cpu_seconds();
  // Of the time the first motion leaves half to the second.
  const auto left = [&] {
    return plan.cpu * static_cast<double>(proofs.size()) / 2 - (thread_cpu_seconds() - begun);
  };
  // What is not stable is seen in a short run; the long one would only take its time.
  const auto run = [&](const ProbingMotion& of, double judged_to, const ReferenceMotion& against) {
    ProofRun& proof = proofs.emplace_back();
    proof.motion = of.words;
    ProbingMotion judged = of;
    judged.t_end = std::min(of.t_end, judged_to);
    StepVerdict verdict = judged_step(candidate, judged, reference, h, watcher);
    proof.stable = verdict.stable;
    proof.parts = verdict.parts;
    proof.why = std::move(verdict.why);
    proof.inversion = verdict.inversion;
    if (proof.stable)
      record(proof,
             run_motion(candidate, of, against, plan.frame, steps_per_frame,
                        {.frames = frames, .budget = plan.budget, .with_repeats = left()}, watcher),
             plan);
    else
      proof.seconds = judged.t_end;
    return proof.holds();
  };
  if (!run(motion, motion.t_end, reference)) return proofs;
  // One more: the first frame of a run is not timed.
  run(other_motion(motion, static_cast<double>(frames + 1) * plan.frame, plan.slowest), 10 * motion.t_end,
      {});
  return proofs;
}

}  // namespace hmax
