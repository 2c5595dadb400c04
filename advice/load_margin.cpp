#include "advice/load_margin.hpp"

#include <algorithm>
#include <cmath>

#include "bench/timing/timing.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

constexpr double largest = 8;  // times the loads

/// The largest change of a run.
double displacement_of(const Candidate& candidate, double h, const ProbingMotion& motion,
                       const Watcher& watcher) {
  double farthest = 0;
  const Eigen::VectorXd& y0 = motion.problem.y0;
  RunSpec spec = candidate.spec(h, motion.t_end);
  // As often as a motion of some hundred instants is looked at.
  if (candidate.method.device)
    spec.seen_every = std::max<std::int64_t>(1, std::llround(motion.t_end / h / 256));
  (void)candidate.method.bind(motion.problem)
      .run(spec, [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
        if (watcher) watcher();
        farthest = std::max(farthest, largest_change(motion.problem, y - y0));
      });
  return farthest;
}

/// A tool that went further and faster would touch for another time and elsewhere.
bool can_be_larger(const TissueSettings& settings) {
  return settings.tools.empty() &&
         (!settings.forces.empty() || std::ranges::any_of(settings.supports, [](const Support& support) {
           return !support.travel.isZero();
         }));
}

/// The amplitude P of the force of what is no body; null where it has none, or it is 0.
const double* amplitude(const Problem& problem) {
  const auto P = std::ranges::find(problem.parameters, "P", &std::pair<std::string, double>::first);
  return P != problem.parameters.end() && P->second != 0 ? &P->second : nullptr;
}

/// What larger_motion() makes larger; empty where that is nothing.
std::string larger_loads(const Problem& problem, bool can_make) {
  if (problem.body) return can_be_larger(settings_of(problem)) ? "loads" : "";
  std::string loads;
  if (can_make && amplitude(problem))
    loads = problem.kind() == ModelKind::oscillator ? "force" : "parameter P";
  if (!problem.y0.isZero(0)) loads += loads.empty() ? "initial state" : " and initial state";
  return loads;
}

}  // namespace

ProbingMotion larger_motion(const ProbingMotion& motion, double factor, const ProblemWith& make) {
  ProbingMotion larger = motion;
  if (motion.problem.body) {
    larger.problem = with_settings(motion.problem, [&](TissueSettings& settings) {
      for (PressingForce& force : settings.forces) force.force *= factor;
      for (Support& support : settings.supports) support.travel *= factor;
    });
    return larger;
  }
  if (const double* const P = amplitude(motion.problem); make && P)
    larger.problem = make({{"P", factor * *P}});
  larger.problem.y0 = factor * motion.problem.y0;
  return larger;
}

LoadMargin load_margin(const Candidate& candidate, double h, const ProbingMotion& motion,
                       const ReferenceMotion& reference, const ProblemWith& make, const Watcher& watcher,
                       double most_cpu) {
  LoadMargin margin{.loads = larger_loads(motion.problem, make != nullptr)};
  if (margin.loads.empty()) return margin;
  margin.inversion = first_inversion(motion, reference);
  if (margin.inversion) {
    margin.fails = 1;
    margin.of_model = true;
    return margin;
  }
  const CpuClock clock = cpu_clock();
  const double begun = clock();
  const auto is_late = [&] { return clock() - begun > most_cpu; };
  const auto judged = [&](double factor, double step) {
    return judged_step(candidate, larger_motion(motion, factor, make), reference, step, watcher);
  };
  double low = 1, high = infinity;
  const auto try_factor = [&](double factor) {
    const StepVerdict verdict = judged(factor, h);
    if (verdict.stable && !verdict.inversion) {
      low = factor;
      return;
    }
    high = factor;
    margin.inversion = verdict.inversion;
  };
  for (double factor = 2; factor <= largest && std::isinf(high) && !is_late(); factor *= 2)
    try_factor(factor);
  for (int i = 0; i < 2 && std::isfinite(high) && !is_late(); ++i) try_factor(std::sqrt(low * high));
  margin.holds = low;
  margin.fails = low < largest && std::isinf(high) ? LoadMargin::none : high;
  if (std::isfinite(high) && !is_late()) {
    const StepVerdict quarter = judged(high, h / 4);
    margin.of_model = !quarter.stable || quarter.inversion.has_value();
    // What a shorter step does not invert, the step does.
    if (!quarter.inversion) margin.inversion.reset();
  }
  margin.displacement = displacement_of(candidate, h, larger_motion(motion, low, make), watcher);
  return margin;
}

}  // namespace hmax
