/// The one way from a question about step limits to its answer: looked up, or computed and stored.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "catalogue/methods/method.hpp"
#include "limits/query/limit_question.hpp"
#include "results/limit_row.hpp"
#include "results/store.hpp"

namespace hmax {

/// What a query does at the moment.
enum class LimitStage {
  path,   ///< finds the states of the path
  state,  ///< finds the equilibrium and the modes
  rows,   ///< predicts, and verifies
  along,  ///< limits along the path
};

/// Sees how a query goes on, and ends it. Calls come from the thread of the query unless it says otherwise.
class LimitWatcher {
 public:
  virtual ~LimitWatcher() = default;
  virtual void enter(LimitStage /*stage*/, const Problem& /*problem*/) {}
  /// Called often within a stage.
  /// @param share  of all rows that are done
  virtual void go_on(double /*share*/) {}
  /// |F| / |F(0)| of the search for an equilibrium.
  virtual void residual(double /*of_forces*/) {}
  /// A row begins or ends; from any thread.
  virtual void begin_row(const std::string& /*method*/) {}
  virtual void end_row(const std::string& /*method*/) {}
  /// Whether the query is to end at the next good moment; from any thread.
  [[nodiscard]] virtual bool stopped() const { return false; }
};

/// Where limits are kept.
struct LimitStore {
  Store* store = nullptr;   ///< null: nowhere
  bool looks_up = true;     ///< false: every limit is computed, and replaces what the store has
  bool in_session = false;  ///< a session of the store has begun; set by the first query that keeps a row
};

/// The limits of one model.
struct ModelLimits {
  /// With the facts of the model, limits/documents/model_json.hpp, and of the path: `along`, {constant,
  /// tolerances, status}.
  OperatingPointRow point;
  std::vector<LimitRow> rows;  ///< in the order of the methods; after a stop those that are finished
};

struct LimitAnswer {
  std::vector<ModelLimits> models;  ///< in the order of the problems; after a stop those that were begun
  std::size_t looked_up = 0;        ///< rows that the store had
  std::size_t stored = 0;           ///< rows that were put into it; of a path that was left none are
  bool stopped = false;
};

/// Every problem with every method.
/// @param problems   of one model with other materials, at least one; without Problem::again on one thread
/// @param all_facts  of every model, as where there is a store; else the costly ones of none, and the fastest
/// mode of the first body
/// @throws InputError  where a state or a path that was asked for cannot be found, and without problems or
/// methods
LimitAnswer query_limits(const LimitQuestion& question, const std::vector<Problem>& problems,
                         const std::vector<Method>& methods, LimitStore& store, bool all_facts,
                         LimitWatcher& watcher);
/// The same without a store.
LimitAnswer query_limits(const LimitQuestion& question, const std::vector<Problem>& problems,
                         const std::vector<Method>& methods, bool all_facts, LimitWatcher& watcher);

/// {"rows": .., "models": ..}
nlohmann::ordered_json answer_json(const LimitAnswer& answer, const std::vector<Problem>& problems);

}  // namespace hmax
