/// Rows of a sweep, measured without a store: one block after the other, in one thread.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/timing/sweep.hpp"

namespace hmax {

/// Rows that are measured together: some methods of a block.
struct SweepTask {
  const SweepBlock* block = nullptr;
  std::vector<std::size_t> methods;  ///< indices into SweepPlan::methods
};

/// "liver_forced, fixed, h = 0.01"
std::string in_words(const SweepPlan& plan, const SweepBlock& block);

/// Each row by itself, those of one problem from the longest to the shortest, so that all who share them end
/// together.
std::vector<SweepTask> single_rows(const SweepPlan& plan, const std::vector<SweepTask>& tasks);

/// Thrown where a sweep is asked to end.
struct SweepEnded {};

/// Measures tasks of a plan; knows the reference of the problem at hand. For one thread, which no other one
/// shares the problems with.
class RowMeter {
 public:
  /// @param share  of the task at hand that is done
  using Tell = std::function<void(double share, const std::string& what)>;

  /// The arguments must outlive this.
  /// @param tell         called often; may be empty
  /// @param interrupted  asked often, true ends the task; may be empty
  RowMeter(const SweepPlan& plan, Tell tell, const std::function<bool()>& interrupted);
  ~RowMeter();
  RowMeter(const RowMeter&) = delete;
  RowMeter& operator=(const RowMeter&) = delete;

  /// The rows of a task, as run_sweep() says; Row::explored is that of the plan.
  /// @throws SweepEnded        when asked to end
  /// @throws std::logic_error  where timed runs end elsewhere than the counted one
  std::vector<Row> measured(const SweepTask& task);

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace hmax
