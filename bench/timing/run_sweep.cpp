#include <algorithm>
#include <memory>
#include <mutex>

#include "bench/timing/row_meter.hpp"
#include "bench/timing/sweep.hpp"
#include "bench/timing/sweeper.hpp"
#include "catalogue/models/problems.hpp"
#include "core/parallel_for.hpp"

namespace hmax {

namespace {

/// A plan for another thread: some systems have one workspace. Bodies are shared.
SweepPlan with_own_problems(SweepPlan plan) {
  for (std::size_t i = 0; i < plan.problems.size(); ++i)
    if (!plan.problems[i].body)
      plan.problems[i] = make_problem(plan.spec.problems[i].name, plan.spec.problems[i].settings);
  return plan;
}

/// One block after the other.
void measure(Sweeper& sweeper, const std::vector<SweepTask>& tasks) {
  const SweepPlan& plan = sweeper.plan();
  double total = 0, done = 0, here = 0;  // expected costs
  for (const SweepTask& task : tasks) total += expected_cost(plan, *task.block, task.methods);
  RowMeter::Tell tell;
  if (sweeper.is_watched())
    tell = [&](double share, const std::string& what) { sweeper.tell((done + share * here) / total, what); };
  RowMeter meter(plan, tell, sweeper.interrupted());
  for (const SweepTask& task : tasks) {
    here = expected_cost(plan, *task.block, task.methods);
    sweeper.keep(meter.measured(task));
    done += here;
    here = 0;
    if (tell) tell(1, in_words(plan, *task.block));
  }
}

/// Many rows at once.
void explore(Sweeper& sweeper, const std::vector<SweepTask>& tasks) {
  const std::vector<SweepTask> rows = single_rows(sweeper.plan(), tasks);
  std::vector<SweepPlan> plans;
  while (plans.size() < std::min(jobs(), rows.size())) plans.push_back(with_own_problems(sweeper.plan()));
  std::vector<std::unique_ptr<RowMeter>> threads;
  for (const SweepPlan& plan : plans)
    threads.push_back(std::make_unique<RowMeter>(plan, nullptr, sweeper.interrupted()));
  std::mutex storing;
  std::size_t stored = 0;
  parallel_for(
      rows.size(),
      [&](std::size_t i, std::size_t worker) {
        const std::vector<Row> done = threads[worker]->measured(rows[i]);
        const std::scoped_lock lock(storing);
        sweeper.keep(done);
        ++stored;
      },
      [&](std::size_t done) {
        sweeper.tell(static_cast<double>(done) / static_cast<double>(rows.size()), "exploring");
      },
      [&] { return sweeper.interrupted() && sweeper.interrupted()(); });
  if (stored < rows.size()) throw SweepEnded{};
}

}  // namespace

SweepSummary run_sweep(const SweepPlan& plan, Store& store,
                       const std::function<void(const SweepProgress&)>& progress,
                       const std::function<bool()>& interrupted) {
  Sweeper sweeper(plan, store, progress, interrupted, plan.spec.explore);
  return sweeper.run(
      [&](const std::vector<SweepTask>& tasks) { (plan.spec.explore ? explore : measure)(sweeper, tasks); });
}

}  // namespace hmax
