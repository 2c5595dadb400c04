/// Stores as pages show them, made up for tests.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plots/pages/reported_store.hpp"
#include "tests/results/made_rows.hpp"

namespace hmax {

/// Of `method` at `h`; its time and its error follow from the step.
inline Row made_run(const std::string& method, double h) {
  Row row = made_row(method, h, 10);
  row.rhs = row.steps;
  row.cpu_s = {1e-6 / h, 1e-6 / h, 1e-6 / h};
  row.error_end = row.error_global = h * h;
  row.session = 1;
  return row;
}

inline LimitRow made_limit(const std::string& method, double h_max, double observed) {
  LimitRow row;
  row.point.problem = "fem_green/press@liver";
  row.point.material = "liver:male_normal";
  row.method = method;
  row.bound = "stability";
  row.state_kind = "equilibrium";
  row.h_max = h_max;
  row.observed = observed;
  row.gap = (observed - h_max) / h_max;
  row.verdict = "confirmed";
  row.session = 1;
  return row;
}

inline AdviceRecord made_advice(const std::string& method, const std::string& verdict, double h) {
  AdviceRecord row;
  row.key.problem = "liver_forced";
  row.key.motion = "the force of the model";
  row.key.ranked_by = "cost";
  row.key.rate = 100;
  row.key.tolerance = row.key.budget = 0.01;
  row.method = method;
  row.bound = "stability";
  row.verdict = verdict;
  row.h = h;
  row.steps_per_frame = 0.01 / h;
  row.h_max = 2.272e-3;
  row.h_max_observed = 2.28e-3;
  row.error = 0.0068;
  row.frame_p50 = 5.38e-5;
  row.frame_p99 = 8.27e-5;
  row.frame_max = 1.23e-4;
  row.frame_tail = "5e-05 5.1e-05 5.2e-05 5.38e-05 5.5e-05 6e-05 7e-05 8e-05 8.27e-05 9e-05 0.0001";
  row.frames = 1003;
  row.missed = 0;
  row.session = 1;
  return row;
}

/// A store with rows of every kind: `runs` runs of four methods.
inline ReportedStore made_store(const std::string& name, int runs = 8) {
  ReportedStore store{.name = name};
  const std::vector<std::string> methods{"rk4", "newmark", "explicit_euler", "symplectic_euler"};
  for (int i = 0; i < runs; ++i)
    store.runs.push_back(made_run(methods[static_cast<std::size_t>(i) % 4], 0.5 / (1 + i)));
  store.limits = {made_limit("rk4", 3.2e-3, 3.201e-3),
                  made_limit("newmark", std::numeric_limits<double>::infinity(), std::nan(""))};
  store.advice = {made_advice("symplectic_euler", "recommended", 2e-3), made_advice("rk4", "tie", 2.5e-3),
                  made_advice("explicit_euler", "too_slow", 5e-6)};
  Fingerprint machine;
  machine.cpu = "a test";
  store.sessions = {{1, "2026-01-02T03:04:05Z", machine}};
  return store;
}

}  // namespace hmax
