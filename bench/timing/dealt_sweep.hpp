/// A sweep shared by many processes: rank 0 deals out its tasks and alone writes the store.
#pragma once

#include <functional>

#include "bench/timing/sweep.hpp"
#include "core/ranks/ranks.hpp"

namespace hmax {

/// Whether rows are measured beside others, so that their times are rough: the plan explores, or ranks share
/// a node.
bool are_times_rough(const SweepPlan& plan, const Ranks& ranks);

/// Rank 0. As long as it lives the other ranks are in help_sweep().
class SweepDealer {
 public:
  /// @param ranks  must outlive this
  explicit SweepDealer(Ranks& ranks) : ranks_(ranks) {}
  /// Ends all other ranks and waits for them, so that nothing is left on its way.
  ~SweepDealer();
  SweepDealer(const SweepDealer&) = delete;
  SweepDealer& operator=(const SweepDealer&) = delete;

  /// Once: run_sweep() on all ranks, with the same rows but for their times. A measuring sweep is dealt out
  /// by blocks, an exploring one by rows. Where times are rough rank 0 works as well, in a thread, and the
  /// rows are marked as explored; otherwise nothing runs on its node but the dealing, which disturbs no time.
  /// A hand is stored when it is back: a rank that dies costs one. Rows of another machine are in a session
  /// of their own.
  /// @throws InputError        also for what another rank reports: an input it cannot read, another sweep,
  /// another build
  /// @throws std::logic_error  as run_sweep(), for all ranks
  SweepSummary run(const SweepPlan& plan, Store& store,
                   const std::function<void(const SweepProgress&)>& progress = {},
                   const std::function<bool()>& interrupted = {});

 private:
  Ranks& ranks_;
};

/// The other ranks: measures what rank 0 deals, until its dealer ends. What goes wrong here rank 0 throws.
/// @param plan  makes the plan, the same one on all ranks
void help_sweep(Ranks& ranks, const std::function<SweepPlan()>& plan,
                const std::function<bool()>& interrupted = {});

}  // namespace hmax
