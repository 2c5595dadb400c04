#include "studies/limit_study.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "catalogue/models/problems.hpp"
#include "core/parallel_for.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "limits/rows/limit_rows.hpp"
#include "limits/verification.hpp"
#include "problems/oscillator/liver_materials.hpp"
#include "problems/oscillator/liver_problems.hpp"
#include "studies/liver_claims.hpp"

namespace hmax {

namespace {

/// The limit of a small motion about the equilibrium, verified; of a nonlinear case also the least along the
/// motion from the published start, and the one that runs from there show.
LimitRow limit_of(const LimitCase& each, const Linearised& near, const MotionSize& size,
                  const Method& method) {
  const Problem& problem = each.problem;
  Prediction prediction = predict(method, near);
  verify(prediction, method, problem, near);
  LimitRow row = limit_row(prediction, true);
  row.details = "{}";
  if (each.linear) return row;
  const auto along = limit_along(method, problem, problem.t_end);
  if (along) add_path(row, *along, "");
  row.from_start_stride = 0;
  const double guess = guess_from_start(row.along_least, row.h_max, problem.t_end);
  if (const auto start = limit_from_start(method, problem, problem.t_end, guess, size))
    add_start(row, *start);
  return row;
}

/// What every method is asked about one case.
struct AskedCase {
  std::size_t which;
  Linearised near;
  MotionSize size;
  OperatingPointKey key;
};

std::vector<AskedCase> asked_cases(const std::vector<LimitCase>& cases, CaseKind kind) {
  std::vector<AskedCase> asked;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const bool linear = cases[i].linear;
    if (linear != (kind == CaseKind::linear)) continue;
    const Problem& problem = cases[i].problem;
    asked.push_back({i, linearised(problem), linear ? MotionSize{} : size_of_motion(problem, problem.t_end),
                     operating_point_key(problem, AskedState::equilibrium, linear ? "" : "motion",
                                         linear ? 0 : problem.t_end)});
  }
  return asked;
}

/// What tells cases from others in which the same number varies.
std::string kind_of(const OscillatorParameters& p) {
  if (p.k3 != 0) return p.P == 0 ? "unforced, " : "forced, ";
  const double zeta = p.c / (2 * std::sqrt(p.k1 * p.m));
  return zeta > 1 + 1e-9 ? "over-damped, " : zeta > 1 - 1e-9 ? "critically damped, " : "";
}

void keep(Store& store, const std::vector<AskedCase>& asked, const std::vector<StudyRow>& computed) {
  if (computed.empty()) return;
  store.begin_session(fingerprint());
  for (const AskedCase& each : asked) {
    OperatingPointRow point;
    point.key = each.key;
    point.document = nlohmann::ordered_json{{"state", each.near.point.state},
                                            {"state_kind", name_of(each.near.point.kind)}}
                         .dump();
    std::vector<LimitRow> own;
    for (const StudyRow& row : computed)
      if (row.which == each.which) own.push_back(row.limit);
    if (!own.empty()) store.insert_limits(point, own);
  }
}

}  // namespace

std::vector<LimitCase> limit_cases() {
  std::vector<LimitCase> cases;
  for (const LiverMaterial& material : liver_materials())
    for (const char* end : {":light", ":heavy"}) {
      const std::string id = std::string(material.id) + end;
      cases.push_back({id, "benchmark liver", make_problem("liver_benchmark", {.material = id}), true});
    }
  std::vector<OscillatorParameters> seen;
  for (const LiverFamily& family : liver_families()) {
    // Figure 1 is about time, figure 8 about the materials.
    if (family.figure < 2 || family.figure > 7) continue;
    for (const LiverFamilyMember& member : family.members) {
      const OscillatorParameters& p = member.parameters;
      if (std::ranges::find(seen, p) != seen.end()) continue;
      seen.push_back(p);
      const bool linear = p.k3 == 0;
      cases.push_back(
          {kind_of(p) + member.label, std::string(family.id), forced_liver(p, family.y0), linear});
      cases.back().problem.t_end = family.t_end;
    }
  }
  return cases;
}

std::vector<StudyRow> limit_study(const std::vector<LimitCase>& cases, CaseKind kind,
                                  const std::vector<Method>& methods, Store* store,
                                  const std::function<void(double)>& progress,
                                  const std::function<bool()>& interrupted, Shard shard) {
  const std::vector<AskedCase> asked = asked_cases(cases, kind);
  struct Pair {
    const AskedCase* asked;
    const Method* method;
    std::optional<LimitRow> row;
    bool computed = false;
  };
  std::vector<Pair> pairs;
  std::vector<std::size_t> missing;
  int number = 0;  // of a row: neighbours, which cost alike, are in different shards
  for (const AskedCase& each : asked) {
    const WantedLimit wanted{.verified = true, .from_start = kind == CaseKind::nonlinear};
    const std::vector<LimitRow> known =
        store ? stored_limits(*store, each.key, wanted) : std::vector<LimitRow>{};
    for (const Method& method : methods) {
      if (!suits(method, cases[each.which].problem) || number++ % shard.count != shard.index - 1) continue;
      const auto found = std::ranges::find(known, method.id, &LimitRow::method);
      if (found == known.end()) missing.push_back(pairs.size());
      pairs.push_back({&each, &method, found == known.end() ? std::nullopt : std::optional(*found)});
    }
  }
  parallel_for(
      missing.size(),
      [&](std::size_t i, std::size_t) {
        Pair& pair = pairs[missing[i]];
        const AskedCase& each = *pair.asked;
        LimitRow row = limit_of(cases[each.which], each.near, each.size, *pair.method);
        row.point = each.key;
        pair.row = std::move(row);
        pair.computed = true;
      },
      [&](std::size_t done) { progress(static_cast<double>(done) / static_cast<double>(missing.size())); },
      interrupted);

  std::vector<StudyRow> rows, computed;
  for (const Pair& pair : pairs)
    if (pair.row) {
      rows.push_back({pair.asked->which, *pair.row});
      if (pair.computed) computed.push_back(rows.back());
    }
  if (store) keep(*store, asked, computed);
  return rows;
}

}  // namespace hmax
