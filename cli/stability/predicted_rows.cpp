#include "cli/stability/predicted_rows.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "analysis/step_limits/non_normality.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/equilibria/support_advice.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/bodies/tool_report.hpp"
#include "cli/stability/fastest_mode_words.hpp"
#include "cli/stability/limit_json.hpp"
#include "cli/stability/limit_words.hpp"
#include "cli/stability/row_progress.hpp"
#include "cli/stability/stability.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/size_limits.hpp"
#include "limits/predict.hpp"
#include "limits/problem_linearity.hpp"
#include "limits/rows/limit_rows.hpp"
#include "limits/verification.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

/// Why the state is not the one that was asked for, and what of the load is not in the limits there.
/// @param along  whether the motion is looked at
std::string words_of_state(const Problem& problem, const Linearised& near, bool along) {
  std::string missing = near.point.missing;
  if (!missing.empty() && !along)
    missing += near.point.kind == StateKind::rest && near.point.status.empty() ? "; leave out --at rest"
                                                                               : "; add --along motion";
  if (missing.empty() && has_moving_load(problem) && !along)
    missing = fmt::format(
        "the load of {} changes with time, and the limits are those of one state; look at the others with --along motion",
        problem.id);
  return near.point.status + (near.point.status.empty() || missing.empty() ? "" : "; ") + missing;
}

/// What is known of the model alone.
Json model_json(const Problem& problem, const Linearised& near) {
  Json eigenvalues = Json::array();
  for (const Complex lambda : near.modes.spectrum.lambda)
    eigenvalues.push_back({lambda.real(), lambda.imag()});
  Json document{{"problem", problem.id},
                {"material", problem.material},
                {"state", near.point.state},
                {"state_kind", name_of(near.point.kind)},
                {"at_equilibrium", near.point.at_equilibrium},
                {"linearity", name_of(near.point.linearity)},
                {"eigenvalues", std::move(eigenvalues)}};
  if (near.modes.curve)
    document["status"] = near.modes.slow_end
                             ? "of the fastest mode; the slowest is not computed, because no limit needs it"
                             : "of the slowest and the fastest mode; all others lie between them";
  if (near.modes.range) document["status"] = "of the fastest modes; damping couples all of them";
  if (near.point.model.y.size() <= most_measured_normality) {
    const Eigen::MatrixXd J = jacobian_in_energy_coordinates(near.point.model);
    const NonNormality normal = non_normality(J);
    document["departure_from_normality"] = normal.departure;
    document["relative_departure"] = normal.relative_departure;
    document["numerical_abscissa"] = normal.numerical_abscissa;
    if (J.rows() <= most_kreiss_states)
      document["kreiss_constant"] = number_or_word(kreiss_constant(J).value);
  }
  if (near.point.model.mechanical) document["damping"] = name_of(near.point.model.mechanical->damping);
  document["body"] = body_json(problem);
  if (is_matrices_id(problem.id)) document["matrices"] = matrices_json(problem);
  if (const auto tool = tool_report(problem, near.point.model.t, near.point.model.y))
    document["tool"] = tool->json();
  if (problem.body) document["fastest_mode"] = fastest_mode_json(problem, near);
  return document;
}

/// Ends a long task after Ctrl-C.
/// @throws Interrupted
void leave_when_interrupted() {
  if (interrupt_flag()) throw Interrupted{};
}

/// The path that limits are looked for along.
/// @throws Interrupted  after Ctrl-C
Path path_of(const LimitQuestion& question, const Problem& problem, const Watcher& watcher) {
  if (question.path == "load") return load_path(problem, 40, watcher);
  // Contact comes and goes faster than a body moves otherwise; differences of many states take long.
  constexpr double most_evaluations = 4e5;
  const double states = static_cast<double>(problem.y0.size());
  const int points = problem.body ? (problem.body->settings().tools.empty() ? 100 : 400)
                                  : static_cast<int>(std::clamp(most_evaluations / states, 20.0, 400.0));
  return motion_path(problem, question.end_of(problem), points, watcher);
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

/// Why the limits of one state do not tell of a motion, or may not.
std::string_view why_along(const Problem& problem) {
  if (problem.body) return "the load changes with time";
  if (is_matrices_id(problem.id)) return "the matrices change with time";
  switch (linearity_of(problem)) {
    case Linearity::time_varying:
      return "the model changes with time";
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
std::string without_motion(const Problem& problem, const InputError& error) {
  return fmt::format("{}, but its motion is not in these limits: {}", why_along(problem), error.what());
}

/// Says where a motion is less than a period of its load; empty where it is not.
std::string words_of_part(const Problem& problem, double t_end) {
  const std::optional<double> period = period_of_load(problem);
  if (!period || t_end >= (1 - 1e-5) * *period) return {};
  return fmt::format("the motion ends at t = {} s, before one period of the load, {} s; take --t-end {}\n",
                     short_number(problem.shown.time(t_end)), short_number(*period),
                     short_number(problem.shown.time(*period)));
}

/// What the limits of a model hold for, and where it was linearised.
/// @param path      what was looked along; nothing where nobody looked
/// @param constant  whether the Jacobian is the same along the path; nothing where nobody looked
std::string words_of_model(const LimitQuestion& question, const Problem& problem, const Linearised& near,
                           const std::optional<Path>& path, const std::optional<bool>& constant) {
  const bool has_path = path.has_value();
  std::string words = fmt::format("{}: {}\n", problem.id, near.point.state);
  if (has_path && is_matrices_id(problem.id)) {
    if (!times_of_matrices(problem).empty())
      words += fmt::format(
          "the matrices change with time: h_max holds for those of t = 0 s; \"least along\" is the smallest limit of those "
          "given up to t = {} s\n"
          "each limit is that of matrices that stay as they are; changes as fast as the motion may amplify it at any step "
          "size (parametric resonance)\n",
          short_number(problem.shown.time(question.end_of(problem))));
    return words;
  }
  if (has_path && question.path_by_default)
    words += fmt::format(
        "{}: h_max holds for small motions about this state; \"least along\" is the smallest limit of all states on the "
        "motion to t = {} s\n",
        why_along(problem), short_number(problem.shown.time(question.end_of(problem))));
  else if (problem.body && !has_path && near.point.kind == StateKind::equilibrium &&
           near.point.model.y.norm() > 0 && near.point.linearity != Linearity::linear)
    words += "h_max holds for small motions about this state; for a sudden load add --along\n";
  if (has_path) words += words_of_samples(problem, constant);
  if (has_path && question.path == "motion") {
    words += fmt::format("the motion: dormand_prince_54, {}\n", in_words(path->tolerances));
    words += words_of_part(problem, question.end_of(problem));
  }
  if (const auto tool = tool_report(problem, near.point.model.t, near.point.model.y);
      tool && near.point.at_equilibrium)
    words += fmt::format("tool: {}\n", tool->words());
  return words;
}

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
  const std::string remedy = remedy_without_equilibrium(problem);
  if (remedy.empty()) return;
  point.status += "; " + remedy;
  point.state += "; " + remedy;
}

void add_line(std::string& lines, const std::string& line) {
  if (!line.empty()) lines += line + "\n";
}

}  // namespace

bool has_moving_load(const Problem& problem) { return problem.body && !problem.body->is_autonomous(); }

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

PredictedRows::PredictedRows(LimitQuestion question, std::vector<ProblemChoice> choices,
                             std::vector<Problem> problems, std::vector<Method> methods, Store* store,
                             bool looks_up, Console& console)
    : question_(std::move(question)),
      choices_(std::move(choices)),
      problems_(std::move(problems)),
      methods_(std::move(methods)),
      store_(store),
      looks_up_(looks_up),
      console_(console) {}

void PredictedRows::compute() {
  Progress progress(console_, "predict");
  progress_ = &progress;
  for (std::size_t which = 0; which < problems_.size() && !interrupted_; ++which) add(which);
  progress_ = nullptr;
}

void PredictedRows::judge() const {
  // The limits are not those that were asked for, as those of `hmax static` without an equilibrium.
  if (std::ranges::any_of(rows_, [](const LimitRow& row) {
        return row.point.asked == "equilibrium" && row.state_kind == "rest";
      }))
    console_.exit_code = Exit::failed;
  // Of a model that only grows no step is stable, here or on its path.
  const bool only_grows = !rows_.empty() && std::ranges::all_of(rows_, [](const LimitRow& row) {
    return row.bound == name_of(Bound::model) && std::isnan(row.h_max) && std::isnan(row.h_unstable) &&
           std::isnan(row.along_least);
  });
  if (only_grows) console_.exit_code = Exit::failed;
  if (question_.verify) judge_runs(rows_, console_);
}

double PredictedRows::share(std::size_t rows) const {
  return static_cast<double>(rows) / static_cast<double>(problems_.size() * methods_.size());
}

Watcher PredictedRows::watch(const Problem& problem, std::string_view what) {
  return [this, task = task_along(question_, problem, what)] {
    leave_when_interrupted();
    progress_->update(share(rows_.size()), task);
  };
}

OperatingPointKey PredictedRows::key_of(const Problem& problem) const {
  return operating_point_key(problem, question_.at.of(problem), question_.path,
                             question_.path == "motion" ? question_.end_of(problem) : 0);
}

/// The stored rows that answer the question.
std::vector<LimitRow> PredictedRows::stored_rows(const OperatingPointKey& key) const {
  if (!store_ || !looks_up_) return {};
  std::vector<LimitRow> known = stored_limits(
      *store_, key, {.verified = question_.verify, .from_start = question_.runs_from_start, .details = true});
  // It may have been left unknown where nobody named the method.
  std::erase_if(known, [&](const LimitRow& row) {
    return row.bound == name_of(Bound::unknown) &&
           std::ranges::find(question_.named, row.method) != question_.named.end();
  });
  return known;
}

void PredictedRows::add(std::size_t which) {
  Answer answer;
  answer.point.key = key_of(problems_[which]);
  std::vector<LimitRow> known = stored_rows(answer.point.key);
  const auto find = [](std::vector<LimitRow>& rows, const std::string& id) {
    return std::ranges::find(rows, id, &LimitRow::method);
  };
  std::vector<Method> missing;
  for (const Method& method : methods_)
    if (find(known, name_of_row(method)) == known.end()) missing.push_back(method);
  if (missing.empty())
    answer.point = *store_->operating_point(answer.point.key);
  else
    compute(which, missing, answer);
  // Ctrl-C may have left rows without what lies along the path.
  if (!interrupted_ || question_.path.empty()) keep(answer);

  for (const Method& method : methods_) {
    const std::string name = name_of_row(method);
    auto& from = missing.empty() || find(known, name) != known.end() ? known : answer.rows;
    const auto row = find(from, name);
    if (row == from.end()) continue;  // interrupted before
    looked_up_ += &from == &known ? 1 : 0;
    rows_.push_back(std::move(*row));
    row_problems_.push_back(which);
  }
  const std::string& remarks = answer.point.remarks;
  for (std::size_t begin = 0, end; (end = remarks.find('\n', begin)) != std::string::npos; begin = end + 1)
    console_.remark(std::string_view(remarks).substr(begin, end - begin));
  points_.push_back(std::move(answer.point));
}

/// What is computed stays in `answer` also after Ctrl-C.
void PredictedRows::compute(std::size_t which, const std::vector<Method>& methods, Answer& answer) {
  const Problem& problem = problems_[which];
  constant_along_.reset();
  try {
    std::optional<Path> path = motion_of(problem, answer.point.remarks);
    const AskedState at = question_.at.of(problem);
    announce_equilibrium(console_, problem, at);
    const Linearised near = [&] {
      LinearisationProgress shown(*progress_);
      Linearised found = linearised(problem, at, shown.watcher());
      if (problem.body && at == AskedState::equilibrium && found.point.kind == StateKind::rest)
        add_remedy(problem, found.point);
      return found;
    }();
    predict_all(which, near, methods, answer.rows);
    for (LimitRow& row : answer.rows) row.point = answer.point.key;
    if (path && !interrupted_) {
      const std::vector<LimitRow> of_state = answer.rows;
      try {
        look_along(problem, *path, methods, answer.rows);
      } catch (const InputError& error) {
        if (!question_.path_by_default) throw;
        add_line(answer.point.remarks, without_motion(problem, error));
        answer.rows = of_state;
        path.reset();
      }
    }
    tell_of_state(which, near, path, answer.point);
  } catch (const Interrupted&) {
    // The flag stays set: what is finished is printed.
  }
}

void PredictedRows::keep(const Answer& answer) {
  if (!store_ || answer.rows.empty() || answer.point.words.empty()) return;
  if (!has_session_) store_->begin_session(fingerprint());
  has_session_ = true;
  store_->insert_limits(answer.point, answer.rows);
}

/// The motion that limits are looked for along; nothing where there is none and nobody asked for it.
std::optional<Path> PredictedRows::motion_of(const Problem& problem, std::string& remarks) {
  if (question_.path.empty()) return std::nullopt;
  try {
    return path_of(question_, problem, watch(problem, "finding"));
  } catch (const InputError& error) {
    if (!question_.path_by_default) throw;
    add_line(remarks, without_motion(problem, error));
    return std::nullopt;
  }
}

bool LimitQuestion::seeks_in_steps(const Method& method, const Problem& problem) const {
  constexpr Eigen::Index soon = 2000;  // states whose steps are done within a minute or two
  return problem.y0.size() <= soon || std::ranges::find(named, method.id) != named.end();
}

std::optional<StepChoices> PredictedRows::options_of(const Method& method) const {
  return takes_step_options(method) ? question_.options : std::nullopt;
}

std::string PredictedRows::name_of_row(const Method& method) const {
  const std::optional<StepChoices> options = options_of(method);
  return options ? name_with(method, *options) : method.id;
}

/// One row, verified where that is asked for.
Prediction PredictedRows::predicted(const Method& method, const Problem& problem, const OperatingPoint& point,
                                    const Linearised& near) const {
  const StepQuestion by_steps{
      .options = options_of(method), .verified = question_.verify, .watch = [] { leave_when_interrupted(); }};
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

void PredictedRows::predict_all(std::size_t which, const Linearised& near, const std::vector<Method>& methods,
                                std::vector<LimitRow>& rows) {
  const Problem& problem = problems_[which];
  rows.resize(methods.size());
  // Some systems have one workspace, so that a worker has a problem and a point of its own; bodies are
  // shared.
  std::vector<Problem> own(1, with_frozen_matrices(problem, near.point.model.t));
  std::vector<OperatingPoint> points;
  // A model of a plugin keeps two cores busy, its process and the thread that calls it.
  const std::size_t workers = std::max<std::size_t>(1, choices_[which].plugin.empty() ? jobs() : jobs() / 2);
  const ThreadLimit limit(workers);
  while (own.size() < std::min(workers, methods.size())) {
    own.push_back(problem.body ? problem : with_frozen_matrices(choices_[which].make(), near.point.model.t));
    if (!problem.body) ask(points.emplace_back(near.point), own.back());
  }
  const auto point_of = [&](std::size_t worker) -> const OperatingPoint& {
    return worker == 0 || points.empty() ? near.point : points[worker - 1];
  };
  const std::size_t before = rows_.size();
  const std::string task = problem.material + (problem.material.empty() ? "" : " ");
  RowProgress shown(*progress_, task + (question_.verify ? "verifying " : ""),
                    [&](std::size_t done) { return share(before + done); });
  parallel_for(
      methods.size(),
      [&](std::size_t i, std::size_t worker) {
        const Method& method = methods[i];
        shown.begin(method.id);
        Prediction prediction;
        try {
          prediction = predicted(method, own[worker], point_of(worker), near);
        } catch (const Interrupted&) {
          return;  // without this row
        }
        LimitRow row = limit_row(prediction);
        row.method = name_of_row(method);
        if (question_.verify && row.verdict.empty()) row.verdict = "not_run";
        Json details = details_json(prediction);
        if (question_.options) details["options"] = options_json(options_of(method));
        row.details = details.dump();
        rows[i] = std::move(row);
        shown.end(method.id);
      },
      [](std::size_t) {}, [&] { return interrupted_.load(); });
  if (interrupted_) std::erase_if(rows, [](const LimitRow& row) { return row.method.empty(); });
}

/// Puts the limits along a path into the rows of one problem.
/// @throws Interrupted  after Ctrl-C; what is in the rows by then is finished
void PredictedRows::look_along(const Problem& problem, const Path& path, const std::vector<Method>& methods,
                               std::vector<LimitRow>& rows) {
  const Watcher watcher = watch(problem, "limits along");
  const std::vector<std::optional<TrajectoryLimit>> limits = limits_along(methods, problem, path, watcher);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].path_note = path.note;
    if (!limits[i]) continue;
    constant_along_ = limits[i]->constant;
    const TrajectoryLimit along = as_shown(*limits[i], problem.shown);
    add_path(rows[i], along, path.note);
    Json details = Json::parse(rows[i].details);
    details["along"] = path_json(along, rows[i], problem);
    rows[i].details = details.dump();
  }
  if (!question_.runs_from_start) return;
  const double t_end = question_.end_of(problem);
  std::optional<MotionSize> size;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].from_start_stride = 0;
    if (!limits[i] || !(limits[i]->least > 0) || !std::isfinite(limits[i]->least)) continue;
    if (!size) size = size_of_motion(problem, t_end, watcher);
    if (const auto limit = limit_from_start(methods[i], problem, t_end, limits[i]->least, *size, watcher))
      add_start(rows[i], *limit);
  }
}

void PredictedRows::tell_of_state(std::size_t which, const Linearised& near, const std::optional<Path>& path,
                                  OperatingPointRow& point) const {
  const Problem& problem = problems_[which];
  point.status = words_of_state(problem, near, path.has_value());
  if (near.point.at_equilibrium)
    add_line(point.remarks, warning_of_tool(problem, near.point.model.t, near.point.model.y));
  if (has_moving_load(problem)) add_line(point.remarks, point.status);
  point.words = words_of_model(question_, problem, near, path, constant_along_);
  if (console_.json || store_) point.document = model_json(problem, near).dump();
  if (problem.body && (store_ || (which == 0 && !console_.json)))
    point.body_words = body_in_words(problem) + "\n" + fastest_mode_in_words(problem, near);
  else if (is_matrices_id(problem.id))
    point.body_words = body_in_words(problem) + "\n";
}

Json PredictedRows::json() const {
  Json rows = Json::array(), models = Json::array();
  for (std::size_t i = 0; i < rows_.size(); ++i)
    rows.push_back(
        to_json(rows_[i], points_[row_problems_[i]].status, problems_[row_problems_[i]].parameters));
  for (const OperatingPointRow& point : points_)
    if (!point.document.empty()) models.push_back(Json::parse(point.document));
  return {{"rows", std::move(rows)}, {"models", std::move(models)}};
}

std::string PredictedRows::words() const {
  const LimitColumns columns{question_.verify, question_.runs_from_start, question_.path};
  std::string text = limit_table(rows_, columns, console_);
  if (!points_.empty()) text += "\n";
  for (std::size_t which = 0; which < points_.size(); ++which) {
    if (problems_.size() > 1 && !points_[which].words.empty()) text += problems_[which].material + ", ";
    text += points_[which].words;
    if (which == 0) text += points_[which].body_words;
  }
  return text + words_of_paths(rows_) + words_of_strides(rows_) + words_of_notes(rows_);
}

}  // namespace hmax
