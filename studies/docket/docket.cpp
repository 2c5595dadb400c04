#include "studies/docket/docket.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/step_limits/stable_step.hpp"
#include "catalogue/input/suggest.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/chosen_methods.hpp"
#include "catalogue/models/problem_file.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "limits/fidelity/fidelity.hpp"
#include "limits/query/query_limits.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

constexpr std::array<std::string_view, 7> causes{"none",     "step",     "model", "work",
                                                 "accuracy", "material", "other"};
/// What the stiffness shown may be off, and the steps of a run that was given no number of them; a state that
/// many times its first one has met a pole.
constexpr double allowed_softness = 0.05;
constexpr std::int64_t patience = 1'000'000;
constexpr double blown_up = 1e6;

constexpr std::array<std::string_view, 14> case_keys{"name", "method", "h",      "rate",  "rtol",
                                                     "atol", "steps",  "error",  "cause", "set",
                                                     "t0",   "t_end",  "remedy", "y0"};

/// A table of a report, read with its place.
class Entries {
 public:
  Entries(const TomlDocument& document, std::string place)
      : document_(document), place_(std::move(place)), table_(document.root.at(Json::json_pointer(place_))) {}

  [[nodiscard]] bool has(const char* key) const { return table_.contains(key); }
  [[nodiscard]] std::string text(const char* key) const {
    if (!has(key) || !table_.at(key).is_string() || table_.at(key).get<std::string>().empty())
      document_.fail(place_of(key), fmt::format("'{}' must be a text in quotes", key));
    return table_.at(key).get<std::string>();
  }
  [[nodiscard]] std::string text_or_none(const char* key) const { return has(key) ? text(key) : ""; }
  [[nodiscard]] double positive(const char* key) const {
    const double value = number(key);
    if (!(value > 0)) document_.fail(place_of(key), fmt::format("'{}' must be above 0", key));
    return value;
  }
  [[nodiscard]] std::optional<double> number_if(const char* key) const {
    return has(key) ? std::optional(number(key)) : std::nullopt;
  }
  [[nodiscard]] std::vector<std::string> texts_or_none(const char* key) const {
    if (!has(key)) return {};
    if (!table_.at(key).is_array() ||
        !std::ranges::all_of(table_.at(key), [](const Json& each) { return each.is_string(); }))
      document_.fail(place_of(key), fmt::format("'{}' must be a list of texts in quotes", key));
    return table_.at(key).get<std::vector<std::string>>();
  }
  /// The numbers of a table by name, or of a list by index.
  [[nodiscard]] Parameters parameters(const char* key) const {
    Parameters values;
    if (!has(key)) return values;
    if (!table_.at(key).is_structured())
      document_.fail(place_of(key), fmt::format("'{}' must be a table or a list of numbers", key));
    for (const auto& [name, value] : table_.at(key).items()) {
      if (!value.is_number() || !std::isfinite(value.get<double>()))
        document_.fail(fmt::format("{}/{}", place_of(key), name),
                       fmt::format("'{}' must hold finite numbers", key));
      values.emplace_back(name, value.get<double>());
    }
    return values;
  }
  [[nodiscard]] std::string place_of(const char* key) const {
    return has(key) ? fmt::format("{}/{}", place_, key) : place_;
  }

 private:
  [[nodiscard]] double number(const char* key) const {
    if (!has(key) || !table_.at(key).is_number() || !std::isfinite(table_.at(key).get<double>()))
      document_.fail(place_of(key), fmt::format("'{}' must be a finite number", key));
    return table_.at(key).get<double>();
  }

  const TomlDocument& document_;
  std::string place_;
  const Json& table_;
};

/// What hmax says of a run.
struct Answer {
  std::string verdict = "none", found = {}, remedy = {};
};

std::string seconds(double h, int digits = 3) { return fmt::format("{} s", short_number(h, digits)); }

/// Whether the model grows by itself at its operating point.
bool grows(const OperatingPointRow& point) {
  std::vector<Complex> lambda;
  for (const Json& value : Json::parse(point.document).value("eigenvalues", Json::array()))
    lambda.emplace_back(value[0].get<double>(), value[1].get<double>());
  return !growing_modes(lambda).empty();
}

/// The limit of a fixed step, as `hmax stability predict` has it.
Answer answer_of_step(const Method& method, const Problem& problem, double h) {
  const LimitQuestion question = with_path(
      {.at = problem.body ? AskedState::rest : AskedState::equilibrium, .named = {method.id}}, "", problem);
  LimitWatcher watcher;
  const ModelLimits limits = query_limits(question, {problem}, {method}, true, watcher).models.front();
  const LimitRow& row = limits.rows.front();
  if (grows(limits.point)) return {"model", "the model itself grows, whatever the step is"};
  if (row.bound == "every_step") return {"step", "every step grows, however small", "another method"};
  const double limit = row.known_limit();
  if (std::isnan(limit)) return {"unknown", row.note};
  if (std::isinf(limit)) return {"none", "no step is unstable"};
  Answer answer{h > limit ? "step" : "none", fmt::format("largest stable step {}", seconds(limit))};
  if (std::isfinite(row.omega))
    answer.found += fmt::format(", of the mode {} rad/s", short_number(row.omega, 3));
  if (h > limit)
    answer.remedy = fmt::format("at most {}, or {:.0f} substeps", seconds(limit), std::ceil(h / limit));
  return answer;
}

/// The stiffness that steps of a rate show, as `hmax fidelity` has it.
Answer answer_of_rate(const Method& method, const Problem& problem, double rate) {
  const Fidelity shown = fidelity(method, fidelity_model(problem), {.h = 1 / rate});
  const bool off = !(std::abs(shown.stiffness_shown - 1) <= allowed_softness);
  return {off ? "material" : "none",
          std::isnan(shown.stiffness_shown)
              ? shown.status
              : fmt::format("shows {} % of the stiffness", short_number(100 * shown.stiffness_shown, 3)),
          ""};
}

/// The largest difference at the end from a run that is far more accurate, relative to the largest state
/// there.
double end_error(const RunRecord& record, const Problem& problem) {
  const Method reference = find_method("dop_853");
  const RunRecord exact = reference.bind(problem).run(
      {.t_end = problem.t_end, .adaptive = true, .rtol = 1e-12, .atol = 1e-14, .max_steps = 10 * patience},
      {});
  if (exact.outcome != Outcome::reached_end)
    throw InputError("no accurate run ends, so that 'error' has no meaning");
  return (record.y - exact.y).lpNorm<Eigen::Infinity>() / exact.y.lpNorm<Eigen::Infinity>();
}

/// Whether a run leaves the range of numbers also with a thousandth of the tolerances.
bool diverges_tighter(const Method& method, const Problem& problem, RunSpec spec) {
  spec.rtol *= 1e-3;
  spec.atol *= 1e-3;
  return method.bind(problem).run(spec, {}).outcome == Outcome::diverged;
}

/// What a run does, as `hmax run` has it.
Answer answer_of_run(const Method& method, const Problem& problem, const RunSpec& spec,
                     const std::optional<double>& allowed) {
  check(spec, method, problem);
  const RunRecord record = method.bind(problem).run(spec, {});
  const std::string at = seconds(problem.shown.time(record.t));
  switch (record.outcome) {
    case Outcome::diverged:
      if (spec.adaptive && !diverges_tighter(method, problem, spec))
        return {"accuracy",
                fmt::format("leaves the range of numbers at {}, not so with tighter tolerances", at),
                "tighter tolerances"};
      return {spec.adaptive ? "model" : "step", fmt::format("leaves the range of numbers at {}", at)};
    case Outcome::too_many_steps:
      return {"work",
              fmt::format("{} steps end at {} of {}", record.stats.steps, at,
                          seconds(problem.shown.time(spec.t_end))),
              ""};
    case Outcome::step_too_small:
    case Outcome::newton_failed:
      // Before a pole steps end sooner than numbers do.
      if (record.y.norm() > blown_up * (1 + problem.y0.norm()))
        return {"model", fmt::format("grows beyond all bounds at {}", at)};
      return {"unknown", fmt::format("no step is short enough at {}", at)};
    default:
      break;
  }
  Answer answer{.found = fmt::format("{} steps, {} evaluations", record.stats.steps, record.stats.rhs)};
  if (!allowed) return answer;
  const double error = end_error(record, problem);
  answer.verdict = error <= *allowed ? "none" : "accuracy";
  answer.found += fmt::format(", {} % off at the end", short_number(100 * error, 2));
  return answer;
}

/// What a run of a report is judged by.
class Judge {
 public:
  explicit Judge(const TomlDocument& document) : document_(document) {
    const Entries report(document, "/report");
    model_ = report.text_or_none("model");
    if (!model_.empty()) return;
    TomlDocument formulas = document;
    for (const char* key : {"report", "case"}) formulas.root.erase(key);
    definition_ = problem_from(formulas);
  }

  [[nodiscard]] std::string verdict(const std::string& place) const {
    return answered(Entries(document_, place)).verdict;
  }

  [[nodiscard]] DocketRow row(const std::string& place) const {
    const Entries table(document_, place);
    const std::string cause = table.text("cause");
    if (std::ranges::find(causes, cause) == causes.end())
      document_.fail(table.place_of("cause"),
                     fmt::format("'{}' is no cause; {}", cause, suggestion(cause, causes)));
    const Answer answer = answered(table);
    DocketRow row{.name = table.text("name"),
                  .method = table.text("method"),
                  .asked = asked(table),
                  .cause = cause,
                  .verdict = answer.verdict,
                  .found = answer.found,
                  .remedy = answer.remedy};
    row.right = row.verdict == (cause == "other" ? "none" : cause);
    if (table.has("remedy")) add_remedy(row, place);
    return row;
  }

 private:
  /// The case with the values of its remedy.
  void add_remedy(DocketRow& row, const std::string& place) const {
    TomlDocument changed = document_;
    const Json::json_pointer pointer(place);
    const Json remedy = document_.root.at(pointer).at("remedy");
    if (!remedy.is_object())
      document_.fail(place + "/remedy", "'remedy' must be a table, like remedy = {h = 0.001}");
    changed.root[pointer].update(remedy, true);
    reject_unknown_keys(changed, place, case_keys);
    const Entries table(changed, place);
    const Answer answer = answered(table);
    std::string words = table.text("method");
    if (words == row.method) words.clear();
    if (const std::string how = asked(table); how != row.asked) words += (words.empty() ? "" : ", ") + how;
    if (remedy.contains("set")) words += (words.empty() ? "" : ", ") + describe(table.parameters("set"));
    row.remedy += fmt::format("{}{}: {}", row.remedy.empty() ? "" : "; ", words, answer.found);
    row.right = row.right && answer.verdict == "none";
  }

  [[nodiscard]] Problem problem(const Entries& table) const {
    ProblemSettings settings{.material = {}, .parameters = table.parameters("set"), .y0 = {}};
    settings.t0 = table.number_if("t0");
    settings.t_end = table.number_if("t_end");
    for (const auto& [index, value] : table.parameters("y0")) settings.y0.push_back(value);
    if (definition_) return make_problem(*definition_, document_.name, settings);
    Problem made = make_problem(model_, settings);
    made.t_end = settings.t_end.value_or(made.t_end);
    return made;
  }

  /// @throws InputError  with the file, also of what the model or the method refuses
  [[nodiscard]] Answer answered(const Entries& table) const {
    try {
      return judged(table);
    } catch (const InputError& error) {
      if (std::string_view(error.what()).starts_with(document_.name)) throw;
      document_.fail(table.place_of("name"), error.what());
    }
  }

  [[nodiscard]] Answer judged(const Entries& table) const {
    const Problem problem = this->problem(table);
    const std::vector<Method> chosen = chosen_methods_and_formulas({table.text("method")}, {problem}).methods;
    const Method& method = chosen.front();
    const bool by_limit = table.has("h") && !table.has("error") && !table.has("rate") && !table.has("rtol");
    if (chosen.size() > 1 || (!method.bind && !by_limit))
      document_.fail(table.place_of("method"),
                     fmt::format("'{}' is not one method that steps", table.text("method")));
    if (table.has("rate")) return answer_of_rate(method, problem, table.positive("rate"));
    const std::optional<double> error = table.number_if("error");
    if (!table.has("rtol") && !error) return answer_of_step(method, problem, table.positive("h"));
    RunSpec spec{.t_end = problem.t_end, .adaptive = table.has("rtol"), .max_steps = 10 * patience};
    if (spec.adaptive) {
      spec.rtol = table.positive("rtol");
      spec.atol = table.positive("atol");
      spec.max_steps = table.has("steps")
                           ? static_cast<std::int64_t>(std::fmin(table.positive("steps"), adaptive_attempts))
                           : patience;
    } else {
      spec.h = table.positive("h");
    }
    return answer_of_run(method, problem, spec, error);
  }

  [[nodiscard]] static std::string asked(const Entries& table) {
    if (table.has("rate")) return fmt::format("{} Hz", short_number(table.positive("rate"), 4));
    if (!table.has("rtol")) return "h " + seconds(table.positive("h"), 4);
    return fmt::format("rtol {}, atol {}{}", to_text(table.positive("rtol")), to_text(table.positive("atol")),
                       table.has("steps") ? fmt::format(", {} steps", table.positive("steps")) : "");
  }

  const TomlDocument& document_;
  std::string model_;
  std::optional<FormulaDefinition> definition_{};
};

/// Multiplies each number of that name: of a table's key, or in an id, "iterations=16".
bool scale(Json& value, const std::string& name, double factor) {
  bool found = false;
  for (auto& [key, entry] : value.items()) {
    if (value.is_object() && key == name && entry.is_number()) {
      entry = factor * entry.get<double>();
      found = true;
    } else if (entry.is_structured()) {
      found = scale(entry, name, factor) || found;
    } else if (entry.is_string() && (key == "model" || key == "method")) {
      const std::string id = entry.get<std::string>();
      const std::size_t from = std::min({id.find(":" + name + "="), id.find("," + name + "="), id.size()});
      const std::size_t at = std::min(from + name.size() + 2, id.size());
      const std::size_t end = std::min(id.find(',', at), id.size());
      const std::string text = id.substr(at, end - at);
      const std::optional<double> number = to_number(text);
      if (!number) continue;
      // Cells and iterations stay whole.
      const bool whole = text.find_first_not_of("0123456789") == std::string::npos;
      const double scaled = whole ? std::ceil(factor * *number) : factor * *number;
      entry = id.substr(0, at) + to_text(scaled) + id.substr(end);
      found = true;
    }
  }
  return found;
}

/// The assumed numbers whose half or double changes a verdict.
std::vector<std::string> decisive_numbers(const TomlDocument& document, const DocketReport& report) {
  std::vector<std::string> decisive;
  for (const std::string& name : Entries(document, "/report").texts_or_none("vary"))
    for (const double factor : {0.5, 2.0}) {
      TomlDocument changed = document;
      if (!scale(changed.root, name, factor))
        document.fail("/report/vary", fmt::format("no number of the report is called '{}'", name));
      const Judge judge(changed);
      const auto same = [&, i = 0](const DocketRow& row) mutable {
        return judge.verdict(fmt::format("/case/{}", i++)) == row.verdict;
      };
      if (std::ranges::all_of(report.rows, same)) continue;
      decisive.push_back(name);
      break;
    }
  return decisive;
}

void check_keys(const TomlDocument& document) {
  constexpr std::array<std::string_view, 6> tables{"report",    "case",       "problem",
                                                   "equations", "parameters", "initial"};
  constexpr std::array<std::string_view, 12> texts{"title",   "link",  "program",  "version",
                                                   "posted",  "asked", "happened", "discussed",
                                                   "assumed", "vary",  "control",  "model"};
  reject_unknown_keys(document, "", tables);
  if (!document.root.contains("report")) document.fail("", "there is no [report]");
  reject_unknown_keys(document, "/report", texts);
  if (!document.root.contains("case") || !document.root.at("case").is_array() ||
      document.root.at("case").empty())
    document.fail("/case", "there is no run to judge; write [[case]]");
  for (std::size_t i = 0; i < document.root.at("case").size(); ++i)
    reject_unknown_keys(document, fmt::format("/case/{}", i), case_keys);
}

}  // namespace

DocketReport docket_report(const TomlDocument& document) {
  check_keys(document);
  const Entries table(document, "/report");
  DocketReport report{.name = std::filesystem::path(document.name).stem().string(),
                      .title = table.text("title"),
                      .link = table.text("link"),
                      .program = table.text("program"),
                      .version = table.text("version"),
                      .posted = table.text("posted"),
                      .asked = table.text("asked"),
                      .happened = table.text("happened"),
                      .discussed = table.text_or_none("discussed"),
                      .assumed = table.texts_or_none("assumed"),
                      .decisive = {},
                      .rows = {}};
  const Json& texts = document.root.at("report");
  if (!texts.contains("control") || !texts.at("control").is_boolean())
    document.fail(table.place_of("control"), "'control' must be true or false");
  report.control = texts.at("control").get<bool>();
  const Judge judge(document);
  for (std::size_t i = 0; i < document.root.at("case").size(); ++i)
    report.rows.push_back(judge.row(fmt::format("/case/{}", i)));
  report.right = std::ranges::all_of(report.rows, &DocketRow::right);
  report.decisive = decisive_numbers(document, report);
  return report;
}

}  // namespace hmax
