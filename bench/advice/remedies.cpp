#include <algorithm>

#include "bench/advice/advise.hpp"
#include "problems/tissue/body.hpp"
#include "results/errors.hpp"

namespace hmax {

namespace {

/// Those that came nearest: what fails for all of these fails for the others.
std::vector<Method> nearest_methods(const Advice& failed) {
  constexpr std::size_t most = 4;
  std::vector<const AdviceRow*> rows;
  for (const AdviceRow& row : failed.rows)
    if (row.frame.p50 > 0) rows.push_back(&row);
  std::ranges::stable_sort(rows, {}, [](const AdviceRow* row) {
    return row->frame.p50 * (row->verdict == AdviceVerdict::too_slow ? 1 : 100);
  });
  std::vector<Method> methods;
  for (const AdviceRow* row : rows)
    if (methods.size() < most && std::ranges::find(methods, row->candidate.method.id, &Method::id) == methods.end())
      methods.push_back(row->candidate.method);
  return methods;
}

}  // namespace

std::vector<Remedy> remedies(const Problem& problem, const AdviceQuestion& question, const Advice& failed,
                             const ProblemWith& make, const AdviceWatcher& watcher) {
  std::vector<Remedy> found;
  AdviceQuestion quick = question;
  quick.frames = std::min<std::size_t>(question.frames, 100);
  quick.methods = nearest_methods(failed);
  if (quick.methods.empty()) return found;
  const auto try_one = [&](const std::string& change, double from, double to,
                           const std::function<Problem()>& changed) {
    try {
      const Advice advice = advise(changed(), quick, watcher);
      const AdviceRow* row = advice.recommended();
      if (row) found.push_back({change, from, to, row->candidate.words(), row->h});
      return row != nullptr;
    } catch (const InputError&) {
      return false;  // no such model, or no reference there either
    }
  };
  if (question.frame_budget() < question.frame()) {
    quick.budget.reset();
    const Advice whole_frame = advise(problem, quick, watcher);
    if (const AdviceRow* row = whole_frame.recommended())
      found.push_back({"budget_ms", 1e3 * question.frame_budget(), 1.1e3 * row->frame.p99, row->candidate.words(), row->h});
    quick.budget = question.budget;
  }
  for (const double divisor : {2.0, 5.0, 10.0, 20.0, 50.0}) {
    quick.rate = question.rate / divisor;
    if (try_one("rate", question.rate, quick.rate, [&] { return problem; })) break;
  }
  quick.rate = question.rate;
  if (!problem.body) return found;
  for (const auto& [name, factors] : {std::pair<std::string, std::vector<double>>{"rho", {4, 16}}, {"E", {0.25, 0.0625}}}) {
    const auto parameter =
        std::ranges::find(problem.parameters, name, &std::pair<std::string, double>::first);
    if (parameter == problem.parameters.end() || !(parameter->second > 0)) continue;
    for (const double factor : factors)
      if (try_one(name, parameter->second, factor * parameter->second, [&] { return make({{name, factor * parameter->second}}); }))
        break;
  }
  return found;
}

}  // namespace hmax
