/// A sweep on its way into its store, whoever measures its rows.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/timing/row_meter.hpp"
#include "results/fingerprint.hpp"

namespace hmax {

/// What of a sweep is missing in its store, and what has come in.
class Sweeper {
 public:
  /// The arguments must outlive this.
  /// @param explores  rows come in explored; otherwise they take the place of explored ones
  Sweeper(const SweepPlan& plan, Store& store, const std::function<void(const SweepProgress&)>& progress,
          const std::function<bool()>& interrupted, bool explores)
      : plan_(plan), store_(store), progress_(progress), interrupted_(interrupted), explores_(explores) {}

  /// Begins a session where rows are missing.
  /// @param measure  measures all tasks and keeps their rows; SweepEnded ends it and is no error
  SweepSummary run(const std::function<void(const std::vector<SweepTask>& tasks)>& measure);

  /// Commits rows to the session that was begun or continued last.
  void keep(std::span<const Row> rows);
  /// @param fraction  of what is to be measured that is done
  void tell(double fraction, const std::string& what) const;
  SweepSummary& summary() { return summary_; }
  void warn(std::string sentence) { summary_.warnings.push_back(std::move(sentence)); }

  [[nodiscard]] const SweepPlan& plan() const { return plan_; }
  [[nodiscard]] Store& store() { return store_; }
  /// May be empty.
  [[nodiscard]] const std::function<bool()>& interrupted() const { return interrupted_; }
  /// Whether somebody listens to tell().
  [[nodiscard]] bool is_watched() const { return static_cast<bool>(progress_); }
  /// The session that run() has begun; 0 before.
  [[nodiscard]] std::int64_t session() const { return session_; }

 private:
  [[nodiscard]] std::vector<std::size_t> missing(const SweepBlock& block) const;
  void begin_session();

  const SweepPlan& plan_;
  Store& store_;
  const std::function<void(const SweepProgress&)>& progress_;
  const std::function<bool()>& interrupted_;
  bool explores_;
  SweepSummary summary_;
  std::int64_t session_ = 0;
};

}  // namespace hmax
