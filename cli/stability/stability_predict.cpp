/// hmax stability predict
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/step_limits/non_normality.hpp"
#include "bench/limits/predict.hpp"
#include "bench/limits/trajectory_limit.hpp"
#include "bench/limits/verification.hpp"
#include "bench/models/body_balance.hpp"
#include "bench/models/tissue_problem.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/bodies/tool_report.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/fastest_mode_words.hpp"
#include "cli/stability/operating_point.hpp"
#include "cli/stability/stability.hpp"
#include "core/parallel_for.hpp"
#include "problems/oscillator/liver_materials.hpp"
#include "problems/tissue/body.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

/// What --along looks along.
constexpr std::array<std::string_view, 3> path_names{"motion", "load", "none"};

struct PredictOptions {
  ProblemChoice problem;
  MethodsChoice methods;
  std::string materials;
  bool verify = false;
  OperatingPointChoice at;
  std::string along;              ///< a word of path_names, or empty
  bool along_by_default = false;  ///< nobody asked for it
  bool runs_from_start = false;   ///< limits along a motion are verified by runs from its start
  std::optional<double> t_end;

  [[nodiscard]] bool along_load() const { return along == path_names[1]; }
  /// Of the motion that is looked at [s].
  [[nodiscard]] double end_of(const Problem& problem) const { return t_end.value_or(end_of_motion(problem)); }
};

/// Whether the load changes with time, so that one state does not tell of all.
bool has_moving_load(const Problem& problem) { return problem.body && !problem.body->is_autonomous(); }

/// The options with what --along stands for: loads of bodies that change with time, and other models that are
/// not linear, are looked at along the motion unless the user asks for the state at rest, or for no path.
PredictOptions with_path(PredictOptions options, const Problem& problem) {
  if (options.along.empty()) {
    options.along_by_default = (problem.body ? has_moving_load(problem) : is_nonlinear(problem)) &&
                               options.at.of(problem) != OperatingPoint::rest;
    if (options.along_by_default) options.along = path_names[0];
  } else if (parse_choice("--along", options.along, path_names) == path_names[2]) {
    options.along.clear();
  }
  if (options.t_end && (options.along.empty() || options.along_load()))
    throw InputError(
        "--t-end ends the motion of --along, which is not asked for; add --along or leave it out");
  // Some thousand runs: of bodies only for those who ask.
  options.runs_from_start =
      options.verify && options.along == path_names[0] && !(options.along_by_default && problem.body);
  return options;
}

/// Why the state is not the one that was asked for, and what of the load is not in the limits there.
/// @param along  whether the motion is looked at
std::string words_of_state(const Problem& problem, const Linearised& near, bool along) {
  std::string missing = near.missing;
  if (!missing.empty() && !along)
    missing +=
        near.state_kind == "rest" && near.status.empty() ? "; leave out --at rest" : "; add --along motion";
  if (missing.empty() && has_moving_load(problem) && !along)
    missing = fmt::format(
        "the load of {} changes with time, and the limits are those of one state; look at the others with --along motion",
        problem.id);
  return near.status + (near.status.empty() || missing.empty() ? "" : "; ") + missing;
}

/// Ids of a list; all: both ends of the mass range of every material.
std::vector<std::string> materials_of(const PredictOptions& options) {
  if (options.materials.empty()) return {options.problem.material};
  if (!options.problem.material.empty())
    throw InputError("--material and --materials are both given; choose one of them");
  std::vector<std::string> ids;
  for (const std::string& name : parse_names("--materials", options.materials)) {
    if (name != "all") {
      ids.push_back(name);
      continue;
    }
    for (const LiverMaterial& material : liver_materials())
      for (const char* end : {":light", ":heavy"}) ids.push_back(std::string(material.id) + end);
  }
  return ids;
}

Json to_json(const Mode& mode) {
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  Json document{{"re", mode.lambda.real()},
                {"im", mode.lambda.imag()},
                {"omega", number(mode.omega)},
                {"zeta", number(mode.zeta)}};
  if (mode.rates) document["rates"] = *mode.rates;
  if (!mode.omega)
    document["status"] = mode.rates ? "negative stiffness has no natural frequency"
                                    : "a real eigenvalue without a known partner has no natural frequency";
  else if (!mode.zeta)
    document["status"] = "without stiffness there is no damping ratio";
  return document;
}

/// The decay rates of a mode that does not oscillate; negative where it grows.
std::string words_of_rates(const Mode& mode) {
  if (mode.lambda.imag() != 0) return "-";
  if (!mode.rates) return short_number(-mode.lambda.real());
  return fmt::format("{} and {}", short_number((*mode.rates)[0]), short_number((*mode.rates)[1]));
}

/// A row and what is asked besides.
struct PredictedRow {
  Prediction prediction;
  std::string state_status;  ///< why the state is not the one that was asked for
  std::optional<TrajectoryLimit> along;
  std::string path_note;
  std::optional<StartLimit> from_start;
};

/// What is known of the model alone.
Json model_json(const Problem& problem, const Linearised& near) {
  Json eigenvalues = Json::array();
  for (const Complex lambda : near.spectrum.lambda) eigenvalues.push_back({lambda.real(), lambda.imag()});
  Json document{{"problem", problem.id},
                {"material", problem.material},
                {"state", near.state},
                {"state_kind", near.state_kind},
                {"at_equilibrium", near.at_equilibrium},
                {"eigenvalues", std::move(eigenvalues)}};
  if (near.curve)
    document["status"] = near.slow_end
                             ? "of the fastest mode; the slowest is not computed, because no limit needs it"
                             : "of the slowest and the fastest mode; all others lie between them";
  if (near.range) document["status"] = "of the fastest modes; damping couples all of them";
  // Some ten operations with dense matrices of twice the size of the model.
  constexpr Eigen::Index most_dense = 400;
  if (near.model.y.size() <= most_dense) {
    const Eigen::MatrixXd J = jacobian_in_energy_coordinates(near.model);
    const NonNormality normal = non_normality(J);
    document["departure_from_normality"] = normal.departure;
    document["relative_departure"] = normal.relative_departure;
    document["numerical_abscissa"] = normal.numerical_abscissa;
    // Some hundred spectra of twice the size: of small models only.
    constexpr Eigen::Index small = 12;
    if (J.rows() <= small) document["kreiss_constant"] = number_or_word(kreiss_constant(J).value);
  }
  if (near.model.mechanical) document["damping"] = name_of(near.model.mechanical->damping);
  document["body"] = body_json(problem);
  if (const auto tool = tool_report(problem, near.model.t, near.model.y)) document["tool"] = tool->json();
  if (problem.body) document["fastest_mode"] = fastest_mode_json(problem, near);
  return document;
}

Json to_json(const Prediction& row) {
  Json parameters = Json::object();
  for (const auto& [name, value] : row.parameters) parameters[name] = value;
  // Of large models those with the least margins.
  constexpr std::size_t most_modes = 50;
  std::vector<ModeMargin> shown = row.modes;
  if (shown.size() > most_modes) {
    std::ranges::stable_sort(shown, {}, &ModeMargin::h_max);
    shown.resize(most_modes);
  }
  Json modes = Json::array();
  for (const ModeMargin& margin : shown) {
    Json mode = to_json(margin.mode);
    mode["h_max"] = number_or_word(margin.h_max);
    modes.push_back(std::move(mode));
  }
  Json document{{"problem", row.problem},
                {"material", row.material},
                {"method", row.method},
                {"h_max", row.h_max ? number_or_word(*row.h_max) : Json()},
                {"h_unstable", row.unstable_from ? number_or_word(*row.unstable_from) : Json()},
                {"bound", name_of(row.bound)},
                {"limiting", row.limiting ? to_json(*row.limiting) : Json()},
                {"observed", row.observed ? number_or_word(row.observed->h_max) : Json()},
                {"gap", row.observed && std::isfinite(row.observed->gap) ? Json(row.observed->gap) : Json()},
                {"steps_used", row.observed ? Json(row.observed->steps) : Json()},
                {"agrees", row.observed ? Json(row.observed->confirms()) : Json()},
                {"step_defect", row.observed ? number_or_word(row.observed->step_defect) : Json()},
                {"modes", std::move(modes)},
                {"state_kind", row.state_kind},
                {"state", row.state},
                {"parameters", std::move(parameters)}};
  if (const auto& step = row.newton_step)
    document["newton_step"] = {
        {"h", step->h},
        {"is_limit", step->is_limit},
        {"error_mm", std::isfinite(step->error) ? Json(1000 * step->error) : Json()},
        {"error_bound_mm", std::isfinite(step->error_bound) ? Json(1000 * step->error_bound) : Json()}};
  if (!row.note.empty()) document["status"] = row.note;
  return document;
}

/// Where on a path tangents grow, so that the limits there are those of no step.
std::string words_of_growth(const TrajectoryLimit& along, bool of_load) {
  const auto first = std::ranges::find_if(along.h_max, [](double h) { return std::isnan(h); });
  if (along.growing == 0 || first == along.h_max.end()) return {};
  const double at = along.t[static_cast<std::size_t>(first - along.h_max.begin())];
  return of_load
             ? fmt::format(
                   "the body buckles from {} of the load on: the stiffness of its equilibrium has a negative eigenvalue "
                   "there; take less load, or look where it goes with `--along motion`",
                   short_number(at, 4))
             : fmt::format(
                   "the tangent grows on {} % of the motion, from t = {} s on, where neighbours part "
                   "whatever the step",
                   short_number(100 * along.growing, 3), short_number(at, 4));
}

Json to_json(const TrajectoryLimit& along, bool of_load, bool of_body, const std::string& note) {
  Json path = Json::array();
  for (std::size_t i = 0; i < along.t.size(); ++i)
    path.push_back({along.t[i], number_or_word(along.h_max[i])});
  Json document{{"h_min", number_or_word(along.least)}, {of_load ? "share" : "t", along.t_least}};
  // The states of bodies are long.
  const Eigen::VectorXd& y = along.y_least;
  if (of_body)
    document["max_displacement"] = largest_displacement(y.head(y.size() / 2));
  else
    document["y"] = std::vector<double>(y.begin(), y.end());
  document["growing_share"] = along.growing;
  document["path"] = std::move(path);
  const std::string growth = words_of_growth(along, of_load);
  if (!growth.empty() || !note.empty())
    document["status"] = growth + (growth.empty() || note.empty() ? "" : "; ") + note;
  return document;
}

Json to_json(const PredictedRow& row, const PredictOptions& options) {
  Json document = to_json(row.prediction);
  if (!row.state_status.empty())
    document["status"] = row.state_status + (row.prediction.note.empty() ? "" : "; " + row.prediction.note);
  if (row.along)
    document["along"] =
        to_json(*row.along, options.along_load(), is_tissue_id(row.prediction.problem), row.path_note);
  if (row.from_start) {
    document["observed_from_start"] = number_or_word(row.from_start->h);
    document["observed_from_start_stride"] = row.from_start->stride;
  }
  return document;
}

std::string words_of(const std::optional<double>& h) {
  return !h ? "-" : std::isinf(*h) ? "unbounded" : std::isnan(*h) ? "grows" : short_number(*h, 7);
}

/// "+0.0012 %"; without a sign what rounds to nothing.
std::string percents(double share) {
  const std::string text = fmt::format("{:+.4f} %", 100 * share);
  return text.find_first_of("123456789") == std::string::npos ? text.substr(1) : text;
}

std::string for_people(const std::vector<PredictedRow>& rows, const PredictOptions& options,
                       const Console& console) {
  const bool verified = options.verify;
  std::vector<std::string> header{"method", "material", "h_max [s]", "limited by", "omega [rad/s]", "zeta"};
  // Where they are not all of one kind.
  const bool names_states = std::ranges::any_of(rows, [&](const PredictedRow& row) {
    return row.prediction.state_kind != rows.front().prediction.state_kind;
  });
  if (names_states) header.insert(header.begin() + 2, "at");
  const bool solves = std::ranges::any_of(
      rows, [](const PredictedRow& row) { return row.prediction.newton_step.has_value(); });
  const bool any_real = std::ranges::any_of(rows, [](const PredictedRow& row) {
    return row.prediction.limiting && row.prediction.limiting->lambda.imag() == 0;
  });
  if (any_real) header.emplace_back("rates [1/s]");
  if (solves) header.insert(header.end(), {"solved up to [s]", "error there [mm]"});
  if (verified) header.insert(header.end(), {"observed [s]", "gap", "steps"});
  if (!options.along.empty())
    header.insert(header.end(), {"least along [s]", options.along_load() ? "at share [1]" : "at t [s]"});
  const bool from_starts = options.runs_from_start;
  if (from_starts) header.emplace_back("from the start [s]");
  TextTable table(std::move(header));
  for (const auto& [row, status, along, note, from_start] : rows) {
    std::vector<std::string> cells{
        row.method,
        row.material.empty() ? "-" : row.material,
        words_of(row.h_max),
        std::string(name_of(row.bound)),
        row.limiting && row.limiting->omega ? short_number(*row.limiting->omega) : "-",
        row.limiting && row.limiting->zeta ? short_number(*row.limiting->zeta) : "-"};
    if (names_states) cells.emplace(cells.begin() + 2, row.state_kind);
    if (any_real) cells.push_back(row.limiting ? words_of_rates(*row.limiting) : "-");
    if (solves) {
      const auto& step = row.newton_step;
      cells.push_back(!step ? "-" : (step->is_limit ? "" : "> ") + short_number(step->h, 3));
      cells.push_back(step && std::isfinite(step->error) ? short_number(1000 * step->error, 3) : "-");
    }
    if (verified) {
      const auto& seen = row.observed;
      cells.push_back(seen ? words_of(seen->h_max) : "-");
      cells.push_back(seen && std::isfinite(seen->gap) ? percents(seen->gap) : "-");
      cells.push_back(seen ? std::to_string(seen->steps) : "-");
    }
    if (!options.along.empty()) {
      cells.push_back(along && !std::isnan(along->least) ? words_of(along->least) : "-");
      cells.push_back(along && std::isfinite(along->least) ? short_number(along->t_least, 4) : "-");
      if (from_starts) cells.push_back(words_of(from_start ? std::optional(from_start->h) : std::nullopt));
    }
    table.add(std::move(cells));
  }
  return table.text(console);
}

/// Ends a long task after Ctrl-C.
/// @throws Interrupted
void leave_when_interrupted() {
  if (interrupt_flag()) throw Interrupted{};
}

/// What --along looks along.
/// @throws Interrupted  after Ctrl-C
Path path_of(const PredictOptions& options, const Problem& problem, const Watcher& watcher) {
  if (options.along_load()) return load_path(problem, 40, watcher);
  // Contact comes and goes faster than a body moves otherwise.
  const int points = problem.body && problem.body->settings().tools.empty() ? 100 : 400;
  return motion_path(problem, options.end_of(problem), points, watcher);
}

/// What is to be said of rows, once of all methods of which it is to be said.
std::string words_of_notes(const std::vector<PredictedRow>& rows) {
  struct Said {
    std::string note, material;
    std::vector<std::string> methods;
  };
  std::vector<Said> all;
  for (const PredictedRow& each : rows) {
    const Prediction& row = each.prediction;
    if (row.note.empty() || row.bound == Bound::error_control) continue;
    const auto same = std::ranges::find_if(
        all, [&](const Said& said) { return said.note == row.note && said.material == row.material; });
    if (same == all.end())
      all.push_back({row.note, row.material, {row.method}});
    else
      same->methods.push_back(row.method);
  }
  std::string text;
  for (const auto& [note, material, methods] : all)
    text +=
        fmt::format("{}{}: {}\n", fmt::join(methods, ", "), material.empty() ? "" : ", " + material, note);
  return text;
}

/// What goes on along a path, and how to go without where nobody asked for it.
std::string task_along(const PredictOptions& options, const Problem& problem, std::string_view what) {
  return fmt::format("{} {}{}", what,
                     options.along_load()
                         ? "the growing load"
                         : fmt::format("the motion to t = {} s", short_number(options.end_of(problem))),
                     options.along_by_default ? "; --along none goes without" : "");
}

/// Puts the limits along a path into the rows of one problem.
/// @throws Interrupted  after Ctrl-C; what is in the rows by then is finished
void look_along(const PredictOptions& options, const Problem& problem, const Path& path,
                std::span<const Method> methods, std::span<PredictedRow> rows, const Watcher& watcher) {
  const std::vector<std::optional<TrajectoryLimit>> limits = limits_along(methods, problem, path, watcher);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].along = limits[i];
    rows[i].path_note = path.note;
  }
  if (!options.runs_from_start) return;
  const double t_end = options.end_of(problem);
  std::optional<MotionSize> size;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!limits[i] || !(limits[i]->least > 0) || !std::isfinite(limits[i]->least)) continue;
    if (!size) size = size_of_motion(problem, t_end, watcher);
    rows[i].from_start = limit_from_start(methods[i], problem, t_end, limits[i]->least, *size, watcher);
  }
}

/// Why the limits of one state do not tell of a motion.
std::string_view why_along(const Problem& problem) {
  return problem.body ? "the load changes with time" : "the model is not linear";
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
                     short_number(t_end), short_number(*period), short_number(*period));
}

/// What the limits of a model hold for, and where it was linearised.
std::string words_of_model(const PredictOptions& options, const Problem& problem, const Linearised& near,
                           bool has_path) {
  std::string words = fmt::format("{}: {}\n", problem.id, near.state);
  if (has_path && options.along_by_default)
    words += fmt::format(
        "{}: h_max holds for small motions about this state; \"least along\" is the smallest limit of all states on the "
        "motion to t = {} s\n",
        why_along(problem), short_number(options.end_of(problem)));
  else if (problem.body && !has_path && near.state_kind == "equilibrium" && near.model.y.norm() > 0 &&
           problem.body->settings().model != TissueModel::fem_cauchy)
    words +=
        "h_max is that of small motions about this state; a load that acts at once passes others, which --along looks "
        "at\n";
  if (has_path && options.along == path_names[0]) words += words_of_part(problem, options.end_of(problem));
  if (const auto tool = tool_report(problem, near.model.t, near.model.y); tool && near.at_equilibrium)
    words += fmt::format("tool: {}\n", tool->words());
  return words;
}

/// By which strides first failures were sought.
std::string words_of_strides(const std::vector<PredictedRow>& rows) {
  double longest = 0;
  for (const PredictedRow& row : rows)
    if (row.from_start) longest = std::max(longest, row.from_start->stride);
  if (longest == 0) return {};
  return fmt::format(
      "from the start: up to the first step that fails, sought in strides of at most {} %, between which narrower "
      "windows may lie\n",
      short_number(100 * longest, 2));
}

/// The rows of one call of the command, problem by problem, and what is said of them.
class PredictedRows {
 public:
  PredictedRows(const PredictOptions& options, std::vector<ProblemChoice> choices,
                std::vector<Problem> problems, std::vector<Method> methods, Console& console)
      : options_(options),
        choices_(std::move(choices)),
        problems_(std::move(problems)),
        methods_(std::move(methods)),
        console_(console) {}

  /// Every problem with every method; ends early when the user interrupts, with what is finished.
  void compute() {
    Progress progress(console_, "predict");
    progress_ = &progress;
    for (std::size_t which = 0; which < problems_.size() && !interrupted_; ++which) {
      try {
        add(which);
      } catch (const Interrupted&) {
        break;  // the flag stays set: what is finished is printed
      }
    }
    progress_ = nullptr;
  }

  void print() {
    if (console_.json) {
      Json list = Json::array();
      for (const PredictedRow& row : rows_) list.push_back(to_json(row, options_));
      return console_.print_json({{"rows", std::move(list)}, {"models", std::move(models_)}});
    }
    console_.print(for_people(rows_, options_, console_));
    console_.print(states_ + words_of_paths() + words_of_strides(rows_) + words_of_notes(rows_));
  }

 private:
  [[nodiscard]] double share(std::size_t rows) const {
    return static_cast<double>(rows) / static_cast<double>(problems_.size() * methods_.size());
  }

  Watcher watch(const Problem& problem, std::string_view what) {
    return [this, task = task_along(options_, problem, what)] {
      leave_when_interrupted();
      progress_->update(share(rows_.size()), task);
    };
  }

  /// The motion that limits are looked for along; nothing where there is none and nobody asked for it.
  std::optional<Path> motion_of(const Problem& problem) {
    if (options_.along.empty()) return std::nullopt;
    try {
      return path_of(options_, problem, watch(problem, "finding"));
    } catch (const InputError& error) {
      if (!options_.along_by_default) throw;
      console_.remark(without_motion(problem, error));
      return std::nullopt;
    }
  }

  void add(std::size_t which) {
    const Problem& problem = problems_[which];
    const std::optional<Path> path = motion_of(problem);
    const OperatingPoint at = options_.at.of(problem);
    announce_equilibrium(console_, problem, at);
    const Linearised near = [&] {
      LinearisationProgress shown(*progress_);
      return linearised(problem, at, shown.watcher());
    }();
    tell_of_state(which, near, path.has_value());
    const std::size_t before = rows_.size();
    predict_all(which, near, words_of_state(problem, near, path.has_value()));
    for (const PredictedRow& row : std::span(rows_).subspan(before))
      if (const auto& seen = row.prediction.observed; seen && seen->contradicts())
        console_.exit_code = Exit::failed;
    if (!path || interrupted_) return;
    const std::span<PredictedRow> own = std::span(rows_).last(methods_.size());
    try {
      look_along(options_, problem, *path, methods_, own, watch(problem, "limits along"));
    } catch (const InputError& error) {
      if (!options_.along_by_default) throw;
      console_.remark(without_motion(problem, error));
      for (PredictedRow& row : own) row.state_status = words_of_state(problem, near, false);
    }
  }

  void tell_of_state(std::size_t which, const Linearised& near, bool along) {
    const Problem& problem = problems_[which];
    if (console_.json) models_.push_back(model_json(problem, near));
    if (near.at_equilibrium) warn_of_tool(console_, problem, near.model.t, near.model.y);
    const std::string status = words_of_state(problem, near, along);
    if (has_moving_load(problem) && !status.empty()) console_.remark(status);
    if (states_.empty()) states_ = "\n";
    if (problems_.size() > 1) states_ += problem.material + ", ";
    states_ += words_of_model(options_, problem, near, along);
    if (which == 0 && problem.body && !console_.json)
      states_ += body_in_words(problem) + "\n" + fastest_mode_in_words(problem, near);
  }

  void predict_all(std::size_t which, const Linearised& near, const std::string& status) {
    const Problem& problem = problems_[which];
    const std::size_t before = rows_.size();
    rows_.resize(before + methods_.size());
    // Formulas have one workspace each; bodies are shared.
    std::vector<Problem> own(1, problem);
    while (own.size() < std::min(jobs(), methods_.size()))
      own.push_back(problem.body ? problem : choices_[which].make());
    parallel_for(
        methods_.size(),
        [&](std::size_t i, std::size_t worker) {
          const Method& method = methods_[i];
          PredictedRow row{predict(method, own[worker], near), status, {}, {}, {}};
          if (row.prediction.bound == Bound::newton && method.bind)  // formulas step nothing
            row.prediction.newton_step = largest_newton_step(method, own[worker]);
          if (options_.verify) verify(row.prediction, method, own[worker], near);
          rows_[before + i] = std::move(row);
        },
        [&](std::size_t done) { progress_->update(share(before + done), problem.material); },
        [&] { return interrupted_.load(); });
    if (interrupted_)
      std::erase_if(rows_, [](const PredictedRow& row) { return row.prediction.method.empty(); });
  }

  /// What is to be said of limits along motions, once of neighbours that say the same.
  [[nodiscard]] std::string words_of_paths() const {
    std::string remarks, said;
    for (const PredictedRow& each : rows_) {
      std::string words = each.along ? words_of_growth(*each.along, options_.along_load()) : "";
      if (!words.empty()) words += "\n";
      if (!each.path_note.empty()) words += each.path_note + "\n";
      if (words.empty() || words == said) continue;
      remarks += each.prediction.material.empty() ? words : each.prediction.material + ": " + words;
      said = words;
    }
    return remarks;
  }

  const PredictOptions& options_;
  std::vector<ProblemChoice> choices_;
  std::vector<Problem> problems_;
  std::vector<Method> methods_;
  Console& console_;
  const std::remove_reference_t<decltype(interrupt_flag())>& interrupted_ = interrupt_flag();
  Progress* progress_ = nullptr;
  std::vector<PredictedRow> rows_;
  Json models_ = Json::array();
  std::string states_;
};

/// @throws InputError  where --verify names a formula without code
void require_code(const std::vector<Method>& methods) {
  for (const Method& method : methods)
    if (!method.bind)
      throw InputError(fmt::format(
          "{} is a formula that nothing in hmax steps with, so there are no runs to verify it by; "
          "leave out --verify, or name methods of `hmax list methods`",
          method.id));
}

void predict_rows(const PredictOptions& asked, Console& console) {
  std::vector<ProblemChoice> choices;
  std::vector<Problem> problems;
  for (const std::string& material : materials_of(asked)) {
    choices.push_back(asked.problem);
    choices.back().material = material;
    problems.push_back(choices.back().make());
  }
  const PredictOptions options = with_path(asked, problems.front());
  std::vector<Method> methods = options.methods.methods(problems);
  if (options.verify) require_code(methods);
  for (const Problem& problem : problems) remark_unusual(console, problem);
  asked.problem.remark_idle(console, problems.front());
  PredictedRows rows(options, std::move(choices), std::move(problems), std::move(methods), console);
  rows.compute();
  rows.print();
  if (interrupt_flag()) throw Interrupted{};
}

}  // namespace

void add_stability_predict(CLI::App& stability, Console& console) {
  CLI::App& command = add_command(
      stability, console, "predict",
      "The largest stable step of methods on a model, and the mode that sets it",
      {"hmax stability predict --problem liver_benchmark --materials all --methods rk4,ode45",
       "hmax stability predict --problem liver_benchmark --methods "
       "explicit_runge_kutta,structural --verify --json",
       "hmax stability predict --problem liver_forced --methods rk4,symplectic_euler --along --verify",
       "hmax stability predict --mesh phantom --load press --methods rk4 --along load"});
  const auto options = std::make_shared<PredictOptions>();
  options->problem.add_to(command);
  command
      .add_option("--materials", options->materials,
                  "Ids of `hmax list materials`; all: both ends of the mass range of each")
      ->type_name("A,B");
  options->methods.add_to(command, "Ids, aliases or families of `hmax list methods`, all, or " +
                                       fmt::format("{}", fmt::join(formula_patterns(), ", ")));
  command.add_flag(
      "--verify", options->verify,
      "Integrate with the code itself on both sides of each limit; exit code 1 when one is wrong");
  options->at.add_to(command);
  command
      .add_option(
          "--along", options->along,
          "Also the least limit of the tangent, and where: along the motion from the initial state "
          "(with --verify also the largest step that stays near it), or of a body while its load grows; "
          "motion by default of models that are not linear and of bodies whose load changes with time, none to leave it "
          "out")
      ->type_name("motion|load|none")
      ->expected(0, 1)
      ->default_str(std::string(path_names[0]));
  add_number(command, "--t-end", options->t_end,
             "End of that motion [s]; by default the problem's own, and at least a period of its load");
  add_jobs(command);
  command.callback([options, &console] { predict_rows(*options, console); });
}

}  // namespace hmax
