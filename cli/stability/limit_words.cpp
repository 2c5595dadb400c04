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
  using R = const LimitRow&;
  std::vector<std::string> header;
  std::vector<std::string (*)(R)> cells;
  const auto show = [&](bool shown, const char* heading, std::string (*cell)(R)) {
    if (!shown) return;
    header.emplace_back(heading);
    cells.push_back(cell);
  };
  const auto any = [&](const auto& holds) { return std::ranges::any_of(rows, holds); };
  const bool mixed = any([&](R row) { return row.state_kind != rows.front().state_kind; });
  const bool solves = any([](R row) { return !row.newton.empty(); });
  const bool path = !columns.path.empty();
  show(true, "method", [](R row) { return row.method; });
  show(true, "material", [](R row) { return row.point.material.empty() ? "-" : row.point.material; });
  show(mixed, "at", [](R row) { return row.state_kind; });
  show(true, "h_max [s]", [](R row) { return step_words(row.h_max, 7); });
  show(true, "limited by", [](R row) { return row.bound; });
  show(true, "omega [rad/s]", [](R row) { return number_or_dash(row.omega); });
  show(true, "zeta", [](R row) { return std::isnan(row.zeta) ? "-" : short_number(0.0 + row.zeta); });
  show(any(has_real_limiting_mode), "rates [1/s]", words_of_rates);
  show(solves, "solved up to [s]", [](R row) {
    return row.newton.empty() ? "-" : (row.newton == "limit" ? "" : "> ") + short_number(row.newton_h, 3);
  });
  show(solves, "error there [mm]", [](R row) { return number_or_dash(1000 * row.newton_error, 3); });
  show(columns.verified, "observed [s]", words_of_observed);
  show(columns.verified, "gap", [](R row) { return std::isfinite(row.gap) ? percents(row.gap) : "-"; });
  show(columns.verified, "steps",
       [](R row) { return row.is_observed() ? fmt::format("{:.0f}", row.steps_used) : "-"; });
  show(path, "necessary [s]", [](R row) { return step_words(row.along_least, 7); });
  show(path, columns.path == "load" ? "at share [1]" : "at t [s]",
       [](R row) { return std::isfinite(row.along_least) ? short_number(row.along_at, 4) : "-"; });
  show(columns.safe, "safe [s]", [](R row) {
    return (std::isinf(row.from_start) && row.safe() == row.longest_run() ? "> " : "") +
           step_words(row.safe(), 7);
  });
  TextTable table(std::move(header));
  for (const LimitRow& row : rows) {
    std::vector<std::string> line;
    for (const auto cell : cells) line.push_back(cell(row));
    table.add(std::move(line));
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
