#include "cli/stability/limit_words.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "limits/documents/limit_json.hpp"
#include "limits/point/prediction.hpp"

namespace hmax {

namespace {

std::string number_or_dash(double value, int digits = 6) {
  return std::isfinite(value) ? short_number(value, digits) : "-";
}

/// "+0.0012 %"; without a sign what rounds to nothing.
std::string percents(double share) {
  const std::string text = fmt::format("{:+.4f} %", 100 * share);
  return text.find_first_of("123456789") == std::string::npos ? text.substr(1) : text;
}

bool has_real_limiting_mode(const LimitRow& row) { return row.im == 0; }

/// The decay rates of a mode that does not oscillate; negative where it grows.
std::string words_of_rates(const LimitRow& row) {
  if (!has_real_limiting_mode(row)) return "-";
  if (std::isnan(row.rate_fast)) return short_number(-row.re);
  return fmt::format("{} and {}", short_number(row.rate_fast), short_number(row.rate_slow));
}

std::string words_of_observed(const LimitRow& row) {
  if (!row.is_observed()) return "-";
  return std::isnan(row.observed) ? "grows" : step_words(row.observed, 7);
}

}  // namespace

std::string step_words(double h, int digits) {
  return std::isnan(h) ? "-" : std::isinf(h) ? "unbounded" : short_number(h, digits);
}

std::string limit_table(std::span<const LimitRow> rows, const LimitColumns& columns, const Console& console) {
  std::vector<std::string> header{"method", "material", "h_max [s]", "limited by", "omega [rad/s]", "zeta"};
  // Where they are not all of one kind.
  const bool names_states = std::ranges::any_of(
      rows, [&](const LimitRow& row) { return row.state_kind != rows.front().state_kind; });
  if (names_states) header.insert(header.begin() + 2, "at");
  const bool solves = std::ranges::any_of(rows, [](const LimitRow& row) { return !row.newton.empty(); });
  const bool any_real = std::ranges::any_of(rows, has_real_limiting_mode);
  if (any_real) header.emplace_back("rates [1/s]");
  if (solves) header.insert(header.end(), {"solved up to [s]", "error there [mm]"});
  if (columns.verified) header.insert(header.end(), {"observed [s]", "gap", "steps"});
  if (!columns.path.empty())
    header.insert(header.end(), {"necessary [s]", columns.path == "load" ? "at share [1]" : "at t [s]"});
  if (columns.safe) header.emplace_back("safe [s]");
  TextTable table(std::move(header));
  for (const LimitRow& row : rows) {
    std::vector<std::string> cells{row.method,
                                   row.point.material.empty() ? "-" : row.point.material,
                                   step_words(row.h_max, 7),
                                   row.bound,
                                   number_or_dash(row.omega),
                                   std::isnan(row.zeta) ? "-" : short_number(0.0 + row.zeta)};
    if (names_states) cells.emplace(cells.begin() + 2, row.state_kind);
    if (any_real) cells.push_back(words_of_rates(row));
    if (solves) {
      cells.push_back(
          row.newton.empty() ? "-" : (row.newton == "limit" ? "" : "> ") + short_number(row.newton_h, 3));
      cells.push_back(number_or_dash(1000 * row.newton_error, 3));
    }
    if (columns.verified) {
      cells.push_back(words_of_observed(row));
      cells.push_back(std::isfinite(row.gap) ? percents(row.gap) : "-");
      cells.push_back(!row.is_observed() ? "-" : fmt::format("{:.0f}", row.steps_used));
    }
    if (!columns.path.empty()) {
      cells.push_back(step_words(row.along_least, 7));
      cells.push_back(std::isfinite(row.along_least) ? short_number(row.along_at, 4) : "-");
      if (columns.safe)
        cells.push_back((std::isinf(row.from_start) && row.safe() == row.longest_run() ? "> " : "") +
                        step_words(row.safe(), 7));
    }
    table.add(std::move(cells));
  }
  return table.text(console);
}

std::string words_of_notes(std::span<const LimitRow> rows) {
  struct Said {
    std::string note, material;
    std::vector<std::string> methods;
  };
  std::vector<Said> all;
  for (const LimitRow& row : rows) {
    if (row.note.empty() || row.bound == name_of(Bound::error_control)) continue;
    const auto same = std::ranges::find_if(
        all, [&](const Said& said) { return said.note == row.note && said.material == row.point.material; });
    if (same == all.end())
      all.push_back({row.note, row.point.material, {row.method}});
    else
      same->methods.push_back(row.method);
  }
  std::string text;
  for (const auto& [note, material, methods] : all)
    text +=
        fmt::format("{}{}: {}\n", fmt::join(methods, ", "), material.empty() ? "" : ", " + material, note);
  return text;
}

std::string words_of_paths(std::span<const LimitRow> rows) {
  std::string remarks, said;
  for (const LimitRow& row : rows) {
    std::string words = words_of_growth(row);
    if (!words.empty()) words += "\n";
    if (!row.path_note.empty()) words += row.path_note + "\n";
    if (words.empty() || words == said) continue;
    remarks += row.point.material.empty() ? words : row.point.material + ": " + words;
    said = words;
  }
  return remarks;
}

std::string words_of_safe(std::span<const LimitRow> rows) {
  double longest = 0;
  std::vector<std::string> below;
  for (const LimitRow& row : rows) {
    if (row.from_start_stride > longest) longest = row.from_start_stride;
    if (row.from_start < 0.99 * row.along_least)
      below.push_back(fmt::format("{} beyond {} s", row.method, short_number(row.from_start, 7)));
  }
  if (longest == 0) return {};
  return fmt::format(
             "safe: at most what is necessary, and no run with this step or a shorter one gets farther from the motion than "
             "three times its size, tried in strides of at most {} %, between which narrower windows may lie\n",
             short_number(100 * longest, 2)) +
         (below.empty()
              ? ""
              : fmt::format("leaves the motion below what is necessary: {}\n", fmt::join(below, ", ")));
}

}  // namespace hmax
