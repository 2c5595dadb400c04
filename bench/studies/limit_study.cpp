#include "bench/studies/limit_study.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "bench/catalogue/catalogue.hpp"
#include "bench/limits/verification.hpp"
#include "core/parallel_for.hpp"
#include "problems/oscillator/liver_materials.hpp"
#include "problems/oscillator/liver_problems.hpp"

namespace hmax {

namespace {

/// The oscillator with these parameters as a problem of the catalogue.
Problem problem_of(const OscillatorParameters& p, const Eigen::Vector2d& y0, double t_end) {
  Problem problem = make_problem(
      "liver_forced",
      {.material = {},
       .parameters = {{"m", p.m}, {"c", p.c}, {"k1", p.k1}, {"k3", p.k3}, {"P", p.P}, {"w", p.w}},
       .y0 = {y0[0], y0[1]}});
  problem.t_end = t_end;
  return problem;
}

/// work(which, method) of every method on every case of the kind that suits it, cases first, on all cores.
/// After an interruption the rows that are finished.
template <class Row, class Work>
std::vector<Row> over_pairs(const std::vector<LimitCase>& cases, bool linear,
                            const std::vector<Method>& methods, const Work& work,
                            const std::function<void(double)>& progress,
                            const std::function<bool()>& interrupted) {
  std::vector<std::pair<std::size_t, const Method*>> pairs;
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const Method& method : methods)
      if (cases[i].linear == linear && suits(method, cases[i].problem)) pairs.emplace_back(i, &method);

  std::vector<std::optional<Row>> rows(pairs.size());
  parallel_for(
      pairs.size(), [&](std::size_t i, std::size_t) { rows[i] = work(pairs[i].first, *pairs[i].second); },
      [&](std::size_t done) { progress(static_cast<double>(done) / static_cast<double>(pairs.size())); },
      interrupted);

  std::vector<Row> finished;
  for (std::optional<Row>& row : rows)
    if (row) finished.push_back(std::move(*row));
  return finished;
}

/// What every method is asked about, once for each case.
std::vector<Linearised> linearised(const std::vector<LimitCase>& cases) {
  std::vector<Linearised> near;
  near.reserve(cases.size());
  for (const LimitCase& each : cases) near.push_back(linearised(each.problem));
  return near;
}

}  // namespace

std::vector<LimitCase> limit_cases() {
  std::vector<LimitCase> cases;
  for (const LiverMaterial& material : liver_materials())
    for (const char* end : {":light", ":heavy"}) {
      const std::string id = std::string(material.id) + end;
      cases.push_back({id, "benchmark liver",
                       make_problem("liver_benchmark", {.material = id, .parameters = {}, .y0 = {}}), true});
    }
  std::vector<OscillatorParameters> seen;
  for (const LiverFamily& family : liver_families()) {
    // Figure 1 is about time, figure 8 about the materials.
    if (family.figure < 2 || family.figure > 7) continue;
    for (const LiverFamilyMember& member : family.members) {
      const OscillatorParameters& p = member.parameters;
      if (std::ranges::find(seen, p) != seen.end()) continue;
      seen.push_back(p);
      cases.push_back(
          {member.label, std::string(family.id), problem_of(p, family.y0, family.t_end), p.k3 == 0});
    }
  }
  return cases;
}

std::vector<LimitRow> predicted_and_observed(const std::vector<LimitCase>& cases,
                                             const std::vector<Method>& methods,
                                             const std::function<void(double)>& progress,
                                             const std::function<bool()>& interrupted) {
  const std::vector<Linearised> near = linearised(cases);
  return over_pairs<LimitRow>(
      cases, true, methods,
      [&](std::size_t which, const Method& method) {
        LimitRow row{which, predict(method, cases[which].problem, near[which])};
        verify(row.prediction, method, cases[which].problem, near[which]);
        return row;
      },
      progress, interrupted);
}

std::vector<NonlinearRow> nonlinear_limits(const std::vector<LimitCase>& cases,
                                           const std::vector<Method>& methods,
                                           const std::function<void(double)>& progress,
                                           const std::function<bool()>& interrupted) {
  const std::vector<Linearised> near = linearised(cases);
  std::vector<MotionSize> sizes;
  for (const LimitCase& each : cases)
    sizes.push_back(each.linear ? MotionSize{} : size_of_motion(each.problem, each.problem.t_end));
  return over_pairs<NonlinearRow>(
      cases, false, methods,
      [&](std::size_t which, const Method& method) {
        const Problem& problem = cases[which].problem;
        NonlinearRow row{which, method.id, predict(method, problem, near[which]), {}, {}};
        verify(row.at_rest, method, problem, near[which]);
        row.along = limit_along(method, problem, problem.t_end);
        double guess = row.along ? row.along->least : 1;
        if (!(guess > 0 && std::isfinite(guess))) guess = 1;
        if (const auto start = limit_from_start(method, problem, problem.t_end, guess, sizes[which]))
          row.from_start = start->h;
        return row;
      },
      progress, interrupted);
}

}  // namespace hmax
