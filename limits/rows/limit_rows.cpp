#include "limits/rows/limit_rows.hpp"

#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "catalogue/models/model.hpp"
#include "limits/rows/model_digest.hpp"

namespace hmax {

namespace {

/// The word of LimitRow::verdict.
std::string_view verdict_of(const Observation& seen) {
  if (seen.confirms()) return "confirmed";
  return seen.contradicts() ? "contradicted" : "excused";
}

}  // namespace

OperatingPointKey operating_point_key(const Problem& problem, AskedState asked, std::string path,
                                      double t_end) {
  return {.problem = problem.id,
          .material = problem.material,
          .parameters = describe(problem.parameters),
          .y0 = start_in_words(problem),
          .model = model_digest(problem),
          .asked = asked == AskedState::rest ? "rest" : "equilibrium",
          .path = std::move(path),
          .t_end = t_end};
}

LimitRow limit_row(const Prediction& prediction, bool verified) {
  LimitRow row;
  row.method = prediction.method;
  row.bound = name_of(prediction.bound);
  row.state_kind = name_of(prediction.state_kind);
  row.state = prediction.state;
  row.note = prediction.note;
  row.h_max = prediction.h_max.value_or(LimitRow::none);
  row.h_unstable = prediction.unstable_from.value_or(LimitRow::none);
  if (const auto& mode = prediction.limiting) {
    row.re = mode->lambda.real();
    row.im = mode->lambda.imag();
    row.omega = mode->omega.value_or(LimitRow::none);
    row.zeta = mode->zeta.value_or(LimitRow::none);
    if (mode->rates) std::tie(row.rate_fast, row.rate_slow) = std::pair((*mode->rates)[0], (*mode->rates)[1]);
  }
  if (const auto& step = prediction.newton_step) {
    row.newton_h = step->h;
    row.newton = step->is_limit ? "limit" : "at_least";
    row.newton_error = step->error;
    row.newton_error_bound = step->error_bound;
  }
  if (const auto& seen = prediction.observed) {
    row.verdict = verdict_of(*seen);
    row.observed = seen->h_max;
    row.gap = seen->gap;
    row.steps_used = static_cast<double>(seen->steps);
    row.step_defect = seen->step_defect;
  } else if (verified) {
    row.verdict = "not_run";
  }
  return row;
}

void add_path(LimitRow& row, const TrajectoryLimit& along, const std::string& note) {
  row.along_least = along.least;
  row.along_at = along.t_least;
  row.along_growing = along.growing;
  row.along_grows_from = along.grows_from;
  row.path_note = note;
  if (along.note.empty()) return;
  row.path_note += fmt::format("{}{} the path no limit is known: {}", note.empty() ? "" : "; ",
                               std::isnan(along.least) ? "along" : "on parts of", along.note);
}

void add_start(LimitRow& row, const StartLimit& limit) {
  row.from_start = limit.h;
  row.from_start_stride = limit.stride;
}

std::vector<LimitRow> stored_limits(const Store& store, const OperatingPointKey& key,
                                    const WantedLimit& wanted) {
  std::vector<LimitRow> rows = store.limits_at(key);
  if (rows.empty()) return rows;
  const std::string own = fingerprint().program;
  std::map<std::int64_t, bool> is_own;
  for (const Session& session : store.sessions())
    is_own[session.id] = own != "unknown" && session.fingerprint.program == own;
  std::erase_if(rows, [&](const LimitRow& row) {
    return !is_own[row.session] || (wanted.verified && row.verdict.empty()) ||
           (wanted.from_start && std::isnan(row.from_start_stride)) ||
           (wanted.details && row.details == "{}");
  });
  return rows;
}

}  // namespace hmax
