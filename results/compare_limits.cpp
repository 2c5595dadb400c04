#include "results/compare_limits.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "core/numbers.hpp"

namespace hmax {

namespace {

/// By all that tells limits apart but the digest of the model; the ends of motions and the starts are part of
/// it.
std::map<std::string, const LimitRow*> by_name(std::span<const LimitRow> rows) {
  std::map<std::string, const LimitRow*> named;
  for (const LimitRow& row : rows) {
    const std::string key =
        fmt::format("{}\n{}\n{}", limit_name(row), row.point.y0, to_text(row.point.t_end));
    const LimitRow*& kept = named[key];
    if (!kept || row.session >= kept->session) kept = &row;
  }
  return named;
}

bool differs(double a, double b, double tolerance) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
  if (a == b) return false;
  return !(std::abs(a - b) <= tolerance * std::max(std::abs(a), std::abs(b)));
}

std::vector<std::string> changes_between(const LimitRow& a, const LimitRow& b) {
  std::vector<std::string> changes;
  const auto add = [&](const char* name, const std::string& before, const std::string& after) {
    changes.push_back(fmt::format("{}: {} -> {}", name, before, after));
  };
  if (a.bound != b.bound) add("bound", a.bound, b.bound);
  if (a.state_kind != b.state_kind) add("state_kind", a.state_kind, b.state_kind);
  // One of the stores may not have asked for runs.
  if (a.is_observed() && b.is_observed() && a.verdict != b.verdict) add("verdict", a.verdict, b.verdict);
  const auto compare = [&](const char* name, double before, double after, double tolerance) {
    if (differs(before, after, tolerance)) add(name, to_text(before), to_text(after));
  };
  compare("h_max", a.h_max, b.h_max, 1e-6);
  compare("h_unstable", a.h_unstable, b.h_unstable, 1e-6);
  compare("along_least", a.along_least, b.along_least, 1e-6);
  if (!std::isnan(a.from_start_stride) && !std::isnan(b.from_start_stride))
    compare("from_start", a.from_start, b.from_start, 1e-3);
  if (a.is_observed() && b.is_observed()) compare("observed", a.observed, b.observed, 1e-3);
  return changes;
}

}  // namespace

std::string limit_name(const LimitRow& row) {
  const OperatingPointKey& point = row.point;
  std::string name = point.problem;
  for (const std::string& part : {point.material, point.parameters, point.asked, point.path, row.method})
    if (!part.empty()) name += "/" + part;
  return name;
}

LimitComparison compare_limits(std::span<const LimitRow> a, std::span<const LimitRow> b) {
  LimitComparison comparison;
  const auto named_a = by_name(a), named_b = by_name(b);
  for (const auto& [key, row] : named_a) {
    const auto other = named_b.find(key);
    if (other == named_b.end()) {
      comparison.only_in_a.push_back(limit_name(*row));
      continue;
    }
    ++comparison.compared;
    if (auto changes = changes_between(*row, *other->second); !changes.empty())
      comparison.changed.push_back({limit_name(*row), std::move(changes)});
  }
  for (const auto& [key, row] : named_b)
    if (!named_a.contains(key)) comparison.only_in_b.push_back(limit_name(*row));
  return comparison;
}

}  // namespace hmax
