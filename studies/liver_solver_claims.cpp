/// What the liver study says of its five solvers, tested.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

Judgement judged(bool holds, bool in_part = false) {
  return holds ? Judgement::holds : in_part ? Judgement::holds_in_part : Judgement::does_not_hold;
}

/// The five from fast to slow at this step.
std::vector<const char*> ranking(const Measured& measured, double h) {
  std::vector<const char*> order;
  for (const char* id : solvers)
    if (!std::isnan(measured.as_studied(id, h))) order.push_back(id);
  std::ranges::sort(order, {}, [&](const char* id) { return measured.as_studied(id, h); });
  return order;
}

std::string in_words(const Measured& measured, double h) {
  std::vector<std::string> words;
  for (const char* id : ranking(measured, h))
    words.push_back(fmt::format("{} {:.3g} ms", matlab_name(id), measured.as_studied(id, h)));
  return fmt::format("{}", fmt::join(words, ", "));
}

/// The largest stable steps along the motion [s].
std::map<std::string, double> limits_of_solvers() {
  const Problem problem = make_problem("liver_forced");
  std::map<std::string, double> limits;
  for (const char* id : {euler, ode45, ode23s, ode23t})
    if (const auto along = limit_along(find_method(id), problem, problem.t_end)) limits[id] = along->least;
  return limits;
}

std::string seconds(double h) {
  return std::isfinite(h) ? fmt::format("{:.3g} s", h) : std::string("without bound");
}

std::vector<Claim> claims_on_speed(const Measured& measured) {
  const auto others_of = [&](double h) {
    std::vector<const char*> order = ranking(measured, h);
    std::erase(order, euler);
    return order;
  };
  const auto count_first = [&](const char* id, const auto& order_at) {
    return std::ranges::count_if(liver_step_sizes, [&](double h) {
      const auto order = order_at(h);
      return !order.empty() && order.front() == id;
    });
  };
  const auto first = count_first(ode45, [&](double h) { return ranking(measured, h); }),
             first_of_four = count_first(ode45, others_of);
  const auto steps = static_cast<std::ptrdiff_t>(liver_step_sizes.size());
  const std::vector<const char*> printed{ode45, ode23s, ode113, euler, ode23t};
  constexpr double h = 0.01, last = 0.00005;
  const std::vector<const char*> order = ranking(measured, h);
  const char* slowest = ranking(measured, last).empty() ? "" : ranking(measured, last).back();
  const double ratio = measured.ms("fixed", euler, last) / measured.ms("fixed", ode45, last);
  return {
      {"Abstract",
       "MATLAB ode45 is the fastest method compared to 2nd ordered Euler, MATLAB ode113, ode23s and ode23t.",
       fmt::format(
           "With h as step of Euler and as output interval of the others it is the fastest of the five at {} of "
           "the {} steps, and of the four that choose their steps at {}.",
           first, steps, first_of_four),
       judged(first == steps, first_of_four > steps / 2)},
      {"3.1",
       "[the CPU times] from minimum to maximum were ode45, ode23s, ode113, 2nd order Euler and ode23t",
       fmt::format("At h = {} s: {}. The printed order is that in which the solvers were run.", h,
                   in_words(measured, h)),
       judged(order == printed)},
      {"3.1", "Second order Euler [...] the computational time is higher than the aforementioned methods",
       fmt::format("At fixed steps of {} s it takes {:.2g} of the time of ode45.", last, ratio),
       judged(ratio > 1)},
      {"3.1", "Ode23t is the slowest among the five.",
       fmt::format(
           "At h = {} s: {}. At fixed steps of that size {:.3g} ms, Euler {:.3g} ms, ode45 {:.3g} ms, ode23s "
           "{:.3g} ms.",
           last, in_words(measured, last), measured.ms("fixed", ode23t, last),
           measured.ms("fixed", euler, last), measured.ms("fixed", ode45, last),
           measured.ms("fixed", ode23s, last)),
       judged(slowest == ode23t, measured.ms("fixed", ode23t, last) > measured.ms("fixed", ode23s, last))}};
}

std::vector<Claim> claims_on_steps(const Measured& measured) {
  constexpr double large = 0.2, small = 0.0005, last = 0.00005;
  const double fixed = measured.ms("fixed", ode45, small) / measured.ms("fixed", ode45, large),
               sampled = measured.ms("sampled", ode45, small) / measured.ms("sampled", ode45, large),
               more = measured.steps("fixed", ode45, small) / measured.steps("fixed", ode45, large);
  const double coarse_error = measured.error("fixed", ode45, 2),
               small_error = measured.error("fixed", ode45, small),
               last_error = measured.error("fixed", ode45, last);
  bool falls = true;
  std::vector<std::string> falling;
  for (const char* id : {euler, ode45, ode23s, ode23t}) {
    const double before = measured.error("fixed", id, 0.05), after = measured.error("fixed", id, 0.005);
    falls = falls && after < before;
    falling.push_back(fmt::format("{} {:.2g} to {:.2g}", matlab_name(id), before, after));
  }
  const std::string at_two = std::isfinite(coarse_error) ? fmt::format("its error is {:.2g}", coarse_error)
                                                         : std::string("its run does not reach the end");
  return {
      {"3.1", "The total CPU runtime remain almost constant through the range of time step of 0.0005<h<2.",
       fmt::format(
           "From h = {} to {} s, 400 times shorter, ode45 takes {:.3g} times as long with fixed steps, and {:.3g} "
           "times with h as output interval.",
           large, small, fixed, sampled),
       judged(fixed < 1.5 && sampled < 1.5, sampled < 1.5)},
      {"3.1", "ode45 converges at large time steps (h>2)",
       fmt::format(
           "At fixed steps of h = 2 s {} and its largest stable step along the motion is {}. With h as output "
           "interval it says nothing: the method takes its own, shorter steps.",
           at_two, seconds(limits_of_solvers()[ode45])),
       judged(coarse_error < 0.1)},
      {"3.1", "[ode45] become inaccurate as the time step decreases (h<0.0005)",
       fmt::format("The error is {:.2g} at h = {} s and {:.2g} at h = {} s: rounding, and nothing else.",
                   small_error, small, last_error, last),
       judged(last_error > 1e-6)},
      {"3.1", "the size of time step is directly proportional to the number of iterations",
       fmt::format("Inversely: from h = {} to {} s the steps become {:.4g} times as many.", large, small,
                   more),
       Judgement::does_not_hold},
      {"3.1", "reducing the step size increases accuracy",
       fmt::format("From h = 0.05 to 0.005 s the errors fall: {}. Below, ode45 meets rounding.",
                   fmt::join(falling, ", ")),
       judged(falls)}};
}

std::vector<Claim> claims_on_accuracy(const Measured& measured) {
  constexpr double h = 0.01;
  const double fixed_45 = measured.error("fixed", ode45, h), fixed_23s = measured.error("fixed", ode23s, h);
  const double own_45 = measured.error("sampled", ode45, h), own_23s = measured.error("sampled", ode23s, h),
               own_113 = measured.error("sampled", ode113, h);
  return {
      {"3.1", "ode23s is less accurate than the ode45 as it takes more computational time",
       fmt::format(
           "Less accurate, by its order of 2 against 5: at fixed steps of {} s {:.2g} against {:.2g}. Time is no "
           "reason; at one tolerance it takes {:.3g} ms against {:.3g} ms because its order needs more steps.",
           h, fixed_23s, fixed_45, measured.ms("sampled", ode23s, h), measured.ms("sampled", ode45, h)),
       judged(false, fixed_23s > fixed_45)},
      {"3.1", "[ode113] is very accurate compares to ode45 and ode23s",
       fmt::format(
           "At rtol = atol = 1e-6 the errors are {:.2g} (ode113), {:.2g} (ode45) and {:.2g} (ode23s): the "
           "tolerance sets them, not the method.",
           own_113, own_45, own_23s),
       judged(own_113 < 0.1 * own_45 && own_113 < 0.1 * own_23s, own_113 < own_45)},
      {"2.4", "ode113 is [...] very accurate since it is the thirteenth order",
       "Its predictor has an order from 1 to 12 and its corrector one more: 13 is the highest that it may take. It takes "
       "the one with the longest step, and a loose tolerance needs no high one.",
       Judgement::holds_in_part}};
}

std::vector<Claim> claims_on_stability(const Measured& measured) {
  constexpr double h = 0.005;
  auto limits = limits_of_solvers();
  const double slower = measured.ms("fixed", ode23t, h) / measured.ms("fixed", euler, h);
  double most = 0;
  for (const auto& [id, limit] : limits) most = std::max(most, limit);
  return {
      {"3.1", "Second order Euler is the most constant and stable among the five.",
       fmt::format(
           "Its largest stable step along the motion is {}, the smallest of the five; ode45 {}, ode23s {}, ode23t "
           "{}. As printed it is the explicit method of first order.",
           seconds(limits[euler]), seconds(limits[ode45]), seconds(limits[ode23s]), seconds(limits[ode23t])),
       judged(limits[euler] >= most)},
      {"2.2",
       "[implicit integration] allows large time steps therefore increases the stability of the system",
       fmt::format("The largest stable step of ode23t is {}, that of Euler {}.", seconds(limits[ode23t]),
                   seconds(limits[euler])),
       judged(limits[ode23t] > limits[euler])},
      {"2.2", "However, it is not computationally efficient.",
       fmt::format(
           "A step of ode23t costs {:.2g} times one of Euler here, where a step of {} s is stable for both; on "
           "stiff models it may be hundreds of times longer.",
           slower, h),
       judged(false, slower > 1)}};
}

}  // namespace

std::vector<SolverWork> work_at_defaults() {
  const Problem problem = make_problem("liver_forced");
  const Reference reference = make_reference(problem, problem.t_end);
  std::vector<SolverWork> all;
  for (const char* id : {ode45, ode23s, ode113, ode23t}) {
    const Method method = find_method(id);
    const Runner runner = method.bind(problem);
    for (const bool matlab : {true, false}) {
      SolverWork& work = all.emplace_back(SolverWork{id, matlab ? 1e-3 : 1e-6, 1e-6, {}, 0});
      RunSpec spec{.t_end = problem.t_end, .adaptive = true, .rtol = work.rtol, .atol = work.atol};
      if (matlab && !method.own_control) spec.control = controllers_from("matlab");
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

std::vector<Claim> claims_on_solvers(const std::vector<Row>& rows) {
  const Measured measured(rows);
  std::vector<Claim> claims;
  for (const auto& part : {claims_on_speed(measured), claims_on_steps(measured), claims_on_accuracy(measured),
                           claims_on_stability(measured)})
    claims.insert(claims.end(), part.begin(), part.end());
  return claims;
}

}  // namespace hmax
