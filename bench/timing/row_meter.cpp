#include "bench/timing/row_meter.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "bench/timing/reference.hpp"
#include "bench/timing/timing.hpp"
#include "catalogue/device/device.hpp"
#include "core/numbers.hpp"
#include "core/parallel_for.hpp"
#include "core/process/pinned_thread.hpp"
#include "integrators/control.hpp"

namespace hmax {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Errors are measured at no more than about this many points of a run.
constexpr std::int64_t most_points = 100'000;

/// Numbers of reference states that are kept from block to block: 32 MiB.
constexpr std::int64_t most_kept_numbers = 1 << 22;

/// Thrown through a run by its sink to end it.
struct OverBudget {};

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
  /// @param same_times  whether point n of every run has the same time but for rounding
  ErrorMeter(const Reference& reference, Eigen::Index dim, std::int64_t points, bool same_times)
      : reference_(reference), stride_((points + most_points - 1) / most_points), keeps_(same_times) {
    if (!keeps_) return;
    kept_.resize(dim, points / stride_ + 1);
    times_.assign(static_cast<std::size_t>(kept_.cols()), nan);
  }

  void start() {
    n_ = 0;
    largest_ = squared_ = last_t_ = last_ = 0;
  }

  /// Whether the next point is one of those that errors are measured at.
  [[nodiscard]] bool is_due() const { return n_ % stride_ == 0; }

  /// Point after point, the initial one first.
  void look(double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    const std::int64_t n = n_++;
    if (n % stride_ != 0) return;
    const Eigen::Index slot = n / stride_;
    if (!keeps_) {
      take(t, (y - reference_.at(t)).cwiseAbs().maxCoeff());
      return;
    }
    // Times of different methods may differ by rounding: an error depends on no other run.
    if (double& kept = times_[static_cast<std::size_t>(slot)]; kept != t) {
      kept_.col(slot) = reference_.at(t);
      kept = t;
    }
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
  Eigen::MatrixXd kept_;       // shape (dim, slots)
  std::vector<double> times_;  // of the kept states; NaN where there is none yet
};

/// One row on its way: what was counted, and what is still to be timed.
struct Candidate {
  Row row;
  Runner runner;
  Eigen::VectorXd end;   // of the counted run
  double counted_s = 0;  // its CPU time, without that of errors
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

}  // namespace

std::string in_words(const SweepPlan& plan, const SweepBlock& block) {
  const Problem& problem = plan.problems[block.problem];
  const bool over_tolerances = block.mode == "adaptive";
  const double value = over_tolerances ? block.run.rtol : block.run.adaptive ? block.run.every : block.run.h;
  return fmt::format("{}{}{}, {}, {} = {}", problem.id, problem.material.empty() ? "" : ":", problem.material,
                     block.mode, over_tolerances ? "rtol" : "h", to_text(value));
}

std::vector<SweepTask> single_rows(const SweepPlan& plan, const std::vector<SweepTask>& tasks) {
  std::vector<std::pair<double, SweepTask>> rows;
  for (const auto& [block, methods] : tasks)
    for (const std::size_t m : methods)
      rows.emplace_back(expected_cost(plan, *block, {m}), SweepTask{block, {m}});
  std::ranges::stable_sort(rows, [](const auto& a, const auto& b) {
    const std::size_t p = a.second.block->problem, q = b.second.block->problem;
    return p != q ? p < q : a.first > b.first;
  });
  std::vector<SweepTask> sorted;
  for (auto& [cost, task] : rows) sorted.push_back(std::move(task));
  return sorted;
}

class RowMeter::Parts {
 public:
  Parts(const SweepPlan& plan, Tell tell, const std::function<bool()>& interrupted)
      : plan_(plan), tell_(std::move(tell)), interrupted_(interrupted) {}
  std::vector<Row> measured(const SweepTask& task);

 private:
  Candidate count(const SweepBlock& block, std::size_t method);
  RunRecord watched_run(const SweepBlock& block, Candidate& candidate, const Reference& reference);
  void choose_meter(const SweepBlock& block, std::int64_t points);
  void time(const SweepBlock& block, std::vector<Candidate>& candidates);
  const Reference& reference(const SweepBlock& block);
  void tell(const SweepBlock& block, double share) const;
  void stop_if_asked() const {
    if (interrupted_ && interrupted_()) throw SweepEnded{};
  }

  const SweepPlan& plan_;
  Tell tell_;
  const std::function<bool()>& interrupted_;
  std::optional<Reference> reference_;
  std::size_t reference_of_ = 0;  // index of the problem
  std::map<const SweepBlock*, ErrorMeter>
      meters_;                         // of blocks whose runs have their points at the same times
  std::int64_t kept_numbers_ = 0;      // in those
  std::optional<ErrorMeter> passing_;  // of a run whose points are at times of its own
  ErrorMeter* meter_ = nullptr;        // of the run at hand
};

const Reference& RowMeter::Parts::reference(const SweepBlock& block) {
  if (!reference_ || reference_of_ != block.problem) {
    if (tell_) tell_(0, "reference of " + plan_.problems[block.problem].id);
    meters_.clear();
    kept_numbers_ = 0;
    reference_ = make_reference(plan_.problems[block.problem], block.run.t_end, [this] { stop_if_asked(); });
    reference_of_ = block.problem;
  }
  return *reference_;
}

/// The meter for runs of a block that have `points` points at the same times; rows of an exploring sweep come
/// one by one, from one block and another.
void RowMeter::Parts::choose_meter(const SweepBlock& block, std::int64_t points) {
  const Eigen::Index dim = plan_.problems[block.problem].y0.size();
  if (!meters_.contains(&block)) {
    const std::int64_t numbers = dim * std::min(points, most_points);
    if (kept_numbers_ + numbers > most_kept_numbers) meters_.clear(), kept_numbers_ = 0;
    kept_numbers_ += numbers;
    meters_.try_emplace(&block, reference(block), dim, points, true);
  }
  meter_ = &meters_.at(&block);
}

/// @param share  of the task at hand that is done
void RowMeter::Parts::tell(const SweepBlock& block, double share) const {
  if (tell_) tell_(share, in_words(plan_, block));
}

/// Runs a candidate once, or twice where it has output points besides its steps: counts subnormal numbers,
/// and shows every point to the meter where there is a reference. The last run gives the CPU time of
/// the candidate. Throws OverBudget.
RunRecord RowMeter::Parts::watched_run(const SweepBlock& block, Candidate& candidate,
                                       const Reference& reference) {
  const OneThread alone;  // the budget is that of one
  using State = Eigen::Ref<const Eigen::VectorXd>;
  const Eigen::Index dim = plan_.problems[block.problem].y0.size();
  const bool has_reference = reaches_end(reference, block);
  std::int64_t seen = 0;
  double started = thread_cpu_seconds(), of_errors = 0;
  // The reference is none of the run's work.
  const auto taken = [&] { return thread_cpu_seconds() - started - of_errors; };
  const auto counted = [&](RunRecord record) {
    candidate.counted_s = taken();
    return record;
  };
  const auto look_at_the_clock = [&] {
    constexpr std::int64_t often = 0xff;
    if ((++seen & often) != 0) return;
    stop_if_asked();
    if (taken() > plan_.spec.budget_s) throw OverBudget{};
  };
  const auto notice = [&](const State& y) {
    look_at_the_clock();
    for (const double value : y) candidate.row.subnormals += std::fpclassify(value) == FP_SUBNORMAL;
  };
  const auto compare = [&](double t, const State& y) {
    if (!has_reference) return;
    if (!meter_->is_due()) return meter_->look(t, y);
    const double before = thread_cpu_seconds();
    stop_if_asked();  // a state of the reference may take as long as many steps
    meter_->look(t, y);
    of_errors += thread_cpu_seconds() - before;
  };
  if (block.mode == "fixed") {
    choose_meter(block, fixed_step_count(block.run.t_end, block.run.h) + 1);
    meter_->start();
    return counted(candidate.runner.run(block.run, [&](double t, const State& y) {
      notice(y);
      compare(t, y);
    }));
  }
  // Accepted steps and output points are not the same here: one run looks at the steps, one at the points.
  RunSpec steps_only = block.run;
  steps_only.every = 0;
  const RunRecord record = candidate.runner.run(steps_only, [&](double, const State& y) { notice(y); });
  if (block.mode == "adaptive")
    meter_ = &passing_.emplace(reference, dim, record.stats.steps + 1, false);
  else
    choose_meter(block, fixed_step_count(block.run.t_end, block.run.every) + 1);
  meter_->start();
  started = thread_cpu_seconds();
  of_errors = 0;
  return counted(candidate.runner.run(block.run, [&](double t, const State& y) {
    look_at_the_clock();
    compare(t, y);
  }));
}

Candidate RowMeter::Parts::count(const SweepBlock& block, std::size_t method) {
  const Reference& reference = this->reference(block);
  Candidate candidate;
  candidate.runner = plan_.methods[method].bind(plan_.problems[block.problem]);
  candidate.row.key = row_key(plan_, block, method);
  Row& row = candidate.row;
  row.explored = plan_.spec.explore;
  if (const auto& device = plan_.methods[method].device) {
    row.clock_mhz = device->clock_mhz;
    row.driver = device->driver;
  }
  row.error_end = row.error_global = row.error_l2 = nan;
  row.reference = reference.name;
  row.reference_error = reference.error_bound;
  RunRecord record;
  try {
    record = watched_run(block, candidate, reference);
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
  judge(block, candidate, record, reference, *meter_);
  return candidate;
}

void RowMeter::Parts::time(const SweepBlock& block, std::vector<Candidate>& candidates) {
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
  const auto keep_going = [&] {
    tell(block, std::min(1.0, taken++ / samples));
    return !(interrupted_ && interrupted_());
  };
  // The methods of a plan run on one device, or all on the processor.
  const std::vector<Timing> timings =
      time_interleaved(runs, {.repetitions = plan_.spec.repeats,
                              .min_sample_s = plan_.spec.min_sample_s,
                              .clock = timed.empty() ? nullptr : timed.front()->runner.seconds,
                              .keep_going = keep_going});
  if (timings.size() != timed.size()) throw SweepEnded{};
  for (std::size_t i = 0; i < timed.size(); ++i) {
    if (!timed[i]->agrees)
      throw std::logic_error(
          fmt::format("{} on {} ends elsewhere when it is timed than when it is counted: its times are not "
                      "stored.",
                      timed[i]->row.key.method, timed[i]->row.key.problem));
    Row& row = timed[i]->row;
    (is_on_device(row) ? row.device_s : row.cpu_s) = timings[i].samples;
    row.runs_per_sample = timings[i].runs_per_sample;
  }
}

std::vector<Row> RowMeter::Parts::measured(const SweepTask& task) {
  const SweepBlock& block = *task.block;
  const std::vector<std::size_t>& methods = task.methods;
  std::vector<Candidate> candidates;
  for (const std::size_t method : methods) {
    stop_if_asked();
    tell(block, static_cast<double>(candidates.size()) /
                    (static_cast<double>(methods.size()) * (plan_.spec.repeats + 2)));
    candidates.push_back(count(block, method));
  }
  if (plan_.spec.repeats_runs()) time(block, candidates);
  std::vector<Row> rows;
  for (Candidate& candidate : candidates) {
    // The clock may stand still during the shortest runs; zero would be a missing time.
    constexpr double least_time = 1e-9;
    if (candidate.timed && !plan_.spec.repeats_runs())
      candidate.row.cpu_s = {std::max(candidate.counted_s, least_time)};
    rows.push_back(std::move(candidate.row));
  }
  return rows;
}

RowMeter::RowMeter(const SweepPlan& plan, Tell tell, const std::function<bool()>& interrupted)
    : parts_(std::make_unique<Parts>(plan, std::move(tell), interrupted)) {}
RowMeter::~RowMeter() = default;

std::vector<Row> RowMeter::measured(const SweepTask& task) { return parts_->measured(task); }

}  // namespace hmax
