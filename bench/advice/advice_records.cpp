#include "bench/advice/advice_records.hpp"

#include "bench/models/tissue_problem.hpp"
#include "bench/rows/model_digest.hpp"

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
  for (const AdviceRow& row : advice.rows)
    records.push_back({.key = {},
                       .method = row.candidate.method.id,
                       .options = row.candidate.options(),
                       .bound = std::string(name_of(row.bound)),
                       .verdict = std::string(name_of(row.verdict)),
                       .status = row.status,
                       .h = row.h,
                       .steps_per_frame = static_cast<double>(row.steps_per_frame),
                       .h_max = row.h_max,
                       .h_max_observed = row.h_max_observed,
                       .h_accurate = row.h_accurate,
                       .error = row.error,
                       .frame_p50 = row.frame.p50,
                       .frame_p99 = row.frame.p99,
                       .frame_max = row.frame.max,
                       .first_frame = row.first_frame,
                       .frames = static_cast<double>(row.frames),
                       .missed = static_cast<double>(row.missed),
                       .newton_per_frame = row.newton_per_frame,
                       .memory = row.memory ? static_cast<double>(*row.memory) : AdviceRecord::none,
                       .stiffening = row.stiffening,
                       .session = 0});
  return records;
}

}  // namespace hmax
