/// In which order the tasks of a sweep go to those who measure them.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "bench/timing/row_meter.hpp"

namespace hmax {

/// The tasks of a sweep that nobody has yet, dealt out in hands to workers that ask for them. Within a
/// problem long tasks go before short ones. A worker stays with its problem, whose reference it knows, until
/// no task of it is left; then it takes the problem that has the most expected cost for each worker on it.
class Deck {
 public:
  /// Expected cost of a hand of several tasks, at most [s]: what a worker that dies costs.
  static constexpr double largest_hand = 1;

  /// Time that the dealer needs for a hand, about [s]: shorter hands than that of every worker would make
  /// workers wait.
  static constexpr double dealing_time = 1e-3;

  /// @param plan   must outlive this
  /// @param tasks  each has one problem
  Deck(const SweepPlan& plan, const std::vector<SweepTask>& tasks, std::size_t workers);

  /// What a worker does next: the longest task of a problem, and further ones of it as long as their expected
  /// cost is at most half of an equal share of what is left, or dealing_time for each worker where that is
  /// more, and largest_hand. Empty when all tasks are dealt.
  std::vector<SweepTask> deal(std::size_t worker);

  /// Expected cost of what is left [s].
  [[nodiscard]] double cost() const { return cost_; }

 private:
  struct Dealt {
    double cost = 0;
    SweepTask task;
  };
  struct Pile {
    std::deque<Dealt> tasks;  ///< from long to short
    double cost = 0;
    int workers = 0;
  };
  [[nodiscard]] std::optional<std::size_t> pile_for(std::size_t worker) const;

  std::vector<Pile> piles_;                          ///< one for each problem
  std::vector<std::optional<std::size_t>> pile_of_;  ///< of each worker
  double cost_ = 0;
};

}  // namespace hmax
