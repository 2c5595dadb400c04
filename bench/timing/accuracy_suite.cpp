#include "bench/timing/accuracy_suite.hpp"

#include <limits>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/timing/reference.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/numbers.hpp"
#include "core/parallel_for.hpp"

namespace hmax {

namespace {

/// A system whose Jacobian methods have to find by differences.
struct Undifferentiated {
  using State = AnySystem::State;
  AnySystem system;
  [[nodiscard]] Eigen::Index dim() const { return system.dim(); }
  void rhs(double t, const State& y, State& dydt) const { system.rhs(t, y, dydt); }
};

/// The same with a known pattern, whose columns are taken together in groups.
struct UndifferentiatedWithPattern : Undifferentiated {
  State y;  ///< where every entry of the Jacobian is there
  void sparsity(Eigen::SparseMatrix<double>& pattern) const {
    AnySystem::Jacobian J;
    system.jacobian(0, y, J);
    pattern = std::get<Eigen::SparseMatrix<double>>(J);
  }
};

enum class Derivatives { own, by_differences, by_grouped_differences };

/// A problem of the suite, short enough for a whole suite in seconds.
struct SuiteProblem {
  const char* id;
  Parameters parameters;
  double t_end;
  bool stiff = false;        ///< for methods that solve equations alone
  std::vector<double> y0{};  ///< adaptive runs from here; empty: all runs, from the problem's own start
  Derivatives derivatives = Derivatives::own;
};

const std::vector<SuiteProblem>& suite_problems() {
  static const std::vector<SuiteProblem> problems{
      {"liver_linear", {}, 10},
      {"liver_cubic", {}, 10},
      {"liver_forced", {}, 10},
      {"kepler", {}, 4},
      {"spring_chain", {}, 0.25},
      {"prothero_robinson", {}, 2},
      {"van_der_pol", {}, 500, true},
      {"robertson", {}, 1e4, true},
      {"hires", {}, 100, true},
      // Almost at rest: the first step is found from slopes far below the tolerance.
      {"liver_linear", {}, 10, false, {1e-5, 0}},
      {"hires", {}, 100, true, {}, Derivatives::by_differences},
      {"brusselator", {{"n", 20}}, 1, true, {}, Derivatives::by_grouped_differences},
  };
  return problems;
}

void take_derivatives_away(Problem& problem, Derivatives derivatives) {
  const AnySystem system = std::get<AnySystem>(problem.system);
  if (derivatives == Derivatives::by_differences)
    problem.system = AnySystem(Undifferentiated{system});
  else
    problem.system = AnySystem(UndifferentiatedWithPattern{{system}, problem.y0});
}

/// Samples of the dense output that are compared; no step of the suite divides them.
constexpr double samples = 7;
constexpr std::int64_t attempts = 100'000;

void add_fixed(AccuracyPlan& plan, std::size_t p, const Method& method, double t_end) {
  for (const int steps : {50, 160}) {
    const double h = t_end / steps;
    RunSpec spec{.t_end = t_end, .h = h, .every = t_end / samples, .max_steps = attempts};
    plan.cases.push_back({p, method, spec, fmt::format("h={}", to_text(h))});
    if (!method.needs_jacobian || steps != 160) continue;
    for (const int every : {JacobianUpdate::frozen, 1, 5}) {
      spec.jacobian.every = every;
      plan.cases.push_back(
          {p, method, spec, fmt::format("h={} jacobian={}", to_text(h), to_string(spec.jacobian))});
    }
  }
}

void add_adaptive(AccuracyPlan& plan, std::size_t p, const Method& method, double t_end) {
  const auto add = [&](double tolerance, Controllers control) {
    plan.cases.push_back({p, method,
                          RunSpec{.t_end = t_end,
                                  .adaptive = true,
                                  .rtol = tolerance,
                                  .atol = tolerance,
                                  .control = control,
                                  .every = t_end / samples,
                                  .max_steps = attempts},
                          fmt::format("rtol={}", to_text(tolerance))});
    AccuracyCase& added = plan.cases.back();
    added.setting += " control=" + control_of(method, added.spec);
  };
  for (const double tolerance : {1e-3, 1e-6}) add(tolerance, Controllers::deadband);
  if (method.own_control) return;
  if (plan.problems[p].id == "liver_forced")
    for (const Controllers control : {Controllers::i, Controllers::pi, Controllers::matlab})
      add(1e-5, control);
  // At its jumps steps fail more than once, which MATLAB has a rule for.
  if (plan.problems[p].id == "van_der_pol") add(1e-5, Controllers::matlab);
}

}  // namespace

AccuracyPlan accuracy_plan(const std::vector<std::string>& methods, const std::vector<Method>& own) {
  AccuracyPlan plan;
  std::vector<Method> chosen = choose_methods(methods, {});
  for (const Method& method : own) add_once(chosen, method);
  std::erase_if(chosen, [&](const Method& method) {
    // Foreign engines are peers, not ours to guard: their numbers change with their version.
    if (method.is_foreign())
      plan.left_out.push_back(
          {method.id, fmt::format("is of {}, whose numbers change with its version", method.engine)});
    return method.is_foreign();
  });
  for (const SuiteProblem& entry : suite_problems()) {
    const std::size_t p = plan.problems.size();
    plan.problems.push_back(make_problem(entry.id, {.parameters = entry.parameters, .y0 = entry.y0}));
    if (entry.derivatives != Derivatives::own) take_derivatives_away(plan.problems[p], entry.derivatives);
    const std::size_t first_case = plan.cases.size();
    for (const Method& method : chosen) {
      if (!suits(method, plan.problems[p])) continue;
      if (entry.stiff && !method.needs_jacobian) continue;
      if (method.fixed_step && !entry.stiff && entry.y0.empty()) add_fixed(plan, p, method, entry.t_end);
      if (method.adaptive()) add_adaptive(plan, p, method, entry.t_end);
    }
    std::string variant;
    if (!entry.y0.empty()) variant = fmt::format("y0=({}) ", fmt::join(entry.y0, " "));
    if (entry.derivatives != Derivatives::own) variant += "jacobian by differences ";
    for (std::size_t i = first_case; i < plan.cases.size(); ++i) plan.cases[i].setting.insert(0, variant);
  }
  return plan;
}

namespace {

AccuracyRow named_row(const AccuracyCase& one, const Problem& problem) {
  return {.problem = problem.id, .method = one.method.id, .setting = one.setting};
}

AccuracyRow run_case(const AccuracyCase& one, const Problem& problem, const Reference& reference) {
  AccuracyRow row = named_row(one, problem);
  double largest = 0;
  const RunRecord record =
      one.method.bind(problem).run(one.spec, [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
        const double error = (y - reference.at(t)).cwiseAbs().maxCoeff();
        if (!(error <= largest)) largest = error;
      });
  const bool reached = record.outcome == Outcome::reached_end;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  row.outcome = to_string(record.outcome);
  row.error_end = reached ? (record.y - reference.at(one.spec.t_end)).cwiseAbs().maxCoeff() : nan;
  row.error_samples = reached ? largest : nan;
  row.steps = record.stats.steps;
  row.rejected = record.stats.rejected;
  row.rhs = record.stats.rhs;
  row.jacobian = record.stats.jacobian;
  row.factorisations = record.stats.factorisations;
  row.newton = record.stats.newton;
  return row;
}

}  // namespace

std::vector<AccuracyRow> run_accuracy_suite(const AccuracyPlan& plan,
                                            const std::function<void(double, const std::string&)>& progress) {
  std::vector<std::optional<double>> t_end(plan.problems.size());  // nothing: no method is run on it
  for (const AccuracyCase& one : plan.cases)
    if (!t_end[one.problem]) t_end[one.problem] = one.spec.t_end;
  const auto references = parallel_map(plan.problems.size(), [&](std::size_t p) {
    return t_end[p] ? std::optional(make_reference(plan.problems[p], *t_end[p])) : std::nullopt;
  });
  std::vector<AccuracyRow> rows(plan.cases.size());
  parallel_for(
      rows.size(),
      [&](std::size_t i, std::size_t) {
        const AccuracyCase& one = plan.cases[i];
        rows[i] = run_case(one, plan.problems[one.problem], *references[one.problem]);
      },
      [&](std::size_t done) {
        const AccuracyCase& last = plan.cases[done - 1];
        if (progress)
          progress(static_cast<double>(done) / static_cast<double>(rows.size()),
                   named_row(last, plan.problems[last.problem]).name());
      },
      [] { return false; });
  return rows;
}

}  // namespace hmax
