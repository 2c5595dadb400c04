#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "advice/advise.hpp"
#include "advice/time_limit.hpp"
#include "bench/timing/timing.hpp"
#include "catalogue/models/body_summary.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "limits/modes/fastest_mode.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// Those that came nearest: what fails for all of these fails for the others. Last are those with steps so
/// short that they were not run.
std::vector<Method> nearest_methods(const Advice& failed, double tolerance) {
  constexpr std::size_t most = 4;
  std::vector<const AdviceRow*> rows;
  for (const AdviceRow& row : failed.rows)
    if (row.h_max != 0) rows.push_back(&row);
  std::ranges::stable_sort(rows, {}, [&](const AdviceRow* row) {
    if (!(row->frame_time() > 0)) return std::numeric_limits<double>::infinity();
    const double slower = row->verdict == AdviceVerdict::unstable ? 100 : 1;
    return slower * time_to_meet(*row, tolerance);
  });
  std::vector<Method> methods;
  for (const AdviceRow* row : rows)
    if (methods.size() < most &&
        std::ranges::find(methods, row->candidate.method.id, &Method::id) == methods.end())
      methods.push_back(row->candidate.method);
  return methods;
}

/// A parameter and what it is multiplied by, one after the other until something helps.
struct Scaling {
  std::string_view parameter;
  std::vector<double> factors;
};

const std::vector<Scaling>& scalings() {
  static const std::vector<Scaling> all{{"rho", {4, 16}},           {"mass", {4, 16}},
                                        {"E", {0.25, 0.0625}},      {"fibre_E", {0.25, 0.0625}},
                                        {"skin", {0.25, 0.0625}},   {"skin_thickness", {0.25, 0.0625}},
                                        {"beta", {0.25, 0.0625, 0}}};
  return all;
}

class Trials {
 public:
  Trials(const AdviceQuestion& question, Advice& failed, const AdviceWatcher& watcher)
      : question_(question),
        watcher_(watcher),
        found_(failed.remedies),
        all_tried_(failed.all_tried),
        time_(question.within - failed.seconds) {
    question_.frames = std::min<std::size_t>(question.frames, 100);
    question_.methods = nearest_methods(failed, question.tolerance);
    question_.least_error = false;  // what suffices at all
    question_.material = false;
  }

  /// Whether there are methods to try, and less than two minutes of CPU time are over and not all of the
  /// time of the answer.
  bool go_on() {
    if (question_.methods.empty()) return false;
    if (clock_() - begun_ > most_cpu || time_.left() <= 0) all_tried_ = false;
    return all_tried_;
  }

  /// Keeps the change if something suits with it.
  /// @returns whether it does
  bool helps(Remedy remedy, AdviceQuestion question, const std::function<Problem()>& changed) {
    if (!go_on()) return false;
    question.within = time_.left();
    try {
      const Advice advice = advise(changed(), question, watcher_);
      if (advice.out_of_time && advice.proof.size() < 2) all_tried_ = false;
      const AdviceRow* row = advice.recommended();
      if (!row || advice.proof.size() < 2) return false;
      if (remedy.change == "budget_ms")
        remedy.to = 1.5e3 * std::ranges::max(advice.proof, {}, &ProofRun::frame_p999).frame_p999;
      remedy.method = row->candidate.words();
      remedy.h = row->h;
      found_.push_back(std::move(remedy));
      return true;
    } catch (const InputError&) {
      return false;  // no such model, or no reference there either
    }
  }

  [[nodiscard]] const AdviceQuestion& question() const { return question_; }

 private:
  static constexpr double most_cpu = 120;  // [s]

  AdviceQuestion question_;
  const AdviceWatcher& watcher_;
  std::vector<Remedy>& found_;
  bool& all_tried_;
  TimeLimit time_;
  CpuClock clock_ = cpu_clock();
  double begun_ = clock_();
};

void try_budget(Trials& trials, const Problem& problem, const AdviceQuestion& question) {
  if (question.frame_budget() >= question.frame()) return;
  AdviceQuestion whole_frame = trials.question();
  whole_frame.budget.reset();
  trials.helps({.change = "budget_ms", .from = 1e3 * question.frame_budget()}, whole_frame,
               [&] { return problem; });
}

void try_rates(Trials& trials, const Problem& problem, const AdviceQuestion& question) {
  for (const double divisor : {2.0, 5.0, 10.0, 20.0, 50.0}) {
    AdviceQuestion slower = trials.question();
    slower.rate = question.rate / divisor;
    if (trials.helps({.change = "rate", .from = question.rate, .to = slower.rate}, slower,
                     [&] { return problem; }))
      break;
  }
}

/// Nothing where there is no such model.
std::optional<Problem> made(const std::function<Problem()>& make) {
  try {
    return make();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// How many points stand elsewhere, and how far at most, in words.
std::string words_of_moves(const TetMesh& from, const TetMesh& to) {
  const Eigen::VectorXd moves = (to.points - from.points).colwise().norm();
  return fmt::format("moves {} of {} points by at most {:.2g} mm", (moves.array() > 0).count(), moves.size(),
                     1e3 * moves.maxCoeff());
}

/// The element that owns the limit, and ever more of those after it as long as undamped steps at rest gain a
/// tenth.
void try_mended(Trials& trials, const Problem& problem, const std::function<Problem(int)>& make) {
  if (!trials.go_on()) return;
  double kappa = fastest_mode_of(*problem.body, false).kappa;
  for (const int count : {1, 4, 16, 64, 256}) {
    if (!trials.go_on()) return;
    const auto mended = made([&] { return make(count); });
    if (!mended) return;
    const double now = fastest_mode_of(*mended->body, false).kappa;
    if (now > kappa / (1.1 * 1.1)) continue;
    kappa = now;
    if (trials.helps({.change = "mend",
                      .from = 0,
                      .to = static_cast<double>(count),
                      .cost = words_of_moves(problem.body->mesh(), mended->body->mesh())},
                     trials.question(), [&] { return *mended; }))
      return;
  }
}

void try_coarser(Trials& trials, const Problem& problem, const std::function<Problem()>& make) {
  if (!trials.go_on()) return;
  const auto coarser = made(make);
  if (!coarser) return;
  const auto count = [](const Problem& of) { return static_cast<double>(of.body->mesh().element_count()); };
  trials.helps({.change = "tetrahedra", .from = count(problem), .to = count(*coarser)}, trials.question(),
               [&] { return *coarser; });
}

/// The step [s] with which the fastest row that is too slow for stability alone would be in time; infinity
/// without one.
double step_in_time(const Advice& failed, const AdviceQuestion& question) {
  const AdviceRow* fastest = nullptr;
  for (const AdviceRow& row : failed.rows)
    if (row.verdict == AdviceVerdict::too_slow && std::isfinite(row.h_max) &&
        !(row.error > question.tolerance) && (!fastest || row.frame_time() < fastest->frame_time()))
      fastest = &row;
  constexpr double spare = 1.1;  // of the time of a frame
  return fastest ? spare * fastest->h * fastest->frame_time() / question.frame_budget()
                 : std::numeric_limits<double>::infinity();
}

/// What mass scaling adds, in words, and what that does to slow motions where it is more than usual.
std::string words_of_added(const Eigen::VectorXd& added, double whole) {
  const double share = added.sum() / whole;
  return fmt::format(
      "adds {:.2g} % of the mass, to {} of {} points{}", 100 * share, (added.array() > 0).count(),
      added.size(),
      share > usual_added_mass
          ? fmt::format("; frequencies of slow modes fall by up to {:.2g} %", 100 * slowed_by(share))
          : "");
}

/// More mass where elements are fast, so that the step that is in time is stable, or steps of 1/8, 1/4, 1/2
/// and a whole frame.
void try_mass(Trials& trials, const Problem& problem, double in_time, const ProblemWith& make) {
  const double frame = trials.question().frame();
  std::vector<double> steps{frame / 8, frame / 4, frame / 2, frame};
  if (in_time < steps.front()) steps.insert(steps.begin(), in_time);
  for (const double wanted : steps) {
    if (!trials.go_on()) return;
    // Half as long again: steps stay below 0.95 of the limit, and a body that is pressed stiffens.
    const double step = 1.5 * wanted;
    const auto heavier = made([&] { return make({{"mass_step", step}}); });
    if (!heavier) return;
    const Eigen::VectorXd added = heavier->body->added_mass();
    if (added.sum() == 0) continue;
    const double whole = problem.body->point_mass().sum();
    if (added.sum() > whole) return;  // another body
    if (trials.helps({.change = "mass_step",
                      .from = settings_of(problem).mass_step,
                      .to = step,
                      .cost = words_of_added(added, whole)},
                     trials.question(), [&] { return *heavier; }))
      return;
  }
}

void try_parameters(Trials& trials, const Problem& problem, const ProblemWith& make) {
  for (const Scaling& scaling : scalings()) {
    const auto parameter =
        std::ranges::find(problem.parameters, scaling.parameter, &std::pair<std::string, double>::first);
    if (parameter == problem.parameters.end() || !(parameter->second > 0)) continue;
    for (const double factor : scaling.factors) {
      const double to = factor * parameter->second;
      if (trials.helps({.change = parameter->first, .from = parameter->second, .to = to}, trials.question(),
                       [&] {
                         return make({{parameter->first, to}});
                       }))
        break;
    }
  }
}

}  // namespace

void find_remedies(const Problem& problem, const AdviceQuestion& question, Advice& failed,
                   const Remaking& make, const AdviceWatcher& watcher) {
  failed.remedies.clear();
  failed.all_tried = !failed.out_of_time;
  if (failed.out_of_time) return;
  failed.stage = AdviceStage::remedies;
  Trials trials(question, failed, watcher);
  try_budget(trials, problem, question);
  // Of large bodies a coarser one is tried within the time that there is.
  if (make.coarser) try_coarser(trials, problem, make.coarser);
  if (problem.body) {
    if (make.mended) try_mended(trials, problem, make.mended);
    try_mass(trials, problem, step_in_time(failed, question), make.with);
  }
  // At a lower rate a step that stability limits takes as many steps a second.
  try_rates(trials, problem, question);
  if (problem.body) try_parameters(trials, problem, make.with);
  failed.stage = AdviceStage::done;
}

}  // namespace hmax
