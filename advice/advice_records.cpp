#include "advice/advice_records.hpp"

#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"
#include "limits/rows/model_digest.hpp"

namespace hmax {

AdviceKey advice_key(const Problem& problem, const AdviceQuestion& question, const Advice& advice) {
  return {.problem = problem.id,
          .material = problem.material,
          .parameters = describe(problem.parameters),
          .y0 = start_in_words(problem),
          .model = model_digest(problem),
          .motion = advice.motion,
          .ranked_by = question.least_error ? "error" : "cost",
          .rate = question.rate,
          .tolerance = question.tolerance,
          .budget = question.frame_budget()};
}

std::vector<AdviceRecord> advice_records(const Advice& advice) {
  std::vector<AdviceRecord> records;
  for (const AdviceRow& row : advice.rows) {
    AdviceRecord& record = records.emplace_back();
    record.method = row.candidate.method.id;
    record.options = row.candidate.options();
    record.bound = name_of(row.bound);
    record.verdict = name_of(row.verdict);
    record.status = row.status;
    record.stage = name_of(advice.stage);
    record.h = row.h;
    record.steps_per_frame = static_cast<double>(row.steps_per_frame);
    record.h_max = row.h_max;
    record.h_max_observed = row.h_max_observed;
    record.h_accurate = row.h_accurate;
    record.error = row.error;
    record.frame_p50 = row.frame.p50;
    record.frame_p99 = row.frame.p99;
    record.frame_max = row.frame.max;
    record.first_frame = row.first_frame;
    for (const double time : row.frame.tail)
      record.frame_tail += (record.frame_tail.empty() ? "" : " ") + to_text(time);
    record.frames = static_cast<double>(row.frames);
    record.missed = static_cast<double>(row.missed);
    record.newton_per_frame = row.newton_per_frame;
    record.linear_per_frame = row.linear_per_frame;
    record.memory = row.memory ? static_cast<double>(*row.memory) : AdviceRecord::none;
    record.stiffening = row.stiffening;
  }
  return records;
}

}  // namespace hmax
