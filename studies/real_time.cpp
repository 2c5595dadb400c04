#include "studies/real_time.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "advice/motion/motion_run.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/families.hpp"
#include "catalogue/models/problems.hpp"
#include "core/numbers.hpp"
#include "core/text/sentences.hpp"
#include "limits/fidelity/fidelity.hpp"

namespace hmax {

namespace {

/// A load with all that is compared with.
struct LoadedBody {
  ProbingMotion motion;
  std::map<double, ReferenceMotion> references{};  ///< by rate
};

LoadedBody loaded_body(const RealTimeQuestion& question, const char* load, const Watcher& watcher) {
  LoadedBody made{.motion =
                      probing_motion(make_problem(fmt::format("fem_neo_hookean/{}@{}", load, question.body),
                                                  {.material = question.material}),
                                     watcher)};
  constexpr double tolerance = 1e-3;
  for (const double rate : question.rates)
    made.references.emplace(rate, reference_motion(made.motion, 1 / rate, tolerance, watcher));
  return made;
}

/// Whether the motion ends, and not far from where it should.
bool holds(const MotionRun& run) { return run.reached_end() && run.error < 0.1; }

/// NaN where the run was stopped for its time.
double error_of(const MotionRun& run) {
  return run.outcome == Outcome::stopped ? RealTimeRow::none : run.error;
}

/// Steps in a frame: one, of explicit methods a power of two of them that holds the motions; 0 where none
/// does.
std::int64_t steps_that_hold(const Candidate& candidate, const std::vector<const LoadedBody*>& bodies,
                             double rate, const Watcher& watcher) {
  constexpr std::int64_t most = 4096;
  for (std::int64_t steps = 1; steps <= most; steps *= 2)
    if (!candidate.method.is_explicit || std::ranges::all_of(bodies, [&](const LoadedBody* body) {
          return holds(
              run_motion(candidate, body->motion, body->references.at(rate), 1 / rate, steps, {}, watcher));
        }))
      return steps;
  return 0;
}

/// What the steps of a frame show; an explicit method takes them in parts.
void show_material(RealTimeRow& row, const Method& method, const FidelityModel& model, bool ceiling) {
  const FidelityQuestion question{.h = 1 / row.rate};
  const Fidelity shown = fidelity(method, model, question);
  row.stiffness_shown = shown.stiffness_shown;
  if (!shown.modes.empty()) {
    row.damping_added = shown.modes.front().zeta_shown - shown.modes.front().zeta;
    row.frequency_shift = shown.modes.front().omega_shown / shown.modes.front().omega - 1;
  }
  add_sentence(row.status, shown.status);
  if (std::isnan(row.stiffness_shown)) return;
  if (method.parameter("iterations")) {
    if (ceiling) row.stiffness_ceiling = stiffness_ceiling(method, model, question, row.stiffness_shown);
  } else if (!method.is_explicit) {
    row.stiffness_ceiling = infinity;  // its equations are solved; explicit steps grow before
  }
}

RealTimeRow measured_row(const RealTimeQuestion& question, const Candidate& candidate, double rate,
                         const LoadedBody& pressed, const LoadedBody& grasped, const FidelityModel& model,
                         const Watcher& watcher) {
  RealTimeRow row{.rate = rate, .method = candidate.words()};
  if (const Family* family = family_of(candidate.method)) row.family = family->words;
  row.steps = steps_that_hold(candidate, {&pressed, &grasped}, rate, watcher);
  if (row.steps == 0) {
    row.status = "no number of steps holds the motion";
    return row;
  }
  // A frame that takes ten times its time is late enough.
  const RunLength length{.frames = question.frames, .most_per_frame = 10 / rate, .budget = 1 / rate};
  const auto run = [&](const LoadedBody& body, const RunLength& its) {
    return run_motion(candidate, body.motion, body.references.at(rate), 1 / rate, row.steps, its, watcher);
  };
  const MotionRun timed = run(pressed, length);
  if (timed.outcome == Outcome::stopped) row.status = "stopped: its frames take ten times their time";
  row.error_pressed = error_of(timed);
  row.frame_p99 = frame_times(timed.frames_s).p99;
  row.frames = timed.frames_s.size();
  row.missed = timed.missed;
  row.error_grasped = error_of(run(grasped, {.most_per_frame = 10 / rate}));
  const Method method = row.steps == 1
                            ? candidate.method
                            : find_method(fmt::format("{}:substeps={}", candidate.method.id, row.steps));
  show_material(row, method, model, rate <= question.ceilings_up_to);
  return row;
}

}  // namespace

std::vector<Candidate> real_time_candidates() {
  std::vector<Candidate> all;
  for (const char* name :
       {"symplectic_euler", "rk4", "rkc_2", "linearly_implicit_euler", "implicit_euler", "newmark", "tr_bdf2",
        "newton_truncated:iterations=1,cg=10", "newton_truncated:iterations=3,cg=20",
        "projective_dynamics:iterations=10", "vbd:iterations=10", "vbd:iterations=1,substeps=10",
        "vbd:iterations=50", "xpbd:iterations=10", "xpbd:iterations=1,substeps=10",
        "xpbd:iterations=5,substeps=20"})
    all.push_back({.method = find_method(name)});
  all.push_back({.method = find_method("linearly_implicit_euler"), .jacobian = {JacobianUpdate::frozen}});
  return all;
}

std::vector<RealTimeRow> real_time_study(const RealTimeQuestion& question,
                                         const std::vector<Candidate>& candidates,
                                         const std::function<void(double, const std::string&)>& progress) {
  std::vector<RealTimeRow> rows;
  const auto total = static_cast<double>(question.rates.size() * candidates.size());
  std::string next = "the motions";
  const Watcher watcher = [&] { progress(static_cast<double>(rows.size()) / total, next); };
  const LoadedBody pressed = loaded_body(question, "press", watcher),
                   grasped = loaded_body(question, "pull", watcher);
  const FidelityModel model = fidelity_model(
      make_problem(fmt::format("fem_neo_hookean/press@{}", question.body), {.material = question.material}),
      watcher);
  for (const double rate : question.rates)
    for (const Candidate& candidate : candidates) {
      next = fmt::format("{} at {} Hz", candidate.method.id, rate);
      watcher();
      rows.push_back(measured_row(question, candidate, rate, pressed, grasped, model, watcher));
    }
  return rows;
}

}  // namespace hmax
