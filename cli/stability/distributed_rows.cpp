#include "cli/stability/distributed_rows.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/bodies/body_words.hpp"
#include "cli/stability/limit_answer.hpp"
#include "core/errors.hpp"
#include "limits/distributed/distributed_problem.hpp"
#include "limits/distributed/limits_from_ends.hpp"
#include "limits/distributed/query_distributed.hpp"
#include "problems/matrices/exchanged.hpp"

namespace hmax {

namespace {

std::string words_of(const StructureEnds& ends, const DistributedEngine& engine) {
  return fmt::format(
      "{} unknowns on {} {}, {} entries of stiffness, {}; {}\nfastest mode {:.6g} rad/s, residual {:.1g} ({}, {} restarts)\n",
      ends.unknowns, engine.ranks(), engine.ranks() == 1 ? "process" : "processes", ends.entries,
      ends.coupled_mass ? "a mass that couples unknowns" : "a mass for each unknown", engine.version(),
      std::sqrt(std::max(ends.kappa_max, 0.0)), ends.residual, ends.solver, ends.iterations);
}

}  // namespace

void print_distributed_limits(DistributedEngine& engine, const ProblemChoice& choice,
                              const MethodsChoice& methods, bool verified, Console& console) {
  DistributedProblem asked;
  engine.together([&] { asked = distributed_problem(choice.id(), choice.settings()); });
  for (const std::string& sentence : asked.remarks) console.remark(sentence);
  if (asked.body)
    for (const std::string& sentence : unusual_values(*asked.body)) console.remark(sentence);
  // Before minutes are spent on eigenvalues: whatever they are, the methods are the same.
  StructureEnds any;
  any.kappa_max = 1;
  const std::vector<Method> chosen = methods.methods({pair_with_ends(choice.id(), any)}, console);
  if (verified) require_steps(chosen);
  const std::unique_ptr<DistributedModel> model = engine.read(std::move(asked.structure));
  const StructureEnds& ends = model->ends();
  if (ends.look_exchanged) console.remark(exchanged_matrices);
  std::vector<Problem> pair{pair_with_ends(choice.id(), ends)};
  if (asked.body) pair[0].parameters = asked.parameters;
  pair[0].material = choice.material;
  const LimitQuestion question{.at = AskedState::rest, .verify = verified};
  const LimitAnswer answer = query_distributed(engine, *model, pair[0], asked.body, chosen, verified,
                                               [] { return interrupt_flag().load(); });
  if (answer.stopped) throw Interrupted{};
  judge(answer, question, console);
  if (console.json)
    console.print_json(answer_json(answer, pair));
  else
    console.print(words_of(answer, question, pair, console,
                           (asked.body ? in_words(*asked.body) + "\n" : "") + words_of(ends, engine)));
  console.flush();
}

}  // namespace hmax
