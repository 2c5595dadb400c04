#include "bench/timing/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <random>
#include <sched.h>
#include <set>
#include <stdexcept>
#include <string>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "core/parallel_for.hpp"
#include "results/exports.hpp"
#include "results/merge/merge_stores.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// Few methods, short samples.
SweepSpec quick() {
  SweepSpec spec;
  spec.methods = {"explicit_euler", "rk4", "bogacki_shampine_32", "dormand_prince_54"};
  spec.h = {2, 0.2, 0.1};
  spec.t_end = 10;
  spec.min_sample_s = 2e-5;
  return spec;
}

std::vector<Row> measured(const SweepSpec& spec) {
  Scratch scratch;
  const SweepPlan plan = plan_sweep(spec);
  Store store = open_sweep_store(plan, scratch / "a.sqlite", false);
  const SweepSummary summary = run_sweep(plan, store);
  EXPECT_EQ(summary.measured, plan.rows());
  return store.rows();
}

const Row& row(const std::vector<Row>& rows, const std::string& method, const std::string& mode, double h) {
  const auto found = std::ranges::find_if(
      rows, [&](const Row& r) { return r.key.method == method && r.key.mode == mode && r.key.h == h; });
  if (found == rows.end()) throw std::runtime_error("no row of " + method + " " + mode);
  return *found;
}

std::string refusal(const SweepSpec& spec) {
  return error_of<InputError>([&] { plan_sweep(spec); });
}

TEST(Sweep, TheDefaultsAreTheStudysStepsInBothReadingsWithEveryMethod) {
  const SweepPlan plan = plan_sweep({});
  ASSERT_EQ(plan.problems.size(), 1u);
  EXPECT_EQ(plan.problems[0].id, "liver_forced");
  EXPECT_EQ(plan.methods.size(), choose_methods(study_methods(), plan.problems).size());
  ASSERT_EQ(plan.blocks.size(), 18u);
  const std::vector<double> published{2, 0.6, 0.2, 0.15, 0.05, 0.01, 0.005, 0.0005, 0.00005};
  std::set<std::string> sampled, fixed;
  for (std::size_t i = 0; i < 18; i += 2) {
    EXPECT_EQ(plan.blocks[i].mode, "fixed");
    EXPECT_EQ(plan.blocks[i].run.h, published[i / 2]);
    EXPECT_EQ(plan.blocks[i].run.t_end, 100);
    EXPECT_EQ(plan.blocks[i].methods.size(), std::ranges::count_if(plan.methods, &Method::fixed_step));
    EXPECT_EQ(plan.blocks[i + 1].mode, "sampled");
    EXPECT_EQ(plan.blocks[i + 1].run.every, published[i / 2]);
    for (const std::size_t m : plan.blocks[i + 1].methods) EXPECT_GT(plan.methods[m].error_order, 0);
  }
}

TEST(Sweep, EveryRowIsCompleteInBothReadings) {
  const std::vector<Row> rows = measured(quick());
  ASSERT_EQ(rows.size(), 3u * 4u + 3u * 2u);
  for (const Row& r : rows) {
    SCOPED_TRACE(r.key.method + " " + r.key.mode + " " + std::to_string(r.key.h));
    EXPECT_EQ(r.key.problem, "liver_forced");
    EXPECT_EQ(r.key.parameters, "m=1.45 c=2 k1=0.7 k3=0.8 P=0.5 w=0.5");
    EXPECT_EQ(r.key.y0, "0.5,1");
    EXPECT_EQ(r.cpu_s.size(), 9u);
    for (const double seconds : r.cpu_s) EXPECT_GT(seconds, 0);
    EXPECT_GE(r.runs_per_sample, 1);
    EXPECT_EQ(r.subnormals, 0);
    EXPECT_FALSE(r.reference.empty());
    EXPECT_GT(r.reference_error, 0);
    EXPECT_LT(r.reference_error, 1e-12);
    EXPECT_GE(r.rhs, r.steps);
    if (r.outcome != "reached_end") continue;
    EXPECT_EQ(r.status, "");
    EXPECT_EQ(r.t_reached, 10);
    EXPECT_GE(r.error_end, 0);
    EXPECT_GE(r.error_global, r.error_end);
    EXPECT_LT(r.error_global, r.key.h < 2 ? 0.2 : 1e9);
    if (r.key.mode == "fixed") {
      EXPECT_EQ(r.steps, std::lround(10 / r.key.h));
      EXPECT_EQ(r.key.control, "none");
      EXPECT_EQ(r.key.rtol, 0);
    } else {
      EXPECT_EQ(r.key.control, "deadband");
      EXPECT_EQ(r.key.rtol, 1e-6);
      EXPECT_LT(r.error_global, 1e-4) << "an output point is as good as a step";
    }
  }
}

TEST(Sweep, ADivergedRunIsARowWithItsTimeOfDivergence) {
  SweepSpec spec = quick();
  spec.methods = {"explicit_euler"};
  spec.h = {2};
  spec.t_end = 100;
  const std::vector<Row> rows = measured(spec);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].outcome, "diverged");
  EXPECT_GT(rows[0].t_reached, 2);
  EXPECT_LT(rows[0].t_reached, 100);
  EXPECT_TRUE(std::isnan(rows[0].error_end));
  EXPECT_TRUE(std::isnan(rows[0].error_global));
  EXPECT_TRUE(says(rows[0].status, "diverged"));
  EXPECT_EQ(rows[0].cpu_s.size(), 9u);
}

TEST(Sweep, TheRootMeanSquareErrorIsThatOfTheLargestComponentByTheTrapezoidalRule) {
  // x' = v, v' = -v from (0, 1): explicit Euler has v_n = q^n with q = 1 - h and x_n = 1 - q^n, so that both
  // components err by e_n = exp(-n h) - q^n: their largest is e_n, not sqrt(2) e_n.
  SweepSpec spec = quick();
  spec.problems = {
      {.name = "liver_linear", .settings = {.parameters = {{"m", 1}, {"c", 1}, {"k1", 0}}, .y0 = {0, 1}}}};
  spec.methods = {"explicit_euler"};
  spec.h = {0.25};
  spec.t_end = 5;
  const std::vector<Row> rows = measured(spec);
  ASSERT_EQ(rows.size(), 1u);
  constexpr int N = 20;
  const double h = 0.25, q = 1 - h, a = std::exp(-h);
  // (h / 2) sum_n (e_n^2 + e_(n-1)^2) = h (sum_n e_n^2 - e_N^2 / 2), since e_0 = 0, by three geometric sums.
  const auto sum = [](double ratio) { return (1 - std::pow(ratio, N + 1)) / (1 - ratio); };
  const double end = std::pow(a, N) - std::pow(q, N);
  const double integral = h * (sum(a * a) - 2 * sum(a * q) + sum(q * q) - end * end / 2);
  EXPECT_NEAR(rows[0].error_l2, std::sqrt(integral / 5), 1e-13);
  EXPECT_NEAR(rows[0].error_end, end, 1e-13);
  EXPECT_NEAR(rows[0].error_global, std::pow(a, 4) - std::pow(q, 4), 1e-13) << "e_n is largest at t = 1 s";
}

TEST(Sweep, TheErrorOfFixedStepsFallsByTwoToTheOrder) {
  SweepSpec spec = quick();
  spec.methods = {"rk4", "rk2_heun", "explicit_euler"};
  spec.h = {0.05, 0.025};
  spec.sampled = false;
  const std::vector<Row> rows = measured(spec);
  for (const auto& [method, order] :
       std::map<std::string, int>{{"rk4", 4}, {"rk2_heun", 2}, {"explicit_euler", 1}}) {
    const double ratio =
        row(rows, method, "fixed", 0.05).error_global / row(rows, method, "fixed", 0.025).error_global;
    EXPECT_NEAR(std::log2(ratio), order, 0.1) << method;
  }
}

TEST(Sweep, AnErrorAtTheEndIsThatOfThePublishedEndState) {
  // Taylor series in 128 bits, docs/reference/facts.md.
  constexpr double x = -3.3690941329057441755e-01, v = 1.5203434594206605961e-01;
  SweepSpec spec = quick();
  spec.methods = {"rk4"};
  spec.h = {0.1};
  spec.sampled = false;
  const Row r = measured(spec).at(0);
  const RunRecord run =
      find_method("rk4").bind(make_problem("liver_forced")).run({.t_end = 10, .h = 0.1}, {});
  EXPECT_NEAR(r.error_end, std::max(std::abs(run.y[0] - x), std::abs(run.y[1] - v)), 1e-15);
}

TEST(Sweep, AnOutputIntervalCostsNoStepsAndChangesNoErrorAtTheEnd) {
  const std::vector<Row> rows = measured(quick());
  for (const char* method : {"bogacki_shampine_32", "dormand_prince_54"}) {
    const Row &coarse = row(rows, method, "sampled", 2), &fine = row(rows, method, "sampled", 0.1);
    EXPECT_EQ(coarse.steps, fine.steps);
    EXPECT_EQ(coarse.rejected, fine.rejected);
    EXPECT_EQ(coarse.error_end, fine.error_end);
  }
}

TEST(Sweep, TighterTolerancesGiveSmallerErrorsAndMoreSteps) {
  SweepSpec spec = quick();
  spec.h = {};
  spec.tolerances = {{1e-4, 1e-4}, {1e-8, 1e-8}};
  const std::vector<Row> rows = measured(spec);
  ASSERT_EQ(rows.size(), 4u);  // rk4 and explicit_euler have no error estimate
  for (const Row& r : rows) {
    EXPECT_EQ(r.key.mode, "adaptive");
    EXPECT_EQ(r.key.h, 0);
    EXPECT_GE(r.error_global, r.error_end);
    EXPECT_LT(r.error_global, 1000 * r.key.rtol);
  }
  EXPECT_LT(rows[0].steps, rows[1].steps);
  EXPECT_GT(rows[0].error_global, rows[1].error_global);
}

TEST(Sweep, WithoutAReferenceThereIsNoErrorAndSoNoTime) {
  // Self-exciting: the motion grows and quickens until no reference can follow it.
  SweepSpec spec = quick();
  spec.problems[0].settings.parameters = {{"c", -2.0}};
  spec.methods = {"dormand_prince_54"};
  spec.h = {2};
  spec.fixed = false;
  spec.sampled_tolerance = {1e-2, 1e-2};
  spec.t_end = 60;
  spec.max_steps = 20'000;
  const Row r = measured(spec).at(0);
  EXPECT_EQ(r.outcome, "reached_end") << "a loose tolerance damps what it cannot resolve";
  EXPECT_TRUE(r.cpu_s.empty());
  EXPECT_TRUE(std::isnan(r.error_end));
  EXPECT_TRUE(says(r.status, "reference ends"));
}

TEST(Sweep, ARunThatReachesTheLimitOfStepsIsGivenUpAndNotTimed) {
  SweepSpec spec = quick();
  spec.methods = {"bogacki_shampine_32"};
  spec.h = {};
  spec.tolerances = {{1e-8, 1e-8}};
  spec.max_steps = 100;
  const Row r = measured(spec).at(0);
  EXPECT_EQ(r.outcome, "too_many_steps");
  EXPECT_TRUE(r.cpu_s.empty());
  EXPECT_TRUE(std::isnan(r.error_global));
  EXPECT_TRUE(says(r.status, "given up"));
}

TEST(Sweep, SubnormalNumbersAreCounted) {
  // Critically damped and at rest at last: the state fades through the subnormal numbers.
  SweepSpec spec = quick();
  spec.problems = {{"liver_linear", {.parameters = {{"m", 1.0}, {"k1", 1.0}, {"c", 2.0}}, .y0 = {1, -1}}}};
  spec.methods = {"rk4"};
  spec.h = {0.5};
  spec.t_end = 740;
  spec.sampled = false;
  EXPECT_GT(measured(spec).at(0).subnormals, 5);
}

TEST(Sweep, EveryMaterialIsARowOfItsOwn) {
  SweepSpec spec = quick();
  spec.problems.clear();
  for (const char* material : {"male_slim", "female_fat", "female_fat:heavy"})
    spec.problems.push_back({"liver_benchmark", {.material = material}});
  spec.methods = {"rk4"};
  spec.h = {0.1};
  const std::vector<Row> rows = measured(spec);
  std::set<std::string> materials;
  for (const Row& r : rows) materials.insert(r.key.material);
  EXPECT_EQ(materials, (std::set<std::string>{"male_slim", "female_fat", "female_fat:heavy"}));
}

TEST(Sweep, AUsersSystemAndTableauTakePart) {
  Scratch scratch;
  write_text(scratch / "decay.toml", "[equations]\nu = \"-u\"\n[initial]\nu = 1\n");
  write_text(scratch / "mine.toml", "a = [[], [1]]\nb = [0.5, 0.5]\nb_hat = [1, 0]\n");
  SweepSpec spec = quick();
  spec.problems = {{scratch / "decay.toml", {}}};
  spec.methods = {};
  spec.tableaux = {scratch / "mine.toml"};
  spec.h = {0.1};
  spec.t_end = 1;
  const std::vector<Row> rows = measured(spec);
  ASSERT_EQ(rows.size(), 2u);
  const Row& fixed = row(rows, "mine", "fixed", 0.1);
  EXPECT_NEAR(fixed.error_end, std::pow(1 - 0.1 + 0.005, 10) - std::exp(-1.0), 1e-9);
  EXPECT_EQ(fixed.key.problem, "decay");
}

TEST(Sweep, AsksWhileAReferenceIsComputedWhetherToEnd) {
  const Scratch scratch;
  SweepSpec spec = quick();
  spec.problems = {{"hires", {}}};
  spec.methods = {"rk4"};
  spec.h = {20};
  spec.sampled = false;
  spec.t_end = 300;
  const SweepPlan plan = plan_sweep(spec);
  Store store = open_sweep_store(plan, scratch / "a.sqlite", false);
  int asked = 0;
  EXPECT_TRUE(run_sweep(plan, store, {}, [&] { return ++asked > 100; }).interrupted)
      << "a run of 15 steps and its repetitions do not ask as often: " << asked;
}

TEST(Sweep, WhatIsStoredIsSkippedWhenASweepIsResumed) {
  Scratch scratch;
  const SweepPlan plan = plan_sweep(quick());
  int blocks = 0;
  {
    Store store = open_sweep_store(plan, scratch / "a.sqlite", false);
    const SweepSummary first = run_sweep(plan, store, {}, [&] { return store.size() >= 6 && ++blocks > 0; });
    EXPECT_TRUE(first.interrupted);
    EXPECT_EQ(first.measured, store.size());
    EXPECT_LT(first.measured, plan.rows());
  }
  Store store = open_sweep_store(plan, scratch / "a.sqlite", true);
  const std::int64_t before = store.size();
  std::vector<SweepProgress> told;
  const SweepSummary second = run_sweep(plan, store, [&](const SweepProgress& p) { told.push_back(p); });
  EXPECT_FALSE(second.interrupted);
  EXPECT_EQ(second.skipped, before);
  EXPECT_EQ(second.measured, plan.rows() - before);
  EXPECT_EQ(second.rows, plan.rows());
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.back().rows_done, plan.rows());
  EXPECT_NEAR(told.back().fraction, 1, 1e-12);
  for (std::size_t i = 1; i < told.size(); ++i) EXPECT_GE(told[i].fraction, told[i - 1].fraction);
  EXPECT_EQ(run_sweep(plan, store).skipped, plan.rows());
  EXPECT_EQ(store.sessions().size(), 2u) << "a sweep with nothing to do is no session";
}

/// Starts a process that begins or resumes a sweep, and dies where it has taken so much CPU time [us]; 0:
/// never. Elapsed time would tell little: on a busy machine the sweep may be over when its parent wakes up.
pid_t start_sweep(const SweepPlan& plan, const std::filesystem::path& file, long most_cpu = 0) {
  const pid_t child = fork();
  if (child != 0) return child;
  int code = 0;
  try {
    const itimerval end{.it_interval = {}, .it_value = {.tv_sec = 0, .tv_usec = most_cpu}};
    setitimer(ITIMER_PROF, &end, nullptr);
    Store store = open_sweep_store(plan, file, true);
    run_sweep(plan, store);
  } catch (const std::exception& error) {
    fprintf(stderr, "child: %s\n", error.what());
    code = 1;
  }
  _exit(code);
}

/// How a process ends, as wait() tells.
int ended(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(Sweep, KilledAtRandomMomentsAndResumedItLosesNoRowAndDoublesNone) {
  Scratch scratch;
  const auto file = scratch / "a.sqlite";
  SweepSpec spec = quick();
  spec.h = {1, 0.5, 0.4, 0.25, 0.2, 0.125, 0.1, 0.05, 0.04, 0.02};
  spec.min_sample_s = 2e-4;
  const SweepPlan plan = plan_sweep(spec);
  std::mt19937 random(20240229);
  int interrupted = 0;
  std::int64_t most = 0;
  for (int kill_number = 0; kill_number < 10; ++kill_number) {
    const int status = ended(start_sweep(plan, file, 1 + static_cast<long>(random() % 40'000)));
    interrupted += WIFSIGNALED(status);
    EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
    const std::int64_t size = Store::open_or_create(file).size();
    EXPECT_GE(size, most) << "a stored row was lost";
    most = size;
  }
  EXPECT_GE(interrupted, 5);

  Store store = open_sweep_store(plan, file, true);
  run_sweep(plan, store);
  std::set<RowKey> expected, found;
  for (const SweepBlock& block : plan.blocks)
    for (const std::size_t m : block.methods) expected.insert(row_key(plan, block, m));
  for (const Row& r : store.rows()) EXPECT_TRUE(found.insert(r.key).second);
  EXPECT_EQ(found, expected);
}

/// All that a row says but its times and its session.
Row without_times(Row row) {
  row.cpu_s.clear();
  row.runs_per_sample = row.session = 0;
  return row;
}

void expect_same_rows(const std::vector<Row>& a, const std::vector<Row>& b) {
  ASSERT_EQ(a.size(), b.size());
  std::vector<Row> x, y;
  std::ranges::transform(a, std::back_inserter(x), without_times);
  std::ranges::transform(b, std::back_inserter(y), without_times);
  EXPECT_EQ(rows_to_jsonl(x), rows_to_jsonl(y));
}

TEST(Exploring, HasTheRowsOfAMeasuringSweepOnAnyNumberOfThreads) {
  SweepSpec spec = quick();
  spec.problems.push_back({"liver_linear", {}});
  spec.problems.push_back({"liver_cubic", {}});
  // Steps of SUNDIALS, where it is there, end at other times than those of hmax, by rounding.
  const std::string other = "arkode_erk_heun_euler_212";
  if (std::ranges::count(methods(), other, &Method::id) > 0) spec.methods.insert(spec.methods.begin(), other);
  const std::vector<Row> alone = measured(spec);
  EXPECT_TRUE(std::ranges::none_of(alone, &Row::explored));
  spec.explore = true;
  spec.repeats = 1;
  const std::size_t before = jobs();
  for (const std::size_t threads : {1U, 3U}) {
    set_jobs(threads);
    std::vector<Row> rows = measured(spec);
    for (Row& row : rows) {
      EXPECT_TRUE(row.explored);
      EXPECT_EQ(row.cpu_s.size(), 1U);
      EXPECT_GT(row.cpu_s.at(0), 0);
      row.explored = false;
    }
    expect_same_rows(rows, alone);
  }
  set_jobs(before);
}

TEST(Exploring, TimesSeveralRepetitions) {
  SweepSpec spec = quick();
  spec.explore = true;
  spec.repeats = 3;
  for (const Row& row : measured(spec)) EXPECT_EQ(row.cpu_s.size(), 3U);
}

TEST(Exploring, IsNotResumedAsMeasuring) {
  const Scratch scratch;
  SweepSpec spec = quick();
  spec.explore = true;
  const SweepPlan plan = plan_sweep(spec);
  Store store = open_sweep_store(plan, scratch / "explored.sqlite", false);
  const SweepSummary ended = run_sweep(plan, store, {}, [&] { return store.size() >= 3; });
  EXPECT_TRUE(ended.interrupted);
  EXPECT_LT(ended.rows, plan.rows());
  EXPECT_FALSE(ended.warnings.empty());
  EXPECT_EQ(run_sweep(plan, store).measured, plan.rows() - ended.rows);
  spec.explore = false;
  EXPECT_TRUE(says(
      error_of<InputError>([&] { open_sweep_store(plan_sweep(spec), scratch / "explored.sqlite", true); }),
      "explored"));
  spec.repeats = 1;
  EXPECT_TRUE(says(refusal(spec), "at least 9"));
}

TEST(Measuring, KeepsOneThreadOnItsCore) {
  cpu_set_t before, during;
  CPU_ZERO(&during);
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  int fewest = CPU_COUNT(&before);
  Scratch scratch;
  const SweepPlan plan = plan_sweep(quick());
  Store store = open_sweep_store(plan, scratch / "a.sqlite", false);
  run_sweep(plan, store, {}, [&] {
    sched_getaffinity(0, sizeof during, &during);
    fewest = std::min(fewest, CPU_COUNT(&during));
    return false;
  });
  EXPECT_EQ(fewest, 1) << "while rows are timed";
  sched_getaffinity(0, sizeof during, &during);
  EXPECT_TRUE(CPU_EQUAL(&before, &during)) << "and the threads of others are free afterwards";
}

TEST(Shards, ShareTheBlocksAndTheExpectedTime) {
  SweepSpec spec = quick();
  spec.h = {1, 0.5, 0.4, 0.25, 0.2, 0.125, 0.1, 0.05, 0.04, 0.02};
  const SweepPlan plan = plan_sweep(spec);
  const auto cost = [](const SweepPlan& of) {
    double total = 0;
    for (const SweepBlock& block : of.blocks) total += expected_cost(of, block, block.methods);
    return total;
  };
  double largest_block = 0;
  for (const SweepBlock& block : plan.blocks)
    largest_block = std::max(largest_block, expected_cost(plan, block, block.methods));
  for (const int count : {1, 2, 3, 7, 100}) {
    std::int64_t rows = 0;
    for (int i = 1; i <= count; ++i) {
      const SweepPlan shard = shard_of(plan, {i, count});
      EXPECT_EQ(shard.canonical, plan.canonical);
      rows += shard.rows();
      EXPECT_LE(cost(shard), cost(plan) / count + largest_block) << i << " of " << count;
    }
    EXPECT_EQ(rows, plan.rows()) << count;
  }
  EXPECT_THROW(shard_of(plan, {0, 3}), InputError);
  EXPECT_THROW(shard_of(plan, {4, 3}), InputError);
}

TEST(Shards, KilledResumedAndMergedHaveTheRowsOfASerialRun) {
  const Scratch scratch;
  SweepSpec spec = quick();
  spec.h = {1, 0.5, 0.4, 0.25, 0.2, 0.125, 0.1};
  spec.min_sample_s = 2e-4;
  const SweepPlan plan = plan_sweep(spec);
  constexpr int count = 4;
  const auto file = [&](int i) { return scratch / ("shard_" + std::to_string(i) + ".sqlite"); };
  const auto start = [&](int i, long most_cpu = 0) {
    return start_sweep(shard_of(plan, {i, count}), file(i), most_cpu);
  };
  std::mt19937 random(5);
  int interrupted = 0;
  for (int kill_number = 0; kill_number < 12; ++kill_number) {
    const int shard = 1 + static_cast<int>(random() % count);
    interrupted += WIFSIGNALED(ended(start(shard, 1 + static_cast<long>(random() % 30'000))));
  }
  EXPECT_GE(interrupted, 4);
  Store merged = Store::open_or_create(scratch / "merged.sqlite");
  Merger merger(merged);
  for (int i = 1; i <= count; ++i) {
    ASSERT_EQ(ended(start(i)), 0);
    merger.add(file(i));
  }
  EXPECT_EQ(merger.summary().added, plan.rows());
  EXPECT_EQ(merger.summary().doubled, 0);
  Store serial = open_sweep_store(plan, scratch / "serial.sqlite", false);
  run_sweep(plan, serial);
  expect_same_rows(merged.rows(), serial.rows());
  // The merged store is that of the whole sweep.
  Store again = open_sweep_store(plan, scratch / "merged.sqlite", true);
  EXPECT_EQ(run_sweep(plan, again).measured, 0);
}

TEST(SweepStore, IsNotTakenForAnotherSweep) {
  Scratch scratch;
  const auto file = scratch / "a.sqlite";
  SweepSpec spec = quick();
  spec.h = {2};
  const SweepPlan plan = plan_sweep(spec);
  {
    Store store = open_sweep_store(plan, file, false);
    run_sweep(plan, store);
  }
  EXPECT_TRUE(says(error_of<InputError>([&] { open_sweep_store(plan, file, false); }), "--resume"));
  spec.h = {2, 1};
  const std::string other_steps =
      error_of<InputError>([&] { open_sweep_store(plan_sweep(spec), file, true); });
  EXPECT_TRUE(says(other_steps, "h was [2.0] and is [2.0,1.0]"));
  spec.h = {2};
  spec.problems[0].settings.parameters = {{"c", 3.0}};
  EXPECT_TRUE(
      says(error_of<InputError>([&] { open_sweep_store(plan_sweep(spec), file, true); }), "problems"));
  EXPECT_EQ(Store::open_existing(file).size(), 6);
}

TEST(SweepStore, OfAnotherSchemaIsLeftAlone) {
  Scratch scratch;
  const auto file = scratch / "a.sqlite";
  const SweepPlan plan = plan_sweep(quick());
  open_sweep_store(plan, file, false);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database, "PRAGMA user_version = 99", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const std::string before = read_text(file);
  EXPECT_TRUE(says(error_of<InputError>([&] { open_sweep_store(plan, file, true); }), "schema 99"));
  EXPECT_EQ(read_text(file), before);
}

TEST(SweepPlan, RefusesWhatCannotBeMeasuredBeforeAnythingRuns) {
  const auto changed = [](auto&& change) {
    SweepSpec spec = quick();
    change(spec);
    return refusal(spec);
  };
  using S = SweepSpec;
  const double nan = std::nan(""), inf = INFINITY;
  for (const double h : {0.0, -1.0, nan, inf}) {
    EXPECT_NE(changed([&](S& s) { s.h = {h}; }), "");
    EXPECT_NE(changed([&](S& s) { s.h = {1, h}, s.fixed = false; }), "");
  }
  EXPECT_TRUE(says(changed([](S& s) { s.h = {1e-9}; }), "more than the limit"));
  EXPECT_TRUE(says(changed([](S& s) { s.h = {1e-7}, s.fixed = false; }), "in memory"));
  for (const double t_end : {0.0, -1.0, nan, inf}) EXPECT_NE(changed([&](S& s) { s.t_end = t_end; }), "");
  EXPECT_TRUE(says(changed([](S& s) { s.methods = {"rk5"}; }), "unknown method"));
  EXPECT_TRUE(says(changed([](S& s) { s.problems[0].name = "liver_force"; }), "liver_forced"));
  EXPECT_TRUE(says(changed([](S& s) { s.problems[0].settings.parameters = {{"q", 1}}; }), "'q'"));
  EXPECT_TRUE(says(changed([](S& s) { s.h = {1, 1}; }), "twice"));
  EXPECT_TRUE(says(changed([](S& s) { s.repeats = 8; }), "at least 9"));
  EXPECT_TRUE(says(changed([](S& s) { s.methods = {"rk4"}, s.fixed = false; }), "error estimate"));
  EXPECT_TRUE(says(changed([](S& s) { s.fixed = s.sampled = false; }), "--fixed"));
  EXPECT_TRUE(says(changed([](S& s) { s.h = {}; }), "--rtol"));
  EXPECT_NE(changed([](S& s) { s.sampled_tolerance.rtol = 0; }), "");
  EXPECT_NE(changed([&](S& s) { s.h = {}, s.tolerances = {{nan, 1e-6}}; }), "");
  EXPECT_NE(changed([](S& s) { s.h = {}, s.tolerances = {{1e-6, 1e-6}}, s.methods = {"rk4"}; }), "");
}

// The reference of a stiff problem is integrated while errors are measured, which takes many times the run.
TEST(Sweep, TheBudgetOfARunIsThatOfTheRunAlone) {
  SweepSpec spec;
  spec.problems = {{.name = "oregonator", .settings = {}}};
  spec.methods = {"radau_iia_5"};
  spec.h.clear();
  spec.tolerances = {{1e-9, 1e-9}};
  spec.min_sample_s = 2e-5;
  spec.budget_s = 0.25;
  const std::vector<Row> rows = measured(spec);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].outcome, "reached_end") << rows[0].status;
  EXPECT_LT(rows[0].error_end, 1e-3);
}

}  // namespace
}  // namespace hmax
