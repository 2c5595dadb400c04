#include "bench/timing/sweep.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/timing/timing.hpp"
#include "core/parallel_for.hpp"
#include "core/pinned_thread.hpp"
#include "integrators/control.hpp"
#include "results/errors.hpp"
#include "results/fingerprint.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Errors are measured at no more than about this many points of a run.
constexpr std::int64_t most_points = 100'000;

/// Thrown through a run by its sink to end it, or all of them.
struct OverBudget {};
struct SweepEnded {};

bool same_bits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

/// Largest error, and its mean square over time from t = 0, over the points of a run: all of them, or every
/// k-th of more than most_points. Reference states are kept from one run to the next when all runs have their
/// points at the same times.
class ErrorMeter {
 public:
  /// @param points      of each run, the initial one included
  /// @param same_times  whether point n of every run has the same time
  ErrorMeter(const Reference& reference, Eigen::Index dim, std::int64_t points, bool same_times)
      : reference_(reference), stride_((points + most_points - 1) / most_points), keeps_(same_times) {
    if (keeps_) kept_.resize(dim, points / stride_ + 1);
  }

  void start() {
    n_ = 0;
    largest_ = squared_ = last_t_ = last_ = 0;
  }

  /// Point after point, the initial one first.
  void look(double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    const std::int64_t n = n_++;
    if (n % stride_ != 0) return;
    const Eigen::Index slot = n / stride_;
    if (!keeps_) {
      take(t, (y - reference_.at(t)).cwiseAbs().maxCoeff());
      return;
    }
    if (slot == filled_) kept_.col(filled_++) = reference_.at(t);
    take(t, (y - kept_.col(slot)).cwiseAbs().maxCoeff());
  }

  /// @param t  not before those taken earlier
  void take(double t, double error) {
    if (!(error <= largest_)) largest_ = error;
    squared_ += (t - last_t_) * (error * error + last_ * last_) / 2;  // trapezoidal rule
    last_t_ = t;
    last_ = error;
  }

  [[nodiscard]] double largest() const { return largest_; }
  /// sqrt of the mean of error^2 over the time looked at
  [[nodiscard]] double root_mean_square() const { return last_t_ > 0 ? std::sqrt(squared_ / last_t_) : 0; }

 private:
  const Reference& reference_;
  std::int64_t stride_, n_ = 0;
  double largest_ = 0, squared_ = 0, last_t_ = 0, last_ = 0;
  bool keeps_;
  Eigen::MatrixXd kept_;  // shape (dim, slots), filled from the left
  Eigen::Index filled_ = 0;
};

/// One row on its way: what was counted, and what is still to be timed.
struct Candidate {
  Row row;
  Runner runner;
  Eigen::VectorXd end;  // of the counted run
  bool timed = true;
  bool agrees = true;  // of every timed run with the counted one
};

/// Whether a reference is known up to the end of the runs of a block.
bool reaches_end(const Reference& reference, const SweepBlock& block) {
  return reference.valid_until >= block.run.t_end * (1 - 1e-12);
}

/// Puts the errors of a counted run into its row, or why it has none.
void judge(const SweepBlock& block, Candidate& candidate, const RunRecord& record, const Reference& reference,
           ErrorMeter& meter) {
  Row& row = candidate.row;
  if (record.outcome == Outcome::too_many_steps) {
    candidate.timed = false;
    row.status = fmt::format("The run was given up at t = {} s after {} attempts and was not timed.",
                             to_text(record.t), block.run.max_steps);
  } else if (record.outcome != Outcome::reached_end) {
    row.status = fmt::format("The run ended at t = {} s ({}): it has no error at {} s.", to_text(record.t),
                             row.outcome, to_text(block.run.t_end));
  } else if (!reaches_end(reference, block)) {
    candidate.timed = false;
    row.status = fmt::format(
        "The reference ends at t = {} s: the error is unknown, and a time without its error is not stored.",
        to_text(reference.valid_until));
  } else {
    row.error_end = (record.y - reference.at(block.run.t_end)).cwiseAbs().maxCoeff();
    meter.take(block.run.t_end, row.error_end);
    row.error_global = meter.largest();
    row.error_l2 = meter.root_mean_square();
  }
}

/// Rows that are measured together: some methods of a block.
struct Task {
  const SweepBlock* block;
  std::vector<std::size_t> methods;
};

/// Each row by itself, those of one problem from the longest to the shortest, so that the threads end together.
std::vector<Task> single_rows(const SweepPlan& plan, const std::vector<Task>& tasks) {
  std::vector<std::pair<double, Task>> rows;
  for (const auto& [block, methods] : tasks)
    for (const std::size_t m : methods)
      rows.emplace_back(expected_cost(plan, *block, {m}), Task{block, {m}});
  std::ranges::stable_sort(rows, [](const auto& a, const auto& b) {
    const std::size_t p = a.second.block->problem, q = b.second.block->problem;
    return p != q ? p < q : a.first > b.first;
  });
  std::vector<Task> sorted;
  for (auto& [cost, task] : rows) sorted.push_back(std::move(task));
  return sorted;
}

/// A plan for another thread: formulas have one workspace each. Bodies are shared.
SweepPlan with_own_problems(SweepPlan plan) {
  for (std::size_t i = 0; i < plan.problems.size(); ++i)
    if (!plan.problems[i].body)
      plan.problems[i] = make_problem(plan.spec.problems[i].name, plan.spec.problems[i].settings);
  return plan;
}

/// Measures one block after the other; knows the reference of the problem at hand.
class Sweeper {
 public:
  Sweeper(const SweepPlan& plan, Store& store, const std::function<void(const SweepProgress&)>& progress,
          const std::function<bool()>& interrupted)
      : plan_(plan), store_(store), progress_(progress), interrupted_(interrupted) {}

  SweepSummary run();

 private:
  std::vector<std::size_t> missing(const SweepBlock& block) const;
  std::vector<Row> measured(const SweepBlock& block, const std::vector<std::size_t>& methods);
  void keep(const std::vector<Row>& rows);
  void measure(const std::vector<Task>& tasks);
  void explore(const std::vector<Task>& tasks);
  Candidate count(const SweepBlock& block, std::size_t method, std::optional<ErrorMeter>& meter);
  RunRecord watched_run(const SweepBlock& block, Candidate& candidate, const Reference& reference,
                        std::optional<ErrorMeter>& meter);
  void time(const SweepBlock& block, std::vector<Candidate>& candidates);
  const Reference& reference(const SweepBlock& block);
  void begin_session();
  void tell(const SweepBlock& block, double share) const;
  /// The share of the cost that is done.
  /// @param here  share of the block at hand
  double share_done(double here) const {
    return cost_total_ > 0 ? (cost_done_ + here * cost_here_) / cost_total_ : 1;
  }
  void stop_if_asked() const {
    if (interrupted_ && interrupted_()) throw SweepEnded{};
  }

  const SweepPlan& plan_;
  Store& store_;
  const std::function<void(const SweepProgress&)>& progress_;
  const std::function<bool()>& interrupted_;
  SweepSummary summary_;
  std::optional<Reference> reference_;
  std::size_t reference_of_ = 0;  // index of the problem
  double cost_done_ = 0, cost_here_ = 0, cost_total_ = 0;
};

std::vector<std::size_t> Sweeper::missing(const SweepBlock& block) const {
  std::vector<std::size_t> methods;
  std::ranges::copy_if(block.methods, std::back_inserter(methods),
                       [&](std::size_t m) { return !store_.contains(row_key(plan_, block, m)); });
  return methods;
}

const Reference& Sweeper::reference(const SweepBlock& block) {
  if (!reference_ || reference_of_ != block.problem) {
    if (progress_)
      progress_({.rows_done = summary_.skipped + summary_.measured,
                 .rows = plan_.rows(),
                 .fraction = share_done(0),
                 .what = "reference of " + plan_.problems[block.problem].id});
    reference_ = make_reference(plan_.problems[block.problem], block.run.t_end);
    reference_of_ = block.problem;
  }
  return *reference_;
}

/// @param share  of the block at hand that is done
void Sweeper::tell(const SweepBlock& block, double share) const {
  if (!progress_) return;
  const Problem& problem = plan_.problems[block.problem];
  progress_({.rows_done = summary_.skipped + summary_.measured,
             .rows = plan_.rows(),
             .fraction = share_done(share),
             .what = fmt::format("{}{}{}, {}, {} = {}", problem.id, problem.material.empty() ? "" : ":",
                                 problem.material, block.mode, block.mode == "adaptive" ? "rtol" : "h",
                                 to_text(block.mode == "adaptive" ? block.run.rtol
                                         : block.run.adaptive     ? block.run.every
                                                                  : block.run.h))});
}

/// Runs a candidate once, or twice where it has output points besides its steps: counts subnormal numbers,
/// and shows every point to the meter where there is a reference. Throws OverBudget.
RunRecord Sweeper::watched_run(const SweepBlock& block, Candidate& candidate, const Reference& reference,
                               std::optional<ErrorMeter>& meter) {
  const OneThread alone;  // the budget is that of one
  using State = Eigen::Ref<const Eigen::VectorXd>;
  const Eigen::Index dim = plan_.problems[block.problem].y0.size();
  const bool has_reference = reaches_end(reference, block);
  std::int64_t seen = 0;
  double started = thread_cpu_seconds();
  const auto look_at_the_clock = [&] {
    constexpr std::int64_t often = 0xff;
    if ((++seen & often) != 0) return;
    stop_if_asked();
    if (thread_cpu_seconds() - started > plan_.spec.budget_s) throw OverBudget{};
  };
  const auto notice = [&](const State& y) {
    look_at_the_clock();
    for (const double value : y) candidate.row.subnormals += std::fpclassify(value) == FP_SUBNORMAL;
  };
  const auto compare = [&](double t, const State& y) {
    if (has_reference) meter->look(t, y);
  };
  if (block.mode == "fixed") {
    if (!meter) meter.emplace(reference, dim, fixed_step_count(block.run.t_end, block.run.h) + 1, true);
    meter->start();
    return candidate.runner.run(block.run, [&](double t, const State& y) {
      notice(y);
      compare(t, y);
    });
  }
  // Accepted steps and output points are not the same here: one run looks at the steps, one at the points.
  RunSpec steps_only = block.run;
  steps_only.every = 0;
  const RunRecord record = candidate.runner.run(steps_only, [&](double, const State& y) { notice(y); });
  if (block.mode == "adaptive")
    meter.emplace(reference, dim, record.stats.steps + 1, false);
  else if (!meter)
    meter.emplace(reference, dim, fixed_step_count(block.run.t_end, block.run.every) + 1, true);
  meter->start();
  started = thread_cpu_seconds();
  return candidate.runner.run(block.run, [&](double t, const State& y) {
    look_at_the_clock();
    compare(t, y);
  });
}

Candidate Sweeper::count(const SweepBlock& block, std::size_t method, std::optional<ErrorMeter>& meter) {
  const Reference& reference = this->reference(block);
  Candidate candidate;
  candidate.runner = plan_.methods[method].bind(plan_.problems[block.problem]);
  candidate.row.key = row_key(plan_, block, method);
  Row& row = candidate.row;
  row.explored = plan_.spec.explore;
  row.error_end = row.error_global = row.error_l2 = nan;
  row.reference = reference.name;
  row.reference_error = reference.error_bound;
  RunRecord record;
  try {
    record = watched_run(block, candidate, reference, meter);
  } catch (const OverBudget&) {
    row.outcome = "over_budget";
    row.status = fmt::format("The run was given up after {} s of CPU time and was not timed.",
                             to_text(plan_.spec.budget_s));
    candidate.timed = false;
    return candidate;
  }
  candidate.end = record.y;
  row.outcome = to_string(record.outcome);
  row.t_reached = record.t;
  row.steps = record.stats.steps;
  row.rejected = record.stats.rejected;
  row.rhs = record.stats.rhs;
  judge(block, candidate, record, reference, *meter);
  return candidate;
}

void Sweeper::time(const SweepBlock& block, std::vector<Candidate>& candidates) {
  std::optional<PinnedThread> pinned;
  if (!plan_.spec.explore) pinned.emplace();
  std::vector<Candidate*> timed;
  std::vector<std::function<void(std::int64_t)>> runs;
  for (Candidate& candidate : candidates) {
    if (!candidate.timed) continue;
    timed.push_back(&candidate);
    runs.emplace_back([&block, &candidate](std::int64_t n) {
      if (!same_bits(candidate.runner.repeat(block.run, n), candidate.end)) candidate.agrees = false;
    });
  }
  // A sample each to find the number of runs, then the repetitions; the counting before took about as much.
  const double samples = static_cast<double>(timed.size()) * (plan_.spec.repeats + 2);
  double taken = static_cast<double>(timed.size());
  const std::vector<Timing> timings = time_interleaved(
      runs, {.repetitions = plan_.spec.repeats, .min_sample_s = plan_.spec.min_sample_s, .keep_going = [&] {
               tell(block, std::min(1.0, taken++ / samples));
               return !(interrupted_ && interrupted_());
             }});
  if (timings.size() != timed.size()) throw SweepEnded{};
  for (std::size_t i = 0; i < timed.size(); ++i) {
    if (!timed[i]->agrees)
      throw std::logic_error(
          fmt::format("{} on {} ends elsewhere when it is timed than when it is counted: its times are not "
                      "stored.",
                      timed[i]->row.key.method, timed[i]->row.key.problem));
    timed[i]->row.cpu_s = timings[i].samples;
    timed[i]->row.runs_per_sample = timings[i].runs_per_sample;
  }
}

std::vector<Row> Sweeper::measured(const SweepBlock& block, const std::vector<std::size_t>& methods) {
  std::vector<Candidate> candidates;
  std::optional<ErrorMeter> meter;
  for (const std::size_t method : methods) {
    stop_if_asked();
    tell(block, static_cast<double>(candidates.size()) /
                    (static_cast<double>(methods.size()) * (plan_.spec.repeats + 2)));
    candidates.push_back(count(block, method, meter));
  }
  time(block, candidates);
  std::vector<Row> rows;
  for (Candidate& candidate : candidates) rows.push_back(std::move(candidate.row));
  return rows;
}

void Sweeper::keep(const std::vector<Row>& rows) {
  store_.insert(rows);
  summary_.measured += static_cast<std::int64_t>(rows.size());
}

void Sweeper::measure(const std::vector<Task>& tasks) {
  for (const auto& [block, methods] : tasks) {
    cost_here_ = expected_cost(plan_, *block, methods);
    keep(measured(*block, methods));
    cost_done_ += cost_here_;
    cost_here_ = 0;
    tell(*block, 1);
  }
}

void Sweeper::explore(const std::vector<Task>& tasks) {
  const std::vector<Task> rows = single_rows(plan_, tasks);
  std::vector<SweepPlan> plans;
  while (plans.size() < std::min(jobs(), rows.size())) plans.push_back(with_own_problems(plan_));
  static const std::function<void(const SweepProgress&)> silent;
  std::vector<std::unique_ptr<Sweeper>> threads;
  for (const SweepPlan& plan : plans)
    threads.push_back(std::make_unique<Sweeper>(plan, store_, silent, interrupted_));
  std::mutex storing;
  parallel_for(
      rows.size(),
      [&](std::size_t i, std::size_t worker) {
        const std::vector<Row> done = threads[worker]->measured(*rows[i].block, rows[i].methods);
        const std::scoped_lock lock(storing);
        keep(done);
      },
      [&](std::size_t done) {
        if (progress_)
          progress_({.rows_done = summary_.skipped + static_cast<std::int64_t>(done),
                     .rows = plan_.rows(),
                     .fraction = static_cast<double>(done) / static_cast<double>(rows.size()),
                     .what = "exploring"});
      },
      [&] { return interrupted_ && interrupted_(); });
  if (summary_.measured < static_cast<std::int64_t>(rows.size())) throw SweepEnded{};
}

void Sweeper::begin_session() {
  const Fingerprint here = fingerprint();
  if (here.debug_build && store_.notes().contains("published"))
    throw InputError(
        fmt::format("the store '{}' is published and takes no rows of a debug build; build with `cmake "
                    "--preset release`, or give another --out",
                    store_.file().string()));
  if (here.debug_build)
    summary_.warnings.emplace_back(
        "this is a debug build; its times are marked and say nothing about a release build");
  if (const std::vector<Session> sessions = store_.sessions(); !sessions.empty())
    if (const auto changes = differences(sessions.back().fingerprint, here); !changes.empty())
      summary_.warnings.push_back(
          fmt::format("the rows stored before were measured otherwise ({})", fmt::join(changes, "; ")));
  if (plan_.spec.explore)
    summary_.warnings.emplace_back(
        "explored on all cores: the CPU times are rough, and no figure or comparison takes them; a sweep without "
        "--explore measures them");
  store_.begin_session(here);
}

SweepSummary Sweeper::run() {
  const auto started = std::chrono::steady_clock::now();
  std::vector<Task> work;
  for (const SweepBlock& block : plan_.blocks) {
    std::vector<std::size_t> methods = missing(block);
    summary_.skipped += static_cast<std::int64_t>(block.methods.size() - methods.size());
    if (methods.empty()) continue;
    cost_total_ += expected_cost(plan_, block, methods);
    work.push_back({&block, std::move(methods)});
  }
  if (!work.empty()) begin_session();
  try {
    plan_.spec.explore ? explore(work) : measure(work);
  } catch (const SweepEnded&) {
    summary_.interrupted = true;
  }
  summary_.rows = store_.size();
  summary_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return summary_;
}

}  // namespace

SweepSummary run_sweep(const SweepPlan& plan, Store& store,
                       const std::function<void(const SweepProgress&)>& progress,
                       const std::function<bool()>& interrupted) {
  return Sweeper(plan, store, progress, interrupted).run();
}

}  // namespace hmax
