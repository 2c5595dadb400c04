/// What the liver study says of its five solvers, tested.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "bench/timing/reference.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "problems/oscillator/liver_problems.hpp"
#include "studies/liver_claims.hpp"

namespace hmax {

namespace {

constexpr const char *euler = "explicit_euler", *ode45 = "dormand_prince_54", *ode23s = "rosenbrock_23",
                     *ode113 = "adams_pece", *ode23t = "trapezoidal";
constexpr std::array solvers{euler, ode45, ode23s, ode113, ode23t};

std::string matlab_name(std::string_view id) {
  return id == euler    ? "Euler"
         : id == ode45  ? "ode45"
         : id == ode23s ? "ode23s"
         : id == ode113 ? "ode113"
                        : "ode23t";
}

/// Rows by mode, method and step.
class Measured {
 public:
  explicit Measured(const std::vector<Row>& rows) {
    for (const Row& row : rows)
      if (row.outcome == "reached_end") rows_[{row.key.mode, row.key.method}][row.key.h] = &row;
  }
  /// Median CPU time [ms]; NaN where there is no such run.
  double ms(const char* mode, const char* method, double h) const {
    const Row* row = find(mode, method, h);
    return row ? 1e3 * summarise(row->cpu_s).median : none;
  }
  /// Largest error of the run; infinity where it did not reach its end.
  double error(const char* mode, const char* method, double h) const {
    const Row* row = find(mode, method, h);
    return row ? row->error_global : std::numeric_limits<double>::infinity();
  }
  double steps(const char* mode, const char* method, double h) const {
    const Row* row = find(mode, method, h);
    return row ? static_cast<double>(row->steps) : none;
  }
  /// How Euler runs with the step h and the others with h as output interval [ms].
  double as_studied(const char* method, double h) const {
    return ms(method == euler ? "fixed" : "sampled", method, h);
  }

 private:
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const Row* find(const char* mode, const char* method, double h) const {
    const auto list = rows_.find({mode, method});
    if (list == rows_.end()) return nullptr;
    const auto row = list->second.find(h);
    return row == list->second.end() ? nullptr : row->second;
  }
  std::map<std::pair<std::string, std::string>, std::map<double, const Row*>> rows_;
};

/// The five from fast to slow at this step.
std::vector<const char*> ranking(const Measured& measured, double h) {
  std::vector<const char*> order;
  for (const char* id : solvers)
    if (!std::isnan(measured.as_studied(id, h))) order.push_back(id);
  std::ranges::sort(order, {}, [&](const char* id) { return measured.as_studied(id, h); });
  return order;
}

/// [{"solver": ..., "ms": ...}] from fast to slow, at this step.
Claims ranked_times(const Measured& measured, double h) {
  Claims times = Claims::array();
  for (const char* id : ranking(measured, h))
    times.push_back({{"solver", matlab_name(id)}, {"ms", measured.as_studied(id, h)}});
  return times;
}

/// The largest stable steps along the motion [s].
std::map<std::string, double> limits_of_solvers() {
  const Problem problem = make_problem("liver_forced");
  std::map<std::string, double> limits;
  for (const char* id : {euler, ode45, ode23s, ode23t})
    if (const auto along = limit_along(find_method(id), problem, problem.t_end)) limits[id] = along->least;
  return limits;
}

Claims claims_on_speed(const Measured& measured) {
  const auto others_of = [&](double h) {
    std::vector<const char*> order = ranking(measured, h);
    std::erase(order, euler);
    return order;
  };
  const auto count_first = [&](const auto& order_at) {
    return std::ranges::count_if(liver_step_sizes, [&](double h) {
      const auto order = order_at(h);
      return !order.empty() && order.front() == ode45;
    });
  };
  const auto of_five = count_first([&](double h) { return ranking(measured, h); }),
             of_four = count_first(others_of);
  const auto steps = static_cast<std::ptrdiff_t>(liver_step_sizes.size());
  const std::vector<const char*> printed{ode45, ode23s, ode113, euler, ode23t};
  constexpr double h = 0.01, last = 0.00005;
  const char* slowest = ranking(measured, last).empty() ? "" : ranking(measured, last).back();
  const auto at_last = [&](const char* id) { return measured.ms("fixed", id, last); };
  const double ratio = at_last(euler) / at_last(ode45);
  Claims fixed = Claims::array();
  for (const char* id : {ode23t, euler, ode45, ode23s})
    fixed.push_back({{"solver", matlab_name(id)}, {"ms", at_last(id)}});
  return {{"ode45_is_fastest",
           {{"judgement", judged(of_five == steps, of_four > steps / 2)},
            {"of_five", of_five},
            {"steps", steps},
            {"of_four", of_four}}},
          {"order_of_times",
           {{"judgement", judged(ranking(measured, h) == printed)}, {"times", ranked_times(measured, h)}}},
          {"euler_is_slower", {{"judgement", judged(ratio > 1)}, {"ratio", ratio}}},
          {"ode23t_is_slowest",
           {{"judgement", judged(slowest == ode23t, at_last(ode23t) > at_last(ode23s))},
            {"times", ranked_times(measured, last)},
            {"fixed", fixed}}}};
}

Claims claims_on_steps(const Measured& measured, std::map<std::string, double>& limits) {
  constexpr double large = 0.2, small = 0.0005, last = 0.00005;
  const double fixed = measured.ms("fixed", ode45, small) / measured.ms("fixed", ode45, large),
               sampled = measured.ms("sampled", ode45, small) / measured.ms("sampled", ode45, large),
               more = measured.steps("fixed", ode45, small) / measured.steps("fixed", ode45, large);
  const double coarse_error = measured.error("fixed", ode45, 2),
               small_error = measured.error("fixed", ode45, small),
               last_error = measured.error("fixed", ode45, last);
  bool falls = true;
  Claims errors = Claims::array();
  for (const char* id : {euler, ode45, ode23s, ode23t}) {
    const double before = measured.error("fixed", id, 0.05), after = measured.error("fixed", id, 0.005);
    falls = falls && after < before;
    errors.push_back({{"solver", matlab_name(id)}, {"before", before}, {"after", after}});
  }
  return {{"time_is_constant",
           {{"judgement", judged(fixed < 1.5 && sampled < 1.5, sampled < 1.5)},
            {"fixed", fixed},
            {"sampled", sampled}}},
          {"ode45_converges",
           {{"judgement", judged(coarse_error < 0.1)},
            {"reached_end", std::isfinite(coarse_error)},
            {"error", coarse_error},
            {"limit", limits[ode45]}}},
          {"ode45_becomes_inaccurate",
           {{"judgement", judged(last_error > 1e-6)}, {"small", small_error}, {"last", last_error}}},
          {"steps_and_iterations", {{"judgement", Judged::does_not_hold}, {"more", more}}},
          {"smaller_is_better", {{"judgement", judged(falls)}, {"errors", errors}}}};
}

/// The work of one solver at MATLAB's defaults or at those of the report; of no number where it is missing.
SolverWork work_of(const std::vector<SolverWork>& work, const char* method, double rtol) {
  const auto it = std::ranges::find_if(
      work, [&](const SolverWork& each) { return each.method == method && each.rtol == rtol; });
  if (it != work.end()) return *it;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  return {.method = method, .rtol = rtol, .error = none};
}

constexpr double matlab_rtol = 1e-3, report_rtol = 1e-6;  // MATLAB's, and that of the rows

/// The time of a run over that of ode45, with so few outputs that the steps make it.
double slower_than_ode45(const Measured& measured, const char* method) {
  constexpr double few = 2;  // [s]
  return measured.ms("sampled", method, few) / measured.ms("sampled", ode45, few);
}

Claims claims_on_accuracy(const Measured& measured, const std::vector<SolverWork>& work) {
  constexpr double h = 0.01;
  const double fixed_45 = measured.error("fixed", ode45, h), fixed_23s = measured.error("fixed", ode23s, h);
  const SolverWork at_45 = work_of(work, ode45, matlab_rtol), at_23s = work_of(work, ode23s, matlab_rtol),
                   at_113 = work_of(work, ode113, matlab_rtol);
  const double slower_113 = slower_than_ode45(measured, ode113);
  return {{"ode23s_is_less_accurate",
           {{"judgement", judged(false, fixed_23s > fixed_45 && at_23s.error > at_45.error)},
            {"ode23s", fixed_23s},
            {"ode45", fixed_45},
            {"ode23s_ms", measured.ms("sampled", ode23s, h)},
            {"ode45_ms", measured.ms("sampled", ode45, h)}}},
          {"ode113_is_accurate",
           {{"judgement", judged(at_113.error < at_45.error && at_113.error < at_23s.error)},
            {"ode113", at_113.error},
            {"ode45", at_45.error},
            {"ode23s", at_23s.error},
            {"tight_ode113", work_of(work, ode113, report_rtol).error},
            {"tight_ode45", work_of(work, ode45, report_rtol).error}}},
          {"ode113_is_less_efficient",
           {{"judgement", judged(slower_113 > 1)},
            {"slower", slower_113},
            {"ode113", at_113.stats.rhs},
            {"ode45", at_45.stats.rhs}}},
          {"order_of_ode113", Claims::object({{"judgement", Judged::holds_in_part}})}};
}

/// The least time of a fixed step of a method whose error is no larger [ms]; NaN where there is none.
double ms_of_error(const Measured& measured, const char* method, double error) {
  double least = std::numeric_limits<double>::quiet_NaN();
  for (const double h : liver_step_sizes)
    if (measured.error("fixed", method, h) <= error)
      least = std::fmin(least, measured.ms("fixed", method, h));
  return least;
}

/// How much faster than the motion itself a solver of the study is, at 100 outputs a second and at its worst.
Claims real_time_of(const Measured& measured, const char* method) {
  constexpr double t_end = 100, frame = 0.01;  // [s]
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (const double h : liver_step_sizes)
    worst = std::fmin(worst, 1e3 * t_end / measured.as_studied(method, h));
  const double at_frame = 1e3 * t_end / measured.as_studied(method, frame);
  return {{"judgement", judged(at_frame < 1, worst < 1)}, {"at_frame", at_frame}, {"worst", worst}};
}

Claims claims_on_real_time(const Measured& measured) {
  constexpr double h = 0.005;
  const double error = measured.error("fixed", euler, h), euler_ms = measured.ms("fixed", euler, h),
               same_step = measured.ms("fixed", ode23s, h) / euler_ms,
               same_error = ms_of_error(measured, ode23s, error) / euler_ms;
  const double slower = slower_than_ode45(measured, ode23s);
  return {{"ode113_is_no_real_time", real_time_of(measured, ode113)},
          {"euler_is_no_real_time", real_time_of(measured, euler)},
          {"ode23t_is_no_real_time", real_time_of(measured, ode23t)},
          {"ode23s_is_not_best", {{"judgement", judged(slower > 1)}, {"slower", slower}}},
          {"ode23s_beats_euler",
           {{"judgement", judged(same_step < 1 && same_error < 1, same_error < 1)},
            {"same_step", same_step},
            {"error", error},
            {"same_error", same_error}}}};
}

Claims claims_on_stability(const Measured& measured, std::map<std::string, double>& limits) {
  constexpr double h = 0.005;
  const double slower = measured.ms("fixed", ode23t, h) / measured.ms("fixed", euler, h);
  double most = 0;
  for (const auto& [id, limit] : limits) most = std::max(most, limit);
  return {{"euler_is_most_stable",
           {{"judgement", judged(limits[euler] >= most)},
            {"euler", limits[euler]},
            {"ode45", limits[ode45]},
            {"ode23s", limits[ode23s]},
            {"ode23t", limits[ode23t]}}},
          {"implicit_is_more_stable",
           {{"judgement", judged(limits[ode23t] > limits[euler])},
            {"euler", limits[euler]},
            {"ode23t", limits[ode23t]}}},
          {"implicit_is_inefficient", {{"judgement", judged(false, slower > 1)}, {"slower", slower}}}};
}

}  // namespace

std::vector<SolverWork> work_at_defaults() {
  const Problem problem = make_problem("liver_forced");
  const Reference reference = make_reference(problem, problem.t_end);
  std::vector<SolverWork> all;
  for (const char* id : {ode45, ode23s, ode113, ode23t}) {
    const Method method = find_method(id);
    const Runner runner = method.bind(problem);
    for (const double rtol : {matlab_rtol, report_rtol}) {
      SolverWork& work = all.emplace_back(SolverWork{.method = id, .rtol = rtol, .atol = 1e-6});
      RunSpec spec{.t_end = problem.t_end, .adaptive = true, .rtol = work.rtol, .atol = work.atol};
      if (rtol == matlab_rtol && !method.own_control) spec.control = controllers_from("matlab");
      work.stats = runner
                       .run(spec,
                            [&](double t, const auto& y) {
                              work.error = std::max(work.error, (y - reference.at(t)).cwiseAbs().maxCoeff());
                            })
                       .stats;
    }
  }
  return all;
}

Claims claims_on_solvers(const std::vector<Row>& rows, const std::vector<SolverWork>& work) {
  const Measured measured(rows);
  auto limits = limits_of_solvers();
  Claims claims;
  for (const Claims& part :
       {claims_on_speed(measured), claims_on_steps(measured, limits), claims_on_accuracy(measured, work),
        claims_on_real_time(measured), claims_on_stability(measured, limits)})
    claims.update(part);
  return claims;
}

}  // namespace hmax
