#include "bench/timing/dealing.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// Two problems, the second of twice the steps; tasks of one row each, or of whole blocks.
SweepPlan plan_of(double t_end) {
  SweepSpec spec;
  spec.problems = {{"liver_forced", {}}, {"liver_linear", {}}};
  spec.methods = {"explicit_euler", "rk4", "dormand_prince_54"};
  spec.h = {0.1, 0.001, 0.01, 0.0001, 0.02};
  spec.sampled = false;
  spec.t_end = t_end;
  return plan_sweep(spec);
}

std::vector<SweepTask> rows_of(const SweepPlan& plan) {
  std::vector<SweepTask> tasks;
  for (const SweepBlock& block : plan.blocks)
    for (const std::size_t method : block.methods) tasks.push_back({&block, {method}});
  return tasks;
}

double cost_of(const SweepPlan& plan, const std::vector<SweepTask>& hand) {
  double cost = 0;
  for (const SweepTask& task : hand) cost += expected_cost(plan, *task.block, task.methods);
  return cost;
}

TEST(Deck, DealsEveryTaskOnceAndTheLongOnesFirst) {
  const SweepPlan plan = plan_of(1000);
  const std::vector<SweepTask> tasks = rows_of(plan);
  Deck deck(plan, tasks, 3);
  EXPECT_NEAR(deck.cost(), cost_of(plan, tasks), 1e-9 * deck.cost());
  std::set<std::pair<const SweepBlock*, std::size_t>> seen;
  std::vector<double> last(2, std::numeric_limits<double>::infinity());
  for (std::size_t worker = 0;; worker = (worker + 1) % 3) {
    const std::vector<SweepTask> hand = deck.deal(worker);
    if (hand.empty()) break;
    for (const SweepTask& task : hand) {
      EXPECT_TRUE(seen.emplace(task.block, task.methods.front()).second);
      const double cost = expected_cost(plan, *task.block, task.methods);
      EXPECT_LE(cost, last[task.block->problem]);
      last[task.block->problem] = cost;
    }
  }
  EXPECT_EQ(seen.size(), tasks.size());
  EXPECT_NEAR(deck.cost(), 0, 1e-9);
}

TEST(Deck, HandsOfSeveralTasksAreShort) {
  const SweepPlan plan = plan_of(100);
  Deck deck(plan, rows_of(plan), 4);
  bool several = false, single = false;
  for (std::size_t worker = 0;; worker = (worker + 1) % 4) {
    const double left = deck.cost();
    const std::vector<SweepTask> hand = deck.deal(worker);
    if (hand.empty()) break;
    (hand.size() > 1 ? several : single) = true;
    if (hand.size() == 1) continue;
    EXPECT_LE(cost_of(plan, hand), std::min(Deck::largest_hand, left / 8));
    EXPECT_TRUE(std::ranges::all_of(
        hand, [&](const SweepTask& t) { return t.block->problem == hand[0].block->problem; }));
  }
  EXPECT_TRUE(several && single);
}

TEST(Deck, HandsOfRowsOfUnknownCostAreFew) {
  SweepSpec spec;
  spec.problems = {{"liver_forced", {}}};
  spec.methods = {"dormand_prince_54", "bogacki_shampine_32", "adams_pece"};
  spec.h.clear();
  spec.fixed = spec.sampled = false;
  for (int i = 0; i < 100; ++i) spec.tolerances.push_back({1e-4 / (i + 1), 1e-4 / (i + 1)});
  spec.explore = true;
  spec.repeats = 1;
  const SweepPlan plan = plan_sweep(spec);
  Deck deck(plan, rows_of(plan), 16);
  // An adaptive run with its errors takes milliseconds; a hand of many would leave others without work.
  EXPECT_LE(deck.deal(0).size(), 10U);
}

TEST(Deck, AWorkerStaysWithItsProblemAndGoesWhereMostIsLeft) {
  const SweepPlan plan = plan_of(1000);
  Deck deck(plan, rows_of(plan), 2);
  const auto problem = [](const std::vector<SweepTask>& hand) { return hand.at(0).block->problem; };
  const std::size_t first = problem(deck.deal(0));
  EXPECT_NE(problem(deck.deal(1)), first) << "a problem that nobody is at has more left for each";
  EXPECT_EQ(problem(deck.deal(0)), first);
  EXPECT_EQ(problem(deck.deal(0)), first);
  // One worker alone ends its problem before it begins the other one.
  int changes = 0;
  for (std::size_t at = first;;) {
    const std::vector<SweepTask> hand = deck.deal(0);
    if (hand.empty()) break;
    changes += problem(hand) != at;
    at = problem(hand);
  }
  EXPECT_EQ(changes, 1);
  EXPECT_TRUE(deck.deal(1).empty());
}

TEST(Deck, HandsOfManyWorkersAreLongEnoughForTheDealer) {
  const SweepPlan plan = plan_of(1);  // rows of 22 ms
  Deck deck(plan, rows_of(plan), 100);
  const std::vector<SweepTask> hand = deck.deal(0);
  EXPECT_EQ(hand.size(), 4U);
  EXPECT_LE(cost_of(plan, hand), 100 * Deck::dealing_time);
}

/// The makespan of workers that need as long as expected.
double makespan(const SweepPlan& plan, const std::vector<SweepTask>& tasks, std::size_t workers) {
  Deck deck(plan, tasks, workers);
  std::vector<double> busy(workers, 0);
  for (;;) {
    const auto next = std::ranges::min_element(busy);
    const std::vector<SweepTask> hand = deck.deal(static_cast<std::size_t>(next - busy.begin()));
    if (hand.empty()) return *std::ranges::max_element(busy);
    *next += cost_of(plan, hand);
  }
}

TEST(Deck, WorkersEndTogetherThoughTasksAreUnequal) {
  const SweepPlan plan = plan_of(2000);
  const std::vector<SweepTask> tasks = rows_of(plan);
  double longest = 0;
  for (const SweepTask& task : tasks) longest = std::max(longest, cost_of(plan, {task}));
  for (const std::size_t workers : {1U, 2U, 3U, 5U, 8U}) {
    // No schedule can be shorter than the larger of the two; the longest first is at most a third above it.
    const double bound = std::max(longest, cost_of(plan, tasks) / static_cast<double>(workers));
    EXPECT_LE(makespan(plan, tasks, workers), 4.0 / 3 * bound + 1e-9) << workers;
  }
}

}  // namespace
}  // namespace hmax
