/// The answer of a query of step limits for people, its progress, and the exit code that follows from it.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "cli/shared/console.hpp"
#include "cli/stability/row_progress.hpp"
#include "limits/query/query_limits.hpp"

namespace hmax {

/// Shows how a query goes on in a line of progress; Ctrl-C ends it.
class LimitProgress : public LimitWatcher {
 public:
  LimitProgress(Console& console, const LimitQuestion& question);

  void enter(LimitStage stage, const Problem& problem) override;
  void go_on(double share) override;
  void residual(double of_forces) override;
  void begin_row(const std::string& method) override;
  void end_row(const std::string& method) override;
  [[nodiscard]] bool stopped() const override { return interrupt_flag(); }

 private:
  void show();

  Console& console_;
  const LimitQuestion& question_;
  std::mutex mutex_;
  LimitStage stage_ = LimitStage::path;
  std::string task_, material_;      ///< words of the stage, and what names its model
  double share_ = 0, residual_ = 0;  ///< 0 before the first
  std::vector<RunningRow> running_;  ///< in the order in which they began
  double since_;
  Progress progress_;
  Ticker ticker_;  // last: the others must be there
};

/// Says on standard error what the answer holds for: a load that changes, a tool that slides off, a motion
/// that was not looked at.
void warn_of_states(const LimitAnswer& answer, const std::vector<Problem>& problems, Console& console);

/// The table, and below it what holds for it.
/// @param of_engine  lines about the first model that its facts do not tell
std::string words_of(const LimitAnswer& answer, const LimitQuestion& question,
                     const std::vector<Problem>& problems, const Console& console,
                     const std::string& of_engine = {});

/// Sets the exit code: fails where there is no equilibrium though it was asked for, where every row is of a
/// model that only grows, where runs contradict a row, and where --verify has nothing to show for any.
void judge(const LimitAnswer& answer, const LimitQuestion& question, Console& console);

}  // namespace hmax
