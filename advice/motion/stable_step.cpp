#include "advice/motion/stable_step.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/parallel_for.hpp"

namespace hmax {

namespace {

constexpr double least_steps = 500, apart = 1e-8, parted = 1e-4;  // of the scale
/// The control runs are left out, or ended, beyond this.
constexpr double most_cpu = 10;  // [s]
constexpr double most_instants = 50, most_numbers = 4e6;

struct TooLong {};

/// One run, looked at at some instants.
struct WatchedMotion {
  RunRecord end;
  std::vector<Eigen::VectorXd> positions;  ///< of what is no body the whole states
  Eigen::VectorXd reach;                   ///< max |y_i - y_i(0)|; of a body its largest displacement alone
  std::optional<Inversion> inversion;
};

/// @param watcher  called some hundred times
WatchedMotion watched_run(const Candidate& candidate, const Problem& problem, double h, double t_end,
                          double most_seconds, const Watcher& watcher) {
  WatchedMotion run;
  const Eigen::Index n = unknowns_of(problem);
  const Eigen::VectorXd start = problem.y0.head(n);
  run.reach = Eigen::VectorXd::Zero(problem.body ? 1 : n);
  const double instants = std::clamp(most_numbers / static_cast<double>(n), 4.0, most_instants);
  const auto stride = static_cast<std::int64_t>(std::max(1.0, std::ceil(t_end / h / instants)));
  const std::int64_t often = std::max<std::int64_t>(1, stride / 4);
  const CpuClock clock = cpu_clock();
  const double begun = clock();
  const std::int64_t seen_every = candidate.method.device ? often : 1;
  std::int64_t step = -seen_every;
  const Sink sink = [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    step += seen_every;
    if (step % often != 0) return;
    if (watcher) watcher();
    if (clock() - begun > most_seconds) throw TooLong{};
    const Eigen::VectorXd moved = y.head(n) - start;
    if (problem.body)
      run.reach[0] = std::max(run.reach[0], largest_displacement(moved));
    else
      run.reach = run.reach.cwiseMax(moved.cwiseAbs());
    if (!run.inversion) run.inversion = inversion_at(problem, t, y);
    if (step % stride == 0) run.positions.emplace_back(y.head(n));
  };
  RunSpec spec = candidate.spec(h, t_end);
  spec.seen_every = seen_every;
  run.end = candidate.method.bind(problem).run(spec, sink);
  if (!run.inversion && run.end.y.size() == problem.y0.size())
    run.inversion = inversion_at(problem, run.end.t_state, run.end.y);
  return run;
}

/// Two runs from neighbouring states.
struct Pair {
  WatchedMotion run, beside;
  double apart_at_end = std::numeric_limits<double>::infinity();  ///< relative to the scale
  double growth = std::numeric_limits<double>::infinity();        ///< the largest of the instants

  [[nodiscard]] bool ended() const {
    return run.end.outcome == Outcome::reached_end && beside.end.outcome == Outcome::reached_end;
  }
};

/// The end of a run whose neighbour ended by an exception.
struct NeighbourEnded {};

/// first(watch) and second(watch), at once on two threads or one after the other. What a watcher throws,
/// which the calling thread alone asks, ends both.
void side_by_side(bool at_once, const Watcher& watcher,
                  const std::array<std::function<void(const Watcher& watch)>, 2>& runs) {
  if (!at_once) {
    for (const auto& run : runs) run(watcher);
    return;
  }
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<bool> ended = false;
  std::exception_ptr why;
  const Watcher watch = [&] {
    if (ended) throw NeighbourEnded{};
    if (std::this_thread::get_id() == caller && watcher) watcher();
  };
  std::mutex guard;
  parallel_for(runs.size(), [&](std::size_t i, std::size_t) {
    try {
      runs[i](watch);
    } catch (...) {
      const std::scoped_lock lock(guard);
      if (!ended.exchange(true)) why = std::current_exception();
    }
  });
  if (why) std::rethrow_exception(why);
}

/// @param scales  of each number that is compared
Pair neighbours(const Candidate& candidate, const Problem& problem, const Eigen::VectorXd& scales, double h,
                double t_end, double most_seconds, const Watcher& watcher) {
  // Another direction for each number, so that every mode has a part.
  Problem beside = problem;
  const Eigen::Index n = unknowns_of(problem);
  for (Eigen::Index i = 0; i < n; ++i)
    beside.y0[i] +=
        apart * scales[i] * (2 * std::fmod(0.618033988749895 * static_cast<double>(i + 1), 1.0) - 1);
  Pair pair;
  const bool at_once = problem.body && !candidate.method.device;
  side_by_side(at_once, watcher,
               {[&](const Watcher& watch) {
                  pair.run = watched_run(candidate, problem, h, t_end, most_seconds, watch);
                },
                [&](const Watcher& watch) {
                  // On two threads nobody waits for the other.
                  if (!at_once && pair.run.end.outcome != Outcome::reached_end) return;
                  pair.beside = watched_run(candidate, beside, h, t_end, most_seconds, watch);
                }});
  if (!pair.ended()) return pair;
  const auto distance = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return (a - b).head(n).cwiseQuotient(scales).cwiseAbs().maxCoeff();
  };
  pair.apart_at_end = distance(pair.run.end.y, pair.beside.end.y);
  pair.growth = pair.apart_at_end / apart;
  for (std::size_t i = 0; i < std::min(pair.run.positions.size(), pair.beside.positions.size()); ++i)
    pair.growth = std::max(pair.growth, distance(pair.run.positions[i], pair.beside.positions[i]) / apart);
  return pair;
}

/// How many times as far one motion goes as another: the most of its states, but for those that rounding
/// alone moves.
double larger_by(const Eigen::VectorXd& reach, const Eigen::VectorXd& than) {
  const double least = 1e-9 * than.maxCoeff();
  double factor = 0;
  for (Eigen::Index i = 0; i < reach.size(); ++i)
    if (than[i] > least || reach[i] > least)
      factor = std::max(factor, reach[i] / std::max(than[i], std::numeric_limits<double>::min()));
  return factor;
}

std::string words_of_end(const RunRecord& end) {
  const char* what = end.outcome == Outcome::diverged        ? "the run diverges"
                     : end.outcome == Outcome::newton_failed ? "Newton's method does not converge"
                                                             : "the run ends early";
  return fmt::format("{} at t = {:.4g} s", what, end.t);
}

/// Of a step whose neighbours part: whether the model parts them, as a quarter of the step shows.
void judge_by_quarter(StepVerdict& verdict, const Pair& pair, const Candidate& candidate,
                      const Problem& problem, const Eigen::VectorXd& scales, double h, double t_end,
                      const Watcher& watcher) {
  constexpr double most_larger = 2;
  verdict.why =
      fmt::format("runs from states {:.0e} apart are {:.2g} apart at t = {:.4g} s, relative to the motion",
                  apart, pair.apart_at_end, t_end);
  Pair quarter;
  try {
    quarter = neighbours(candidate, problem, scales, h / 4, t_end, most_cpu / 2, watcher);
  } catch (const TooLong&) {
    verdict.why += "; with a quarter of the step they take too long to tell whether the model does this";
    return;
  }
  if (!quarter.ended()) {
    verdict.why +=
        "; with a quarter of the step " +
        words_of_end(quarter.run.end.outcome != Outcome::reached_end ? quarter.run.end : quarter.beside.end);
    return;
  }
  if (quarter.growth < std::sqrt(pair.growth)) {
    verdict.why += fmt::format(", and {:.2g} with a quarter of the step", quarter.apart_at_end);
    return;
  }
  verdict.parts = true;
  const double larger = larger_by(pair.run.reach, quarter.run.reach);
  verdict.stable = larger <= most_larger;
  verdict.why =
      verdict.stable
          ? ""
          : fmt::format("the motion becomes {:.3g} times as large as with a quarter of the step", larger);
}

}  // namespace

StepVerdict judged_step(const Candidate& candidate, const ProbingMotion& motion,
                        const ReferenceMotion& reference, double h, const Watcher& watcher) {
  const double t_end = std::max(motion.t_end, least_steps * h);
  Eigen::VectorXd scales(unknowns_of(motion.problem));
  for (Eigen::Index i = 0; i < scales.size(); ++i)
    scales[i] = std::max(scale_of_state(reference, i), std::numeric_limits<double>::min());
  const Pair pair = neighbours(candidate, motion.problem, scales, h, t_end,
                               std::numeric_limits<double>::infinity(), watcher);
  StepVerdict verdict;
  verdict.inversion = pair.run.inversion;
  verdict.stable = pair.ended() && pair.apart_at_end <= parted;
  if (verdict.stable) return verdict;
  if (pair.ended())
    judge_by_quarter(verdict, pair, candidate, motion.problem, scales, h, t_end, watcher);
  else
    verdict.why = words_of_end(pair.run.end.outcome != Outcome::reached_end ? pair.run.end : pair.beside.end);
  if (!verdict.stable && verdict.inversion) verdict.why = in_words(*verdict.inversion) + "; " + verdict.why;
  return verdict;
}

std::optional<Inversion> first_inversion(const ProbingMotion& motion, const ReferenceMotion& reference) {
  for (std::size_t i = 0; i < reference.y.size(); ++i)
    if (auto inversion = inversion_at(motion.problem, reference.t[i], reference.y[i])) return inversion;
  return std::nullopt;
}

bool holds(const Candidate& candidate, const ProbingMotion& motion, const ReferenceMotion& reference,
           double h) {
  return judged_step(candidate, motion, reference, h).stable;
}

}  // namespace hmax
