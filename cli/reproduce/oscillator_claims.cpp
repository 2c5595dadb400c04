#include "cli/reproduce/oscillator_claims.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "studies/liver_claims.hpp"

namespace hmax {

ReportSection claims_section(const std::vector<Row>& rows) {
  std::vector<Claim> claims = claims_on_solvers(rows);
  const std::vector<Claim> motion = claims_on_motion();
  claims.insert(claims.end(), motion.begin(), motion.end());
  std::string table = "| section | sentence | judgement | found |\n| --- | --- | --- | --- |\n";
  for (const Claim& claim : claims)
    table += fmt::format("| {} | {} | **{}** | {} |\n", markdown_text(claim.section),
                         markdown_text(claim.printed), name_of(claim.judgement), markdown_text(claim.found));
  const auto count = [&](Judgement judgement) {
    return std::ranges::count(claims, judgement, &Claim::judgement);
  };
  return {.title = "The sentences of the study, tested",
          .text = fmt::format(
              "{} sentences can be tested: {} hold, {} hold in part, {} do not hold. Sentences and "
              "judgements are made of runs; those on time are of the machine named above.\n\n{}",
              claims.size(), count(Judgement::holds), count(Judgement::holds_in_part),
              count(Judgement::does_not_hold), table)};
}

ReportSection defaults_section() {
  std::string table =
      "| solver | rtol | atol | steps | rejected | evaluations | largest error |\n"
      "| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const SolverWork& work : work_at_defaults())
    table +=
        fmt::format("| {} | {:g} | {:g} | {} | {} | {} | {:.2g} |\n", markdown_text(work.method), work.rtol,
                    work.atol, work.stats.steps, work.stats.rejected, work.stats.rhs, work.error);
  return {
      .title = "Tolerances: MATLAB's defaults beside those of this report",
      .text =
          "The study names no tolerances, so MATLAB's defaults were in force: rtol = 1e-3, atol = 1e-6, with "
          "MATLAB's rules for the next step. The other sections take 1e-6 for both and the control of hmax. One run "
          "of the full model to t = 100 s; errors of x [m] and v [m/s] at the steps.\n\n" +
          table,
      .printed = "Nothing.",
      .differs = "Orders of magnitude in the error, for a few times the work."};
}

}  // namespace hmax
