#include "studies/limit_study.hpp"

#include <algorithm>
#include <cmath>

#include "catalogue/models/problems.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "limits/query/query_limits.hpp"
#include "problems/oscillator/liver_materials.hpp"
#include "problems/oscillator/liver_problems.hpp"
#include "studies/liver_claims.hpp"

namespace hmax {

namespace {

/// What is asked of a case: the limit of a small motion about the equilibrium, verified; of a nonlinear one
/// also the least along the motion from the published start, and the one that runs from there show.
LimitQuestion question_of(const LimitCase& each) {
  LimitQuestion question{.verify = true};
  if (each.linear) return question;
  question.path = "motion";
  question.run_steps = thorough_search;
  question.t_end = each.problem.t_end;
  return question;
}

/// Tells how many of the rows of a study are done.
class StudyWatcher : public LimitWatcher {
 public:
  StudyWatcher(std::size_t all, const std::function<void(double)>& progress,
               const std::function<bool()>& interrupted)
      : all_(all), progress_(progress), interrupted_(interrupted) {}
  void begin_case(std::size_t done, std::size_t rows) {
    done_ = done;
    rows_ = rows;
  }
  void go_on(double share) override {
    progress_((static_cast<double>(done_) + share * static_cast<double>(rows_)) / static_cast<double>(all_));
  }
  [[nodiscard]] bool stopped() const override { return interrupted_(); }

 private:
  std::size_t all_, done_ = 0, rows_ = 0;
  const std::function<void(double)>& progress_;
  const std::function<bool()>& interrupted_;
};

/// What tells cases from others in which the same number varies.
std::string kind_of(const OscillatorParameters& p) {
  if (p.k3 != 0) return p.P == 0 ? "unforced, " : "forced, ";
  const double zeta = p.c / (2 * std::sqrt(p.k1 * p.m));
  return zeta > 1 + 1e-9 ? "over-damped, " : zeta > 1 - 1e-9 ? "critically damped, " : "";
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
      Problem& problem = cases.back().problem;
      problem.t_end = family.t_end;
      problem.again = [made = problem] { return made; };
    }
  }
  return cases;
}

std::vector<StudyRow> limit_study(const std::vector<LimitCase>& cases, CaseKind kind,
                                  const std::vector<Method>& methods, Store* store,
                                  const std::function<void(double)>& progress,
                                  const std::function<bool()>& interrupted, Shard shard) {
  std::vector<std::vector<Method>> asked(cases.size());
  int number = 0;  // of a row: neighbours, which cost alike, are in different shards
  std::size_t all = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (cases[i].linear != (kind == CaseKind::linear)) continue;
    for (const Method& method : methods)
      if (suits(method, cases[i].problem) && number++ % shard.count == shard.index - 1)
        asked[i].push_back(method);
    all += asked[i].size();
  }
  LimitStore kept{.store = store};
  StudyWatcher watcher(all, progress, interrupted);
  std::vector<StudyRow> rows;
  for (std::size_t i = 0; i < cases.size() && !interrupted(); ++i) {
    if (asked[i].empty()) continue;
    watcher.begin_case(rows.size(), asked[i].size());
    const LimitAnswer answer =
        query_limits(question_of(cases[i]), {cases[i].problem}, asked[i], kept, false, watcher);
    // Of a case without the limits along its motion nothing is kept.
    if (answer.stopped && !cases[i].linear) break;
    for (const ModelLimits& model : answer.models)
      for (const LimitRow& row : model.rows) rows.push_back({i, row});
  }
  return rows;
}

}  // namespace hmax
