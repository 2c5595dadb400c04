#include "cli/stability/limit_answer.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/equilibria/tool_report.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/model.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/stability/limit_words.hpp"
#include "cli/stability/operating_point.hpp"
#include "core/numbers.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "limits/documents/limit_json.hpp"
#include "limits/documents/model_json.hpp"
#include "limits/kinks.hpp"
#include "limits/point/prediction.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

/// Why the limits of one state do not tell of a motion, or may not.
std::string_view why_along(const Problem& problem) {
  if (problem.body) return "the load changes with time";
  switch (linearity_of(problem)) {
    case Linearity::time_varying:
      return problem.matrices ? "the matrices change with time" : "the model changes with time";
    case Linearity::nonlinear:
      return "the model is not linear";
    default:
      return "whether the model is linear is not known from its right-hand side";
  }
}

/// What the states of a motion show of a model that does not say whether it is linear; empty for others.
std::string words_of_samples(const Problem& problem, const std::optional<bool>& constant) {
  if (!constant || linearity_of(problem) != Linearity::unknown) return {};
  return *constant ? "its Jacobian is the same at all states of the motion that were looked at\n"
                   : "its Jacobian changes along the motion\n";
}

/// What is to be said where the motion that is looked at without being asked for has no limits.
std::string without_motion(const Problem& problem, const std::string& reason) {
  return fmt::format("{}, but its motion is not in these limits: {}", why_along(problem), reason);
}

/// Says where a motion is less than a period of its load; empty where it is not.
std::string words_of_part(const Problem& problem, double t_end) {
  const std::optional<double> period = period_of_load(problem);
  if (!period || t_end >= (1 - 1e-5) * *period) return {};
  return fmt::format("the motion ends at t = {} s, before one period of the load, {} s; take --t-end {}\n",
                     short_number(problem.shown.time(t_end)), short_number(*period),
                     short_number(problem.shown.time(*period)));
}

/// The facts of a model; empty where a stop came before them.
Json facts_of(const ModelLimits& limits) {
  return limits.point.document.empty() ? Json::object() : Json::parse(limits.point.document);
}

MotionTolerances tolerances_of(const Json& along) {
  const Json& from = along["tolerances"];
  return {.rtol = from["rtol"],
          .atol = from["atol"],
          .atol_velocities = from.value("atol_velocities", from["atol"].get<double>()),
          .has_velocities = from.contains("atol_velocities")};
}

/// What h_max holds for, of a model that is not linear.
std::string words_of_state(const Problem& problem, const Json& model) {
  if (model.value("kink", false)) return std::string(at_a_kink);
  return fmt::format("{}: h_max holds for small motions about this state", why_along(problem));
}

/// What the limits of a model hold for, and where it was linearised.
std::string words_of_model(const LimitQuestion& question, const Problem& problem, const Json& model) {
  const bool looked = has_limits_along(model);
  std::string words = fmt::format("{}: {}\n", problem.id, model.value("state", ""));
  if (looked && problem.matrices) {
    if (!times_of_matrices(problem).empty())
      words += fmt::format(
          "the matrices change with time: h_max holds for those of t = 0 s; necessary: the smallest limit of those given "
          "up to t = {} s\n"
          "each limit is that of matrices that stay as they are; changes as fast as the motion may amplify it at any step "
          "size (parametric resonance)\n",
          short_number(problem.shown.time(question.end_of(problem))));
    return words;
  }
  if (looked && question.path_by_default)
    words += fmt::format(
        "{}\nnecessary: the smallest limit of the Jacobians frozen at states of the motion to t = {} s, no safe step{}\n",
        words_of_state(problem, model), short_number(problem.shown.time(question.end_of(problem))),
        question.run_steps > 0 ? "" : "; --along --verify runs the motion");
  else if (!problem.body && !looked && linearity_of(problem) != Linearity::linear)
    words +=
        fmt::format("{}{}\n", words_of_state(problem, model),
                    question.path.empty() && !question.options ? "; --along motion looks at others" : "");
  else if (problem.body && !looked && model.value("state_kind", "") == name_of(StateKind::equilibrium) &&
           model.value("away_from_rest", false) && model.value("linearity", "") != name_of(Linearity::linear))
    words += "h_max holds for small motions about this state; for a sudden load add --along\n";
  if (looked) {
    const Json& constant = model["along"]["constant"];
    words +=
        words_of_samples(problem, constant.is_null() ? std::nullopt : std::optional(constant.get<bool>()));
  }
  if (looked && question.path == "motion") {
    words += fmt::format("the motion: dormand_prince_54, {}\n", in_words(tolerances_of(model["along"])));
    words += words_of_part(problem, question.end_of(problem));
  }
  if (model.contains("tool") && model.value("at_equilibrium", false))
    words += fmt::format("tool: {}\n", tool_report(model["tool"]).words());
  return words;
}

/// "2.8 % larger", or "no larger" where less than 0.01 % comes of it.
std::string growth_in_words(double factor) {
  const double percent = 100 * (factor - 1), size = std::abs(percent);
  if (size < 0.01) return "no larger";
  return fmt::format("{} % {}", size < 10 ? short_number(size, 2) : fmt::format("{:.0f}", size),
                     percent > 0 ? "larger" : "smaller");
}

/// The element that owns the fastest mode at rest, bounds of it, and what changes would gain.
/// @param mode  of fastest_mode_json()
std::string fastest_mode_in_words(const Json& mode) {
  const auto pessimism = [&](const char* bound) {
    return short_number(mode["bounds"][bound]["pessimism"].get<double>(), 4);
  };
  const std::string kind = mode["element_kind"];
  const NamedElement owner{.kind = kind, .number = mode["element"], .points = mode["points"]};
  std::string fastest = fmt::format(
      "fastest mode at rest {} rad/s: {} has {} % of its energy, {} points move; bounds are larger by {} "
      "(elements), {} (points), {} (Gershgorin)\n",
      short_number(mode["omega"].get<double>()), in_words(owner),
      short_number(100 * mode["energy_share"].get<double>(), 3),
      short_number(mode["moving_points"].get<double>(), 3), pessimism("element"), pessimism("nodal"),
      pessimism("gershgorin"));
  const Json& gain = mode["gain"];
  if (gain.is_null()) return fastest;
  const Json& moved = gain["moved_point"];
  return fmt::format(
      "{}the undamped h_max would be {} without that element, {} with twice its mass ({} % of the body), {} with {}\n",
      fastest, growth_in_words(gain["without_element"]), growth_in_words(gain["double_mass"]),
      short_number(100 * gain["added_mass"].get<double>(), 3), growth_in_words(gain["smoothed"]),
      moved.is_null() ? "its points moved"
                      : fmt::format("point {} moved towards its neighbours", moved.get<std::int64_t>()));
}

std::string words_of_body(const Problem& problem, const Json& model) {
  const std::string words = body_in_words(problem);
  return (words.empty() ? "" : words + "\n") +
         (model.contains("fastest_mode") ? fastest_mode_in_words(model["fastest_mode"]) : "");
}

/// What goes on along a path, and how to go without where nobody asked for it.
std::string task_along(const LimitQuestion& question, const Problem& problem, std::string_view what) {
  return fmt::format(
      "{} {}{}", what,
      question.path == "load"
          ? "the growing load"
          : fmt::format("the motion to t = {} s", short_number(problem.shown.time(question.end_of(problem)))),
      question.path_by_default ? "; --along none goes without" : "");
}

/// Fails where runs contradict a row, and where no row has anything to show.
void judge_runs(const std::vector<LimitRow>& rows, Console& console) {
  bool any = false;
  for (const LimitRow& row : rows) {
    if (row.verdict == "contradicted") console.exit_code = Exit::failed;
    any = any || row.is_observed() || !std::isnan(row.from_start);
  }
  if (any || interrupt_flag()) return;
  console.exit_code = Exit::failed;
  console.remark(
      "nothing was verified: no row has a limit that runs could show; the notes on the rows say why");
}

}  // namespace

LimitProgress::LimitProgress(Console& console, const LimitQuestion& question)
    : console_(console),
      question_(question),
      since_(elapsed_seconds()),
      progress_(console, "predict"),
      ticker_(1, [this](int) { show(); }) {}

void LimitProgress::enter(LimitStage stage, const Problem& problem) {
  if (stage == LimitStage::state) announce_equilibrium(console_, problem, question_.at);
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  since_ = elapsed_seconds();
  residual_ = 0;
  material_ = problem.material + (problem.material.empty() ? "" : " ");
  if (stage == LimitStage::path) task_ = task_along(question_, problem, "finding");
  if (stage == LimitStage::along) task_ = task_along(question_, problem, "limits along");
}

void LimitProgress::go_on(double share) {
  const std::lock_guard lock(mutex_);
  share_ = share;
  if (stage_ == LimitStage::path || stage_ == LimitStage::along) progress_.update(share_, task_);
}

void LimitProgress::residual(double of_forces) {
  const std::lock_guard lock(mutex_);
  residual_ = of_forces;
}

void LimitProgress::begin_row(const std::string& method) {
  const std::lock_guard lock(mutex_);
  running_.push_back({method, elapsed_seconds()});
}

void LimitProgress::end_row(const std::string& method) {
  const std::lock_guard lock(mutex_);
  std::erase_if(running_, [&](const RunningRow& each) { return each.row == method; });
}

void LimitProgress::show() {
  const std::lock_guard lock(mutex_);
  if (stage_ == LimitStage::state)
    progress_.update(share_, words_of_search(residual_, seconds_since(since_)));
  if (stage_ == LimitStage::rows && !running_.empty())
    progress_.update(share_, fmt::format("{}{}{}, {} s", material_, question_.verify ? "verifying " : "",
                                         running_.front().row, seconds_since(running_.front().start)));
}

void warn_of_states(const LimitAnswer& answer, const std::vector<Problem>& problems, Console& console) {
  for (std::size_t i = 0; i < answer.models.size(); ++i) {
    const Json model = facts_of(answer.models[i]);
    const Problem& problem = problems[i];
    if (model.contains("along") && model["along"].contains("status"))
      console.remark(without_motion(problem, model["along"]["status"].get<std::string>()));
    if (model.contains("tool") && model.value("at_equilibrium", false))
      if (const std::string warning = tool_report(model["tool"]).warning(); !warning.empty())
        console.remark(warning);
    const std::string status = status_of_state(model, problem);
    if (has_moving_load(problem) && !status.empty()) console.remark(status);
  }
}

std::string words_of(const LimitAnswer& answer, const LimitQuestion& question,
                     const std::vector<Problem>& problems, const Console& console,
                     const std::string& of_engine) {
  std::vector<LimitRow> rows;
  std::string below;
  for (std::size_t i = 0; i < answer.models.size(); ++i) {
    const ModelLimits& limits = answer.models[i];
    rows.insert(rows.end(), limits.rows.begin(), limits.rows.end());
    const Json model = facts_of(limits);
    if (model.empty()) continue;
    if (problems.size() > 1) below += problems[i].material + ", ";
    below += words_of_model(question, problems[i], model);
    if (i == 0) below += words_of_body(problems[i], model) + of_engine;
  }
  const LimitColumns columns{question.verify, question.run_steps > 0, question.path};
  return limit_table(rows, columns, console) + (answer.models.empty() ? "" : "\n") + below +
         words_of_paths(rows) + words_of_safe(rows) + words_of_notes(rows);
}

void judge(const LimitAnswer& answer, const LimitQuestion& question, Console& console) {
  std::vector<LimitRow> rows;
  for (const ModelLimits& limits : answer.models)
    rows.insert(rows.end(), limits.rows.begin(), limits.rows.end());
  // The limits are not those that were asked for, as those of `hmax static` without an equilibrium.
  if (std::ranges::any_of(rows, &LimitRow::lacks_equilibrium)) console.exit_code = Exit::failed;
  // Of a model that only grows no step is stable, here or on its path.
  const bool only_grows = !rows.empty() && std::ranges::all_of(rows, [](const LimitRow& row) {
    return row.bound == name_of(Bound::model) && std::isnan(row.h_max) && std::isnan(row.h_unstable) &&
           std::isnan(row.along_least);
  });
  if (only_grows) console.exit_code = Exit::failed;
  if (question.verify) judge_runs(rows, console);
}

}  // namespace hmax
