#include "advice/advice.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "catalogue/models/model.hpp"
#include "core/numbers.hpp"
#include "limits/rows/model_digest.hpp"

namespace hmax {

std::string error_scale(const Problem& problem) {
  return problem.body ? "largest displacement" : "range of each state";
}

std::string_view name_of(AdviceBound bound) {
  constexpr std::array<std::string_view, 5> names{"stability", "accuracy", "newton", "budget", "rate"};
  return names[static_cast<std::size_t>(bound)];
}

std::string_view name_of(AdviceVerdict verdict) {
  constexpr std::array<std::string_view, 7> names{"recommended", "tie",      "suitable", "unstable",
                                                  "inaccurate",  "too_slow", "predicted"};
  return names[static_cast<std::size_t>(verdict)];
}

std::string_view name_of(AdviceStage stage) {
  constexpr std::array<std::string_view, 7> names{"predicting", "searching", "timing", "proving",
                                                  "observing",  "remedies",  "done"};
  return names[static_cast<std::size_t>(stage)];
}

double steps_to_meet(const AdviceRow& row, double tolerance) {
  if (std::isnan(row.error)) return 1;
  if (row.error > 1) return 2;
  const double order = std::max(1, row.candidate.method.order);
  return std::max(1.0, std::pow(row.error / tolerance, 1 / order));
}

double time_to_meet(const AdviceRow& row, double tolerance) {
  return row.frame_time() * steps_to_meet(row, tolerance);
}

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
    static_cast<StepFindings&>(record) = row;
    record.method = row.candidate.method.id;
    record.options = row.candidate.options();
    record.bound = name_of(row.bound);
    record.verdict = name_of(row.verdict);
    record.stage = name_of(advice.stage);
    record.steps_per_frame = static_cast<double>(row.steps_per_frame);
    record.frame_p50 = row.frame.p50;
    record.frame_p99 = row.frame.p99;
    record.frame_max = row.frame.max;
    for (const double time : row.frame.tail)
      record.frame_tail += (record.frame_tail.empty() ? "" : " ") + to_text(time);
    record.frames = static_cast<double>(row.frames);
    record.missed = static_cast<double>(row.missed);
    record.memory = row.memory ? static_cast<double>(*row.memory) : AdviceRecord::none;
  }
  return records;
}

}  // namespace hmax
