/// The limits that one call of `hmax stability predict` asks for: looked up, or computed and stored.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/shared/choices.hpp"
#include "cli/stability/operating_point.hpp"
#include "core/parallel_for.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "limits/by_steps/predict_by_steps.hpp"
#include "limits/linearised_problem.hpp"
#include "results/limit_row.hpp"
#include "results/store.hpp"

namespace hmax {

/// What is asked about every problem.
struct LimitQuestion {
  OperatingPointChoice at;
  bool verify = false;
  std::string path;              ///< motion | load; empty for one state alone
  bool path_by_default = false;  ///< nobody asked for it
  bool runs_from_start = false;  ///< limits along a motion are verified by runs from its start
  std::optional<double> t_end;   ///< of that motion, as users count time [s]; nothing: end_of_motion()
  std::optional<StepChoices> options = {};  ///< of linearly implicit methods; nothing: nobody asked
  std::vector<std::string> named = {};      ///< methods that were asked for one by one, not by family or all

  /// The end of that motion, as runs count time.
  [[nodiscard]] double end_of(const Problem& problem) const {
    return t_end ? problem.shown.own_time(*t_end) : end_of_motion(problem);
  }
  /// Whether a limit may be sought in the steps of a method, which takes minutes on large models.
  [[nodiscard]] bool seeks_in_steps(const Method& method, const Problem& problem) const;
};

/// Whether the load changes with time, so that one state does not tell of all.
bool has_moving_load(const Problem& problem);

/// Sets the exit code of --verify: fails where runs contradict a row, and where no row has anything to show.
void judge_runs(const std::vector<LimitRow>& rows, Console& console);

/// The rows, problem by problem, and what is said of their states.
class PredictedRows {
 public:
  /// @param store  where limits are kept and looked up; nullptr for nowhere
  /// @param looks_up  false: every limit is computed, and replaces what the store has
  PredictedRows(LimitQuestion question, std::vector<ProblemChoice> choices, std::vector<Problem> problems,
                std::vector<Method> methods, Store* store, bool looks_up, Console& console);

  /// Every problem with every method; ends early when the user interrupts, with what is finished.
  void compute();

  /// Sets the exit code: fails where there is no equilibrium though it was asked for, where every row is of a
  /// model that only grows, where runs contradict a row, and where --verify has nothing to show for any.
  void judge() const;

  [[nodiscard]] const std::vector<LimitRow>& rows() const { return rows_; }
  [[nodiscard]] std::size_t looked_up() const { return looked_up_; }
  /// {"rows": .., "models": ..}
  [[nodiscard]] nlohmann::ordered_json json() const;
  /// The table, and below it what holds for it.
  [[nodiscard]] std::string words() const;

 private:
  /// What was computed of one problem.
  struct Answer {
    OperatingPointRow point;
    std::vector<LimitRow> rows;
  };

  [[nodiscard]] double share(std::size_t rows) const;
  [[nodiscard]] Watcher watch(const Problem& problem, std::string_view what);
  [[nodiscard]] OperatingPointKey key_of(const Problem& problem) const;
  [[nodiscard]] std::vector<LimitRow> stored_rows(const OperatingPointKey& key) const;
  /// The options that are asked for, of a method that has them.
  [[nodiscard]] std::optional<StepChoices> options_of(const Method& method) const;
  /// What a row is called: with options the limits are others.
  [[nodiscard]] std::string name_of_row(const Method& method) const;
  [[nodiscard]] Prediction predicted(const Method& method, const Problem& problem,
                                     const OperatingPoint& point, const Linearised& near) const;
  void add(std::size_t which);
  void compute(std::size_t which, const std::vector<Method>& methods, Answer& answer);
  void keep(const Answer& answer);
  std::optional<Path> motion_of(const Problem& problem, std::string& remarks);
  void predict_all(std::size_t which, const Linearised& near, const std::vector<Method>& methods,
                   std::vector<LimitRow>& rows);
  void look_along(const Problem& problem, const Path& path, const std::vector<Method>& methods,
                  std::vector<LimitRow>& rows);
  void tell_of_state(std::size_t which, const Linearised& near, const std::optional<Path>& path,
                     OperatingPointRow& point) const;

  LimitQuestion question_;
  std::vector<ProblemChoice> choices_;
  std::vector<Problem> problems_;
  std::vector<Method> methods_;
  Store* store_;
  bool looks_up_;
  bool has_session_ = false;
  Console& console_;
  const std::remove_reference_t<decltype(interrupt_flag())>& interrupted_ = interrupt_flag();
  Progress* progress_ = nullptr;
  std::vector<LimitRow> rows_;
  std::vector<std::size_t> row_problems_;  ///< of each row, its index in problems_
  std::vector<OperatingPointRow> points_;  ///< one a problem
  std::size_t looked_up_ = 0;
  std::optional<bool> constant_along_ =
      {};  ///< whether the Jacobian of the last problem is the same along its path
};

}  // namespace hmax
