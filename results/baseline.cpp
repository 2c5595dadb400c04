#include "results/baseline.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "results/fields.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

constexpr const char* header =
    "problem,method,setting,outcome,error_end,error_samples,steps,rejected,rhs,jacobian,factorisations,"
    "newton";

constexpr std::array<std::pair<const char*, std::int64_t AccuracyRow::*>, 6> counts{
    {HMAX_FIELDS(AccuracyRow, steps, rejected, rhs, jacobian, factorisations, newton)}};
constexpr std::array<std::pair<const char*, double AccuracyRow::*>, 2> errors{
    {HMAX_FIELDS(AccuracyRow, error_end, error_samples)}};

AccuracyRow parse_row(const std::string& line, const std::string& where) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  const auto broken = [&](const std::string& why) {
    return InputError(fmt::format("{}: {}; rewrite the file with `hmax check --update`", where, why));
  };
  if (cells.size() != 4 + errors.size() + counts.size())
    throw broken(fmt::format("{} cells instead of {}", cells.size(), 4 + errors.size() + counts.size()));
  AccuracyRow row{.problem = cells[0], .method = cells[1], .setting = cells[2], .outcome = cells[3]};
  std::size_t next = 4;
  for (const auto& [name, member] : errors) {
    const auto value = to_number(cells[next]);
    if (!value) throw broken(fmt::format("{} is '{}', which is no number", name, cells[next]));
    row.*member = *value;
    ++next;
  }
  for (const auto& [name, member] : counts) {
    const auto value = to_number(cells[next]);
    if (!value || !(std::abs(*value) < 9e15))
      throw broken(fmt::format("{} is '{}', which is no count", name, cells[next]));
    row.*member = static_cast<std::int64_t>(*value);
    ++next;
  }
  return row;
}

/// Whether two errors differ by more than rounding may do.
bool differ(double before, double now) {
  if (std::isnan(before) || std::isnan(now)) return std::isnan(before) != std::isnan(now);
  return !(std::abs(now - before) <= 1e-6 * std::abs(before) + 1e-13);
}

}  // namespace

std::string AccuracyRow::name() const { return fmt::format("{} {} {}", problem, method, setting); }

std::vector<AccuracyRow> read_baseline(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in)
    throw InputError(fmt::format(
        "the baseline '{}' cannot be read; run this in the source folder of hmax, name it with --baseline, or write it with --update",
        file.string()));
  std::vector<AccuracyRow> rows;
  std::int64_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty() || line == header) continue;
    rows.push_back(parse_row(line, fmt::format("{}:{}", file.string(), number)));
  }
  return rows;
}

void write_baseline(const std::filesystem::path& file, const std::vector<AccuracyRow>& rows) {
  std::string text = fmt::format("{}\n", header);
  for (const AccuracyRow& row : rows) {
    text += fmt::format("{},{},{},{}", row.problem, row.method, row.setting, row.outcome);
    for (const auto& [name, member] : errors) text += fmt::format(",{}", to_text(row.*member));
    for (const auto& [name, member] : counts) text += fmt::format(",{}", row.*member);
    text += '\n';
  }
  write_file(file, text, header);
}

AccuracyComparison compare(const std::vector<AccuracyRow>& baseline, const std::vector<AccuracyRow>& now) {
  AccuracyComparison result;
  std::map<std::string, const AccuracyRow*> known;
  for (const AccuracyRow& row : baseline) known[row.name()] = &row;
  for (const AccuracyRow& row : now) {
    const auto it = known.find(row.name());
    if (it == known.end()) {
      result.added.push_back(row.name());
      continue;
    }
    const AccuracyRow& before = *it->second;
    ++result.compared;
    const auto changed = [&](const char* what, const std::string& old_value, const std::string& new_value) {
      result.changed.push_back({row.name(), what, old_value, new_value});
    };
    if (before.outcome != row.outcome) changed("outcome", before.outcome, row.outcome);
    for (const auto& [name, member] : errors)
      if (differ(before.*member, row.*member)) changed(name, to_text(before.*member), to_text(row.*member));
    for (const auto& [name, member] : counts)
      if (before.*member != row.*member)
        changed(name, std::to_string(before.*member), std::to_string(row.*member));
    known.erase(it);
  }
  for (const AccuracyRow& row : baseline)
    if (known.contains(row.name())) result.missing.push_back(row.name());
  return result;
}

}  // namespace hmax
