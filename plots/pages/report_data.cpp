#include "plots/pages/report_data.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <variant>

#include <fmt/format.h>

#include "core/numbers.hpp"
#include "plots/figure.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

using Cell = std::variant<double, std::string>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A column of a table of the page.
template <class Record>
struct ShownColumn {
  const char *key, *name, *unit;
  const char* form;  ///< text | long | number | count | list
  Cell (*of)(const Record&);
};

double in_ms(double seconds) { return 1e3 * seconds; }
double in_percent(double share) { return 100 * share; }
/// A tolerance or a step that a mode does not have is stored as zero.
double unless_zero(double value) { return value == 0 ? nan : value; }

/// The step itself in mode fixed, also of a run that diverged; elsewhere the mean of the accepted ones [s].
double step_of(const Row& row) {
  if (row.key.mode == "fixed") return row.key.h;
  return row.steps > 0 ? row.t_reached / static_cast<double>(row.steps) : nan;
}

TimingSummary shown_times(const Row& row) { return summarise(comparable_times(row)); }

const std::vector<ShownColumn<Row>>& run_columns() {
  using C = const Row&;
  static const std::vector<ShownColumn<Row>> columns{
      {"problem", "problem", "", "text", [](C r) -> Cell { return title_of(r.key.problem); }},
      {"material", "material", "", "text", [](C r) -> Cell { return r.key.material; }},
      {"method", "method", "", "text", [](C r) -> Cell { return r.key.method; }},
      {"mode", "mode", "", "text", [](C r) -> Cell { return r.key.mode; }},
      {"h", "h", "ms", "number", [](C r) -> Cell { return in_ms(unless_zero(r.key.h)); }},
      {"rtol", "rtol", "", "number", [](C r) -> Cell { return unless_zero(r.key.rtol); }},
      {"error", "largest error", "", "number", [](C r) -> Cell { return r.error_global; }},
      {"device", "device", "", "text", [](C r) -> Cell { return r.key.device; }},
      {"cpu", "CPU time", "ms", "number",
       [](C r) -> Cell { return is_on_device(r) ? nan : in_ms(shown_times(r).median); }},
      {"device_time", "device time", "ms", "number",
       [](C r) -> Cell { return is_on_device(r) ? in_ms(shown_times(r).median) : nan; }},
      {"outcome", "outcome", "", "text", [](C r) -> Cell { return r.outcome; }},
      {"speed", "real-time factor", "", "number",
       [](C r) -> Cell { return r.t_reached / shown_times(r).median; }},
      {"cpu_p99", "CPU time, 99 %", "ms", "number",
       [](C r) -> Cell { return is_on_device(r) ? nan : in_ms(shown_times(r).p99); }},
      {"device_p99", "device time, 99 %", "ms", "number",
       [](C r) -> Cell { return is_on_device(r) ? in_ms(shown_times(r).p99) : nan; }},
      {"error_end", "error at end", "", "number", [](C r) -> Cell { return r.error_end; }},
      {"reference_error", "error of reference", "", "number", [](C r) -> Cell { return r.reference_error; }},
      {"step", "time step", "ms", "number", [](C r) -> Cell { return in_ms(step_of(r)); }},
      {"steps", "steps", "", "count", [](C r) -> Cell { return static_cast<double>(r.steps); }},
      {"rejected", "rejected", "", "count", [](C r) -> Cell { return static_cast<double>(r.rejected); }},
      {"rhs", "evaluations", "", "count", [](C r) -> Cell { return static_cast<double>(r.rhs); }},
      {"atol", "atol", "", "number", [](C r) -> Cell { return unless_zero(r.key.atol); }},
      {"t_reached", "reached", "s", "number", [](C r) -> Cell { return r.t_reached; }},
      {"t_end", "end", "s", "number", [](C r) -> Cell { return r.key.t_end; }},
      {"status", "remark", "", "long", [](C r) -> Cell { return r.status; }},
      {"control", "control", "", "text",
       [](C r) -> Cell { return r.key.control == "none" ? "" : r.key.control; }},
      {"parameters", "parameters", "", "long", [](C r) -> Cell { return r.key.parameters; }},
      {"y0", "initial state", "", "long", [](C r) -> Cell { return r.key.y0; }},
      {"explored", "times", "", "text", [](C r) -> Cell { return r.explored ? "explored, not shown" : ""; }},
      {"session", "session", "", "count", [](C r) -> Cell { return static_cast<double>(r.session); }}};
  return columns;
}

const std::vector<ShownColumn<LimitRow>>& limit_columns() {
  using C = const LimitRow&;
  static const std::vector<ShownColumn<LimitRow>> columns{
      {"problem", "problem", "", "text", [](C r) -> Cell { return title_of(r.point.problem); }},
      {"material", "material", "", "text", [](C r) -> Cell { return r.point.material; }},
      {"state_kind", "near", "", "text", [](C r) -> Cell { return r.state_kind; }},
      {"method", "method", "", "text", [](C r) -> Cell { return r.method; }},
      {"h_max", "predicted", "ms", "number", [](C r) -> Cell { return in_ms(r.h_max); }},
      {"observed", "observed", "ms", "number", [](C r) -> Cell { return in_ms(r.observed); }},
      {"gap", "gap", "%", "number", [](C r) -> Cell { return in_percent(r.gap); }},
      {"verdict", "verdict", "", "text", [](C r) -> Cell { return r.verdict; }},
      {"bound", "limited by", "", "text", [](C r) -> Cell { return r.bound; }},
      {"omega", "omega", "rad/s", "number", [](C r) -> Cell { return r.omega; }},
      {"zeta", "zeta", "", "number", [](C r) -> Cell { return r.zeta; }},
      {"h_unstable", "unstable from", "ms", "number", [](C r) -> Cell { return in_ms(r.h_unstable); }},
      {"newton_h", "solved up to", "ms", "number", [](C r) -> Cell { return in_ms(r.newton_h); }},
      {"along_least", "necessary along the path", "ms", "number",
       [](C r) -> Cell { return in_ms(r.along_least); }},
      {"safe", "safe", "ms", "number", [](C r) -> Cell { return in_ms(r.safe()); }},
      {"steps_used", "steps of a run", "", "count", [](C r) -> Cell { return r.steps_used; }},
      {"note", "remark", "", "long", [](C r) -> Cell { return r.note; }},
      {"state", "state", "", "long", [](C r) -> Cell { return r.state; }},
      {"parameters", "parameters", "", "long", [](C r) -> Cell { return r.point.parameters; }},
      {"session", "session", "", "count", [](C r) -> Cell { return static_cast<double>(r.session); }}};
  return columns;
}

const std::vector<ShownColumn<AdviceRecord>>& advice_columns() {
  using C = const AdviceRecord&;
  static const std::vector<ShownColumn<AdviceRecord>> columns{
      {"problem", "problem", "", "text", [](C r) -> Cell { return title_of(r.key.problem); }},
      {"rate", "rate", "Hz", "number", [](C r) -> Cell { return r.key.rate; }},
      {"method", "method", "", "text", [](C r) -> Cell { return r.words(); }},
      {"verdict", "verdict", "", "text", [](C r) -> Cell { return r.verdict; }},
      {"h", "h", "ms", "number", [](C r) -> Cell { return in_ms(r.h); }},
      {"steps", "steps per frame", "", "count", [](C r) -> Cell { return r.steps_per_frame; }},
      {"error", "error", "%", "number", [](C r) -> Cell { return in_percent(r.error); }},
      {"p50", "frame, median", "ms", "number", [](C r) -> Cell { return in_ms(r.frame_p50); }},
      {"p99", "frame, 99 %", "ms", "number", [](C r) -> Cell { return in_ms(r.frame_p99); }},
      {"max", "frame, maximum", "ms", "number", [](C r) -> Cell { return in_ms(r.frame_max); }},
      {"h_max", "limit predicted", "ms", "number", [](C r) -> Cell { return in_ms(r.h_max); }},
      {"observed", "limit observed", "ms", "number", [](C r) -> Cell { return in_ms(r.h_max_observed); }},
      {"bound", "limited by", "", "text", [](C r) -> Cell { return r.bound; }},
      {"frames", "frames", "", "count", [](C r) -> Cell { return r.frames; }},
      {"missed", "late frames", "", "count", [](C r) -> Cell { return r.missed; }},
      {"first", "first frame", "ms", "number", [](C r) -> Cell { return in_ms(r.first_frame); }},
      {"newton", "Newton iterations per frame", "", "count", [](C r) -> Cell { return r.newton_per_frame; }},
      {"linear", "CG iterations per frame", "", "count", [](C r) -> Cell { return r.linear_per_frame; }},
      {"memory", "memory", "MB", "number", [](C r) -> Cell { return r.memory / 1e6; }},
      {"stiffening", "margin of stiffness", "", "number", [](C r) -> Cell { return r.stiffening; }},
      {"material", "material", "", "text", [](C r) -> Cell { return r.key.material; }},
      {"tolerance", "tolerance", "%", "number", [](C r) -> Cell { return in_percent(r.key.tolerance); }},
      {"budget", "budget", "ms", "number", [](C r) -> Cell { return in_ms(r.key.budget); }},
      {"tail", "frame times", "s", "list", [](C r) -> Cell { return r.frame_tail; }},
      {"status", "remark", "", "long", [](C r) -> Cell { return r.status; }},
      {"parameters", "parameters", "", "long", [](C r) -> Cell { return r.key.parameters; }},
      {"session", "session", "", "count", [](C r) -> Cell { return static_cast<double>(r.session); }}};
  return columns;
}

/// Number of each text in the order of first use.
class Words {
 public:
  std::size_t number(const std::string& text) {
    const auto [at, added] = numbers_.emplace(text, texts_.size());
    if (added) texts_.push_back(text);
    return at->second;
  }
  [[nodiscard]] const std::vector<std::string>& texts() const { return texts_; }

 private:
  std::map<std::string, std::size_t> numbers_;
  std::vector<std::string> texts_;
};

/// Six significant digits are enough for a page, and keep it small.
Json json_of(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return to_number(fmt::format("{:.6g}", value)).value_or(value);
}

/// What is shown in one figure: equal names of different models are told apart by a number.
class Cases {
 public:
  /// @param model  what tells models of one name apart
  std::size_t number(const std::string& name, const std::string& model) {
    std::vector<std::string>& models = models_[name];
    auto found = std::ranges::find(models, model);
    if (found == models.end()) found = models.insert(models.end(), model);
    const auto place = found - models.begin();
    return words_.number(place == 0 ? name : fmt::format("{} ({})", name, place + 1));
  }
  [[nodiscard]] const std::vector<std::string>& texts() const { return words_.texts(); }

 private:
  std::map<std::string, std::vector<std::string>> models_;
  Words words_;
};

const std::string& method_of(const Row& row) { return row.key.method; }
const std::string& method_of(const LimitRow& row) { return row.method; }
const std::string& method_of(const AdviceRecord& row) { return row.method; }

std::string label_of(const Row& row) {
  std::string label = row.key.method;
  if (row.key.mode == "sampled") label += ", sampled at rtol " + to_text(row.key.rtol);
  if (row.key.mode == "adaptive") label += ", adaptive";
  if (!row.key.control.empty() && row.key.control != "none" && row.key.control != "own")
    label += ", " + row.key.control;
  if (is_on_device(row)) label += " on " + row.key.device;
  return label;
}
std::string label_of(const LimitRow& row) { return row.method; }
std::string label_of(const AdviceRecord& row) { return row.words(); }

std::string named(const std::string& problem, const std::string& material) {
  return title_of(problem) + (material.empty() ? "" : ", " + material);
}

std::size_t case_of(const Row& row, Cases& cases) {
  return cases.number(
      fmt::format("{}, to {} s", named(row.key.problem, row.key.material), to_text(row.key.t_end)),
      row.key.parameters + "\n" + row.key.y0);
}
std::size_t case_of(const LimitRow& row, Cases& cases) {
  const OperatingPointKey& key = row.point;
  return cases.number(
      fmt::format("{}, near {}", named(key.problem, key.material), row.state_kind),
      key.parameters + "\n" + key.y0 + "\n" + key.model + "\n" + key.path + "\n" + to_text(key.t_end));
}
std::size_t case_of(const AdviceRecord& row, Cases& cases) {
  const AdviceKey& key = row.key;
  return cases.number(fmt::format("{} at {} Hz", named(key.problem, key.material), to_text(key.rate)),
                      key.parameters + "\n" + key.y0 + "\n" + key.model + "\n" + key.motion + "\n" +
                          key.ranked_by + "\n" + to_text(key.tolerance) + "\n" + to_text(key.budget));
}

/// Curves: one for each label, and with several stores for each store.
class Series {
 public:
  std::size_t number(const std::string& label, const std::string& method) {
    const auto [at, added] = numbers_.emplace(label, list_.size());
    if (added)
      list_.push_back(
          {{"label", label}, {"method", methods_.number(method)}, {"variant", variants_[method]++}});
    return at->second;
  }
  [[nodiscard]] const Json& list() const { return list_; }

 private:
  Words methods_;
  std::map<std::string, std::size_t> numbers_;
  std::map<std::string, int> variants_;
  Json list_ = Json::array();
};

/// Names without folder and ending; whole names where those are not unique.
std::vector<std::string> short_names(std::span<const ReportedStore> stores) {
  std::vector<std::string> names;
  for (const ReportedStore& store : stores)
    names.push_back(std::filesystem::path(store.name).stem().string());
  if (std::set<std::string>(names.begin(), names.end()).size() < names.size())
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = stores[i].name;
  return names;
}

/// Everything that tables share.
struct Shared {
  std::span<const ReportedStore> stores;
  std::size_t most_rows;
  std::vector<std::string> short_names;  ///< of the stores
  Words words = {};
  Cases cases = {};
  Series series = {};
  std::size_t left_out = 0;
};

template <class Record>
Json row_of(const Record& record, const std::vector<ShownColumn<Record>>& columns, Json row, Words& words) {
  for (const ShownColumn<Record>& column : columns) {
    const Cell cell = column.of(record);
    if (const auto* text = std::get_if<std::string>(&cell))
      row.push_back(words.number(*text));
    else
      row.push_back(json_of(std::get<double>(cell)));
  }
  return row;
}

/// Appends the table when a store has rows for it.
template <class Record>
void add_table(Json& tables, std::string_view id, const char* title, const std::vector<std::string>& tips,
               const std::vector<ShownColumn<Record>>& columns, std::vector<Record> ReportedStore::*records,
               Shared& shared) {
  const bool several =
      std::ranges::count_if(shared.stores, [&](const auto& store) { return !(store.*records).empty(); }) > 1;
  Json rows = Json::array();
  for (std::size_t s = 0; s < shared.stores.size(); ++s) {
    const std::vector<Record>& all = shared.stores[s].*records;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (rows.size() == shared.most_rows) {
        shared.left_out += all.size() - i;
        break;
      }
      const std::string label = label_of(all[i]) + (several ? " (" + shared.short_names[s] + ")" : "");
      const std::size_t series = shared.series.number(label, method_of(all[i]));
      rows.push_back(row_of(all[i], columns, Json::array({s, i + 1, series, case_of(all[i], shared.cases)}),
                            shared.words));
    }
  }
  if (rows.empty()) return;
  Json headings = Json::array();
  for (const ShownColumn<Record>& column : columns)
    headings.push_back({HMAX_KEYS(column, key, name, unit, form)});
  tables.push_back({{"id", id},
                    {"title", title},
                    {"tips", tips},
                    {"columns", std::move(headings)},
                    {"rows", std::move(rows)}});
}

Json figure(const char* id, std::string_view table, const char* title, const char* words, const char* x,
            const char* y, const char* x_label, const char* y_label) {
  return {{"id", id},
          {"table", table},
          {"title", title},
          {"words", words},
          {"x", x},
          {"y", y},
          {"labels", {{"x", x_label}, {"y", y_label}}},
          {"lines", Json::array()},
          {"join", false},
          {"strip", false},
          {"diagonal", false},
          {"whole", false}};
}

Json line(const char* axis, const char* key, const char* label) {
  return {{"axis", axis}, {"key", key}, {"label", label}};
}

/// One of the numbers of a range.
Json mark(const char* key, const char* label, const char* shape) {
  return {{"key", key}, {"label", label}, {"mark", shape}};
}

Json advice_figures() {
  Json frames = figure("frame_times", advice_table, "Frame times",
                       "CPU time of a frame: the recommended method is in bold.", "p50", "p99",
                       "CPU time of a frame [ms]", "");
  frames["range"] = {mark("p50", "median", "circle"), mark("p99", "99 %", "bar"),
                     mark("max", "maximum", "diamond")};
  frames["missing"] = "not timed";
  frames["lines"].push_back(line("x", "budget", "budget"));
  Json tail =
      figure("frame_tail", advice_table, "Distribution of frame times",
             "Share of the frames that take longer. Curves of fewer than a thousand frames end earlier.",
             "p50", "p99", "CPU time of a frame [ms]", "frames that take longer [%]");
  tail["shares"] = {{"key", "tail"}, {"of", frame_shares}};
  tail["join"] = true;
  tail["lines"].push_back(line("x", "budget", "budget"));
  Json steps = figure(
      "steps_and_limits", advice_table, "Steps and their limits",
      "Predicted limits are the smallest of the linearised model along the motion; observed ones are of runs on it.",
      "h", "h_max", "time step [ms]", "");
  steps["range"] = {mark("h", "step", "circle"), mark("h_max", "limit, predicted", "bar"),
                    mark("observed", "limit, observed", "diamond")};
  steps["missing"] = "without a limit";
  Json errors =
      figure("advice_error", advice_table, "Error and frame time",
             "Rows to the left of the budget and below the tolerance meet the question, if they are stable.",
             "p50", "error", "CPU time of a frame, median [ms]", "error [%]");
  errors["strip"] = true;
  errors["lines"] = {line("x", "budget", "budget"), line("y", "tolerance", "tolerance")};
  return Json::array({errors, frames, tail, steps});
}

/// @param key, label  of the time
Json work_precision(bool on_device, const char* id, const char* title, const char* words, const char* key,
                    const char* label) {
  Json precision = figure(id, runs_table, title, words, "error", key, "largest error", label);
  precision["join"] = true;
  precision["best"] = {"error", key};
  precision["on_device"] = on_device;
  return precision;
}

/// Times of devices and CPU times never share a figure.
Json run_figures(bool has_cpu_times, bool has_device_times) {
  Json figures = Json::array();
  if (has_cpu_times)
    figures.push_back(work_precision(
        false, "work_precision", "Work-precision diagram",
        "Median CPU time of a run against its largest error, in the unit of the state. A curve further to the left "
        "and below is more accurate and faster.",
        "cpu", "CPU time [ms]"));
  if (has_device_times)
    figures.push_back(
        work_precision(true, "device_work_precision", "Work-precision diagram of devices",
                       "Median time of a run by the clock of its device against its largest error.",
                       "device_time", "device time [ms]"));
  Json steps = figure(
      "time_steps", runs_table, "Error and time step",
      "With adaptive steps the time step is the mean of the accepted ones. Runs that have no error, such as those that diverged, are in "
      "the grey strip.",
      "step", "error", "time step [ms]", "largest error");
  steps["join"] = true;
  steps["strip"] = true;
  if (figures.size() == 1) steps["best"] = figures.front().at("best");  // else none is best of both
  figures.push_back(std::move(steps));
  return figures;
}

Json limit_figures() {
  Json both = figure(
      "limits", limits_table, "Predicted and observed limits",
      "Marks on the dashed line are limits that runs confirm exactly. They hold for small motions about the state that a row names.",
      "h_max", "observed", "largest stable step, predicted [ms]", "observed [ms]");
  both["diagonal"] = true;
  both["whole"] = true;
  Json gaps = figure(
      "gaps", limits_table, "Gap between prediction and observation",
      "Difference of the observed from the predicted limit, without its sign, as a share of the predicted limit.",
      "h_max", "gap", "largest stable step, predicted [ms]", "gap [%]");
  gaps["whole"] = true;
  return Json::array({both, gaps});
}

}  // namespace

bool has_cpu_times(const Row& row) { return !row.explored && !is_on_device(row); }

ReportData report_data(std::span<const ReportedStore> stores, std::size_t most_rows) {
  Shared shared{stores, most_rows, short_names(stores)};
  Json tables = Json::array(), figures = Json::array(), names = Json::array();
  const auto add = [&](const auto& columns, auto records, std::string_view id, const char* title,
                       const std::vector<std::string>& tips, const Json& its_figures) {
    const std::size_t before = tables.size();
    add_table(tables, id, title, tips, columns, records, shared);
    if (tables.size() > before) figures.insert(figures.end(), its_figures.begin(), its_figures.end());
  };
  add(advice_columns(), &ReportedStore::advice, advice_table, "Advice",
      {"h", "steps", "h_max", "observed", "error", "p50", "p99", "max", "verdict"}, advice_figures());
  const auto has_run = [&](bool (*is)(const Row&)) {
    return std::ranges::any_of(
        stores, [&](const ReportedStore& store) { return std::ranges::any_of(store.runs, is); });
  };
  add(run_columns(), &ReportedStore::runs, runs_table, "Runs",
      {"problem", "h", "rtol", "error", "cpu", "device_time", "outcome"},
      run_figures(has_run(has_cpu_times), has_run(is_on_device)));
  add(limit_columns(), &ReportedStore::limits, limits_table, "Limits",
      {"problem", "material", "h_max", "observed", "gap", "verdict"}, limit_figures());
  for (const ReportedStore& store : stores) names.push_back(store.name);
  const Json document{{"stores", std::move(names)},    {"words", shared.words.texts()},
                      {"cases", shared.cases.texts()}, {"series", shared.series.list()},
                      {"tables", std::move(tables)},   {"figures", std::move(figures)}};
  const std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  ReportData data{"", shared.left_out};
  for (const char c : text) data.json += c == '<' ? "\\u003c" : std::string(1, c);
  return data;
}

}  // namespace hmax
