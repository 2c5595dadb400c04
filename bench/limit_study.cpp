#include "bench/limit_study.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <thread>

#include "problems/liver_materials.hpp"
#include "problems/liver_problems.hpp"

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

/// Calls work(i) for i < count from two threads; what one throws is thrown.
void in_two_threads(std::size_t count, const std::function<void(std::size_t)>& work,
                    const std::function<void(double)>& progress, const std::function<bool()>& interrupted) {
  std::atomic<std::size_t> next = 0, done = 0;
  std::array<std::exception_ptr, 2> failures;
  const auto labour = [&](std::size_t who) {
    try {
      for (std::size_t i = next++; i < count && !interrupted(); i = next++) {
        work(i);
        ++done;
        if (who == 0) progress(static_cast<double>(done) / static_cast<double>(count));
      }
    } catch (...) {
      failures[who] = std::current_exception();
      next = count;
    }
  };
  {
    const std::jthread second([&] { labour(1); });
    labour(0);
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
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
  struct Job {
    std::size_t which;
    const Method* method;
  };
  std::vector<Job> jobs;
  std::vector<Linearised> near(cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (!cases[i].linear) continue;
    near[i] = linearised(cases[i].problem);
    for (const Method& method : methods)
      if (suits(method, cases[i].problem)) jobs.push_back({i, &method});
  }
  std::vector<std::optional<LimitRow>> rows(jobs.size());
  in_two_threads(
      jobs.size(),
      [&](std::size_t j) {
        const auto& [which, method] = jobs[j];
        Prediction row = predict(*method, cases[which].problem, near[which]);
        verify(row, *method, cases[which].problem, near[which]);
        rows[j] = LimitRow{which, std::move(row)};
      },
      progress, interrupted);
  std::vector<LimitRow> finished;
  for (std::optional<LimitRow>& row : rows)
    if (row) finished.push_back(std::move(*row));
  return finished;
}

std::vector<NonlinearRow> nonlinear_limits(const std::vector<LimitCase>& cases,
                                           const std::vector<Method>& methods,
                                           const std::function<void(double)>& progress,
                                           const std::function<bool()>& interrupted) {
  struct Job {
    std::size_t which;
    const Method* method;
  };
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const Method& method : methods)
      if (!cases[i].linear && suits(method, cases[i].problem)) jobs.push_back({i, &method});
  std::vector<std::optional<NonlinearRow>> rows(jobs.size());
  in_two_threads(
      jobs.size(),
      [&](std::size_t j) {
        const auto& [which, method] = jobs[j];
        const Problem& problem = cases[which].problem;
        const Linearised near = linearised(problem);
        NonlinearRow row{which, method->id, predict(*method, problem, near), {}, {}};
        verify(row.at_rest, *method, problem, near);
        row.along = limit_along(*method, problem, problem.t_end);
        double guess = row.along ? row.along->least : 1;
        if (!(guess > 0 && std::isfinite(guess))) guess = 1;
        row.from_start = limit_from_start(*method, problem, problem.t_end, guess);
        rows[j] = std::move(row);
      },
      progress, interrupted);
  std::vector<NonlinearRow> finished;
  for (std::optional<NonlinearRow>& row : rows)
    if (row) finished.push_back(std::move(*row));
  return finished;
}

}  // namespace hmax
