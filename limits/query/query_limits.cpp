#include "limits/query/query_limits.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "catalogue/models/equilibria/support_advice.hpp"
#include "catalogue/models/equilibria/tool_report.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/model.hpp"
#include "core/errors.hpp"
#include "core/parallel_for.hpp"
#include "core/process/memory_share.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "limits/by_steps/predict_by_steps.hpp"
#include "limits/documents/limit_json.hpp"
#include "limits/documents/model_json.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "limits/rows/limit_rows.hpp"
#include "limits/verification.hpp"
#include "problems/tissue/body.hpp"
#include "results/fingerprint.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

/// Leaves a long task once the query is stopped.
struct Stopped {};

/// A limit along a path, its times and its state as users count them; of a load, which bodies alone have, the
/// same.
TrajectoryLimit as_shown(TrajectoryLimit limit, const UserView& shown) {
  for (double& t : limit.t) t = shown.time(t);
  limit.t_least = shown.time(limit.t_least);
  limit.grows_from = shown.time(limit.grows_from);
  limit.y_least = shown.state(limit.y_least);
  return limit;
}

/// Says what helps a body that has no equilibrium.
void add_remedy(const Problem& problem, OperatingPoint& point) {
  if (!std::isfinite(problem.body->steady_from())) return;  // none was looked for
  const std::string remedy = remedy_without_equilibrium(problem);
  if (remedy.empty()) return;
  point.status += "; " + remedy;
  point.state += "; " + remedy;
}

class Query {
 public:
  Query(const LimitQuestion& question, const std::vector<Problem>& problems,
        const std::vector<Method>& methods, LimitStore& store, bool all_facts, LimitWatcher& watcher)
      : question_(question),
        problems_(problems),
        methods_(methods),
        store_(store),
        all_facts_(all_facts),
        watcher_(watcher) {}

  LimitAnswer answer() {
    for (const Problem& problem : problems_) {
      if (watcher_.stopped()) break;
      answer_.models.push_back(limits_of(problem));
      done_ += answer_.models.back().rows.size();
    }
    answer_.stopped = watcher_.stopped();
    return std::move(answer_);
  }

 private:
  /// Of one model, the rows from the store or computed.
  ModelLimits limits_of(const Problem& problem) {
    ModelLimits limits;
    limits.point.key = operating_point_key(problem, question_.at, question_.path,
                                           question_.path == "motion" ? question_.end_of(problem) : 0);
    std::vector<LimitRow> known = stored_rows(limits.point.key);
    // Its facts, of which a stop or a method without limits may leave some out below.
    if (!known.empty()) limits.point = *store_.store->operating_point(limits.point.key);
    const auto find = [](std::vector<LimitRow>& rows, const std::string& name) {
      return std::ranges::find(rows, name, &LimitRow::method);
    };
    std::vector<Method> missing;
    for (const Method& method : methods_)
      if (find(known, name_of_row(method)) == known.end()) missing.push_back(method);
    if (!missing.empty()) compute(problem, missing, limits);
    // A stop may have left rows without what lies along the path.
    if (!watcher_.stopped() || question_.path.empty()) keep(limits);

    std::vector<LimitRow> computed = std::move(limits.rows);
    limits.rows.clear();
    for (const Method& method : methods_) {
      const std::string name = name_of_row(method);
      const bool is_known = missing.empty() || find(known, name) != known.end();
      auto& from = is_known ? known : computed;
      const auto row = find(from, name);
      if (row == from.end()) continue;  // stopped before
      answer_.looked_up += is_known ? 1 : 0;
      limits.rows.push_back(std::move(*row));
    }
    return limits;
  }

  /// The stored rows that answer the question.
  [[nodiscard]] std::vector<LimitRow> stored_rows(const OperatingPointKey& key) const {
    if (!store_.store || !store_.looks_up) return {};
    const std::optional<OperatingPointRow> point = store_.store->operating_point(key);
    const bool has_motion = point && has_limits_along(Json::parse(point->document));
    // A motion that was not found is an error for those who ask for it.
    if (!question_.path.empty() && question_.requires_path() && !has_motion) return {};
    std::vector<LimitRow> known = stored_limits(
        *store_.store, key,
        {.verified = question_.verify, .from_start = has_motion && question_.run_steps > 0, .details = true});
    // It may have been left unknown where nobody named the method.
    std::erase_if(known, [&](const LimitRow& row) {
      return row.bound == name_of(Bound::unknown) &&
             std::ranges::find(question_.named, row.method) != question_.named.end();
    });
    return known;
  }

  void keep(const ModelLimits& limits) {
    if (!store_.store || limits.rows.empty() || limits.point.document.empty()) return;
    if (!std::exchange(store_.in_session, true)) store_.store->begin_session(fingerprint());
    store_.store->insert_limits(limits.point, limits.rows);
    answer_.stored += limits.rows.size();
  }

  /// What is computed stays in `limits` also after a stop.
  void compute(const Problem& problem, const std::vector<Method>& methods, ModelLimits& limits) {
    try {
      Json along;  // null: nobody looked
      std::optional<Path> path = path_of(problem, along);
      const Linearised near = near_state(problem);
      predict_all(problem, near, methods, limits);
      if (path && !watcher_.stopped()) {
        const std::vector<LimitRow> of_state = limits.rows;
        try {
          along = look_along(problem, *path, methods, limits.rows);
        } catch (const InputError& error) {
          if (question_.requires_path()) throw;
          along = {{"status", error.what()}};
          limits.rows = of_state;
        }
      }
      Json facts = model_json(problem, near, facts_of(problem));
      if (!along.is_null()) facts["along"] = with_known(std::move(along), limits.point.document);
      limits.point.document = facts.dump();
    } catch (const Stopped&) {
    }
  }

  /// What is known of a path, with what methods of an earlier question have shown of it.
  static Json with_known(Json along, const std::string& document) {
    if (document.empty() || !along.contains("constant") || !along["constant"].is_null()) return along;
    const Json before = Json::parse(document);
    if (has_limits_along(before)) along["constant"] = before["along"]["constant"];
    return along;
  }

  [[nodiscard]] ModelFacts facts_of(const Problem& problem) const {
    if (all_facts_ || store_.store) return ModelFacts::all;
    return &problem == problems_.data() ? ModelFacts::fastest_mode : ModelFacts::state;
  }

  Linearised near_state(const Problem& problem) {
    watcher_.enter(LimitStage::state, problem);
    Linearised near = linearised(problem, question_.at, [this](double residual) {
      leave_when_stopped();
      watcher_.residual(residual);
    });
    if (near.point.is_body && question_.at == AskedState::equilibrium && near.point.kind == StateKind::rest)
      add_remedy(problem, near.point);
    return near;
  }

  /// The path that limits are looked for along; nothing where there is none, and `along` says why where
  /// nobody asked for it.
  std::optional<Path> path_of(const Problem& problem, Json& along) {
    if (question_.path.empty()) return std::nullopt;
    const Watcher watch = watch_in(LimitStage::path, problem);
    try {
      if (question_.path == "load") return load_path(problem, load_strides, watch);
      // Contact comes and goes faster than a body moves otherwise; differences of many states take long.
      constexpr double most_evaluations = 4e5;
      const double states = static_cast<double>(problem.y0.size());
      const int points = problem.body ? (has_tool(problem) ? 400 : 100)
                                      : static_cast<int>(std::clamp(most_evaluations / states, 20.0, 400.0));
      return motion_path(problem, question_.end_of(problem), points, watch);
    } catch (const InputError& error) {
      if (question_.requires_path()) throw;
      along = {{"status", error.what()}};
      return std::nullopt;
    }
  }

  /// Leaves a long task after a stop. @throws Stopped
  void leave_when_stopped() const {
    if (watcher_.stopped()) throw Stopped{};
  }
  [[nodiscard]] Watcher watch_in(LimitStage stage, const Problem& problem) {
    watcher_.enter(stage, problem);
    return [this] {
      leave_when_stopped();
      watcher_.go_on(share());
    };
  }
  /// Of all rows, those of models that are done and `more`.
  [[nodiscard]] double share(std::size_t more = 0) const {
    return static_cast<double>(done_ + more) / static_cast<double>(problems_.size() * methods_.size());
  }

  /// The options that are asked for, of a method that has them.
  [[nodiscard]] std::optional<StepChoices> options_of(const Method& method) const {
    return takes_step_options(method) ? question_.options : std::nullopt;
  }
  /// What a row is called: with options the limits are others.
  [[nodiscard]] std::string name_of_row(const Method& method) const {
    const std::optional<StepChoices> options = options_of(method);
    return options ? name_with(method, *options) : method.id;
  }

  /// One row, verified where that is asked for.
  [[nodiscard]] Prediction predicted(const Method& method, const Problem& problem,
                                     const OperatingPoint& point, const Linearised& near) const {
    const StepQuestion by_steps{.options = options_of(method), .verified = question_.verify, .watch = [this] {
                                  leave_when_stopped();
                                }};
    if (by_steps.options && suits(method, problem)) return predict_by_steps(method, problem, near, by_steps);
    Prediction prediction = predict(method, point, near.modes);
    // What the problem does not have no step may ask it for.
    if (method.bind && !suits(method, problem)) return prediction;
    if (needs_step_map(method, prediction)) {
      if (question_.seeks_in_steps(method, problem)) return predict_by_steps(method, problem, near, by_steps);
      prediction.note +=
          fmt::format("; --methods {} computes its limit from its steps, which takes minutes", method.id);
    }
    if (prediction.bound == Bound::newton && method.bind)  // formulas step nothing
      prediction.newton_step = largest_newton_step(method, problem);
    if (question_.verify) verify(prediction, method, problem, near, by_steps.watch);
    return prediction;
  }

  LimitRow row_of(const Method& method, const Prediction& prediction) const {
    LimitRow row = limit_row(prediction, question_.verify);
    row.method = name_of_row(method);
    Json details = details_json(prediction);
    if (question_.options) details["options"] = options_json(options_of(method));
    row.details = details.dump();
    return row;
  }

  /// How many threads a problem bears. What cannot be made again has one, and so has a device.
  static std::size_t threads_for(const Problem& problem, const std::vector<Method>& methods) {
    if (std::ranges::any_of(methods, [](const Method& each) { return each.device != nullptr; })) return 1;
    if (!can_be_copied(problem)) return 1;
    return std::max<std::size_t>(1, problem.kind() == ModelKind::plugin ? jobs() / 2 : jobs());
  }

  /// The problem of each worker that takes some of `count` methods.
  static std::vector<Problem> problems_of_workers(const Problem& problem, std::size_t count) {
    std::vector<Problem> own(1, problem);
    while (own.size() < count) own.push_back(copy_for_thread(problem));
    return own;
  }

  void predict_all(const Problem& problem, const Linearised& near, const std::vector<Method>& methods,
                   ModelLimits& limits) {
    std::vector<LimitRow>& rows = limits.rows;
    rows.resize(methods.size());
    const std::size_t threads = threads_for(problem, methods);
    std::vector<Problem> own = problems_of_workers(problem, std::min(threads, methods.size()));
    for (Problem& each : own) each = with_frozen_matrices(each, near.point.model.t);
    std::vector<OperatingPoint> points;
    if (!near.point.is_body)
      for (std::size_t worker = 1; worker < own.size(); ++worker)
        ask(points.emplace_back(near.point), own[worker]);
    const auto point_of = [&](std::size_t worker) -> const OperatingPoint& {
      return worker == 0 || points.empty() ? near.point : points[worker - 1];
    };
    const ThreadLimit limit(threads);  // a single method leaves them to what it calls
    watcher_.enter(LimitStage::rows, problem);
    parallel_for(
        methods.size(),
        [&](std::size_t i, std::size_t worker) {
          watcher_.begin_row(methods[i].id);
          try {
            rows[i] = row_of(methods[i], predicted(methods[i], own[worker], point_of(worker), near));
          } catch (const Stopped&) {
            return;  // without this row
          }
          watcher_.end_row(methods[i].id);
        },
        [&](std::size_t done) { watcher_.go_on(share(done)); }, [&] { return watcher_.stopped(); });
    if (watcher_.stopped()) std::erase_if(rows, [](const LimitRow& row) { return row.method.empty(); });
    for (LimitRow& row : rows) row.point = limits.point.key;
  }

  /// Puts the limits along a path into the rows of one problem.
  /// @returns what the path shows of the model
  /// @throws Stopped  what is in the rows by then is finished
  Json look_along(const Problem& problem, const Path& path, const std::vector<Method>& methods,
                  std::vector<LimitRow>& rows) {
    const Watcher watch = watch_in(LimitStage::along, problem);
    const std::vector<std::optional<TrajectoryLimit>> limits = limits_along(methods, problem, path, watch);
    Json facts{{"constant", nullptr}, {"tolerances", tolerances_json(path.tolerances)}};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i].path_note = path.note;
      if (!limits[i]) continue;
      // Of others the structure of the model says it.
      if (linearity_of(problem) == Linearity::unknown) facts["constant"] = limits[i]->constant;
      const TrajectoryLimit along = as_shown(*limits[i], problem.shown);
      add_path(rows[i], along, path.note);
      Json details = Json::parse(rows[i].details);
      details["along"] = path_json(along, rows[i], problem);
      rows[i].details = details.dump();
    }
    if (question_.run_steps > 0) add_runs_from_start(problem, methods, rows, watch);
    return facts;
  }

  void add_runs_from_start(const Problem& problem, const std::vector<Method>& methods,
                           std::vector<LimitRow>& rows, const Watcher& watch) const {
    const double t_end = question_.end_of(problem);
    const auto runs = [&](const Method& method) { return method.fixed_step && suits(method, problem); };
    const MotionSize size =
        std::ranges::any_of(methods, runs) ? size_of_motion(problem, t_end, watch) : MotionSize{};
    const std::size_t threads = threads_for(problem, methods);
    const std::vector<Problem> own = problems_of_workers(problem, std::min(threads, methods.size()));
    const ThreadLimit limit(threads);
    // Nothing but a look: what every step of one worker writes the steps of others would wait for.
    const Watcher leave = [this] { leave_when_stopped(); };
    parallel_for(rows.size(), [&](std::size_t i, std::size_t worker) {
      rows[i].from_start_stride = 0;
      if (!runs(methods[i])) return;
      const MemoryShare memory(memory_of_runs(methods[i], own[worker]));
      const double guess = guess_from_start(rows[i].along_least, rows[i].h_max, t_end);
      const auto found =
          limit_from_start(methods[i], own[worker], t_end, guess, size, question_.run_steps, leave);
      if (found) add_start(rows[i], *found);
    });
  }

  const LimitQuestion& question_;
  const std::vector<Problem>& problems_;
  const std::vector<Method>& methods_;
  LimitStore& store_;
  bool all_facts_;
  LimitWatcher& watcher_;
  std::size_t done_ = 0;  ///< rows of earlier problems
  LimitAnswer answer_;
};

}  // namespace

LimitAnswer query_limits(const LimitQuestion& question, const std::vector<Problem>& problems,
                         const std::vector<Method>& methods, LimitStore& store, bool all_facts,
                         LimitWatcher& watcher) {
  if (problems.empty() || methods.empty())
    throw InputError("limits are asked for of no model or of no method; name at least one of each");
  return Query(question, problems, methods, store, all_facts, watcher).answer();
}

LimitAnswer query_limits(const LimitQuestion& question, const std::vector<Problem>& problems,
                         const std::vector<Method>& methods, bool all_facts, LimitWatcher& watcher) {
  LimitStore nowhere;
  return query_limits(question, problems, methods, nowhere, all_facts, watcher);
}

Json answer_json(const LimitAnswer& answer, const std::vector<Problem>& problems) {
  Json rows = Json::array(), models = Json::array();
  for (std::size_t i = 0; i < answer.models.size(); ++i) {
    const auto& [point, limits] = answer.models[i];
    const Json model = point.document.empty() ? Json::object() : Json::parse(point.document);
    const std::string status = status_of_state(model, problems[i]);
    for (const LimitRow& row : limits) rows.push_back(to_json(row, status, problems[i].parameters));
    if (!model.empty()) models.push_back(model);
  }
  return {{"rows", std::move(rows)}, {"models", std::move(models)}};
}

}  // namespace hmax
