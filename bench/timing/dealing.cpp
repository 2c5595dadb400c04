#include "bench/timing/dealing.hpp"

#include <algorithm>
#include <utility>

namespace hmax {

Deck::Deck(const SweepPlan& plan, const std::vector<SweepTask>& tasks, std::size_t workers)
    : piles_(plan.problems.size()), pile_of_(workers) {
  for (const SweepTask& task : tasks) {
    const double cost = expected_cost(plan, *task.block, task.methods);
    Pile& pile = piles_[task.block->problem];
    pile.tasks.push_back({cost, task});
    pile.cost += cost;
    cost_ += cost;
  }
  for (Pile& pile : piles_)
    std::ranges::stable_sort(pile.tasks, [](const Dealt& a, const Dealt& b) { return a.cost > b.cost; });
}

std::optional<std::size_t> Deck::pile_for(std::size_t worker) const {
  if (const auto own = pile_of_[worker]; own && !piles_[*own].tasks.empty()) return own;
  std::optional<std::size_t> best;
  const auto worth = [&](std::size_t pile) { return piles_[pile].cost / (piles_[pile].workers + 1); };
  for (std::size_t i = 0; i < piles_.size(); ++i)
    if (!piles_[i].tasks.empty() && (!best || worth(i) > worth(*best))) best = i;
  return best;
}

std::vector<SweepTask> Deck::deal(std::size_t worker) {
  const std::optional<std::size_t> chosen = pile_for(worker);
  if (pile_of_[worker] != chosen) {
    if (pile_of_[worker]) --piles_[*pile_of_[worker]].workers;
    if (chosen) ++piles_[*chosen].workers;
    pile_of_[worker] = chosen;
  }
  std::vector<SweepTask> hand;
  if (!chosen) return hand;
  Pile& pile = piles_[*chosen];
  const auto workers = static_cast<double>(pile_of_.size());
  const double most = std::min(largest_hand, std::max(cost_ / (2 * workers), workers * dealing_time));
  double taken = 0;
  while (!pile.tasks.empty() && (hand.empty() || taken + pile.tasks.front().cost <= most)) {
    taken += pile.tasks.front().cost;
    hand.push_back(std::move(pile.tasks.front().task));
    pile.tasks.pop_front();
  }
  pile.cost -= taken;
  cost_ -= taken;
  return hand;
}

}  // namespace hmax
