#include "advice/advice_json.hpp"

#include <cmath>
#include <optional>

#include "limits/documents/model_json.hpp"
#include "limits/documents/number_json.hpp"
#include "results/fingerprint.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

/// What runs the motions, as `hmax run --device gpu` tells it; null: the processor.
Json device_json(const AdviceQuestion& question) {
  if (!question.device) return nullptr;
  const DeviceFacts facts = question.device->facts();
  return {{"device", facts.name}, HMAX_KEYS(facts, clock_mhz, driver), {"precision", "double"}};
}

/// An inverted element; null where there is none.
Json to_json(const std::optional<Inversion>& inversion) {
  if (!inversion) return nullptr;
  return {HMAX_KEYS(*inversion, tetrahedron, t, volume)};
}

Json to_json(const std::optional<OtherModel>& other) {
  if (!other) return nullptr;
  return {{"model", other->id},
          HMAX_KEYS(*other, load_share, gravity_share, scale),
          {"inverted", to_json(other->inversion)}};
}

/// @param load  of the recommended row; else empty
Json margin_json(double stiffening, const LoadMargin* load) {
  Json margin{{"stiffening", number_or_word(stiffening)}};
  if (!load) return margin;
  margin["load"] = number_or_word(load->holds);
  margin["load_fails"] = number_or_word(load->fails);
  margin["displacement"] = number_or_word(load->displacement);
  margin["load_limited_by"] = load->of_model ? Json(*load->of_model ? "model" : "step") : Json();
  margin["inverted"] = to_json(load->inversion);
  return margin;
}

Json to_json(const AdviceRow& row, const AdviceQuestion& question, const std::string& error_of,
             const LoadMargin* load = nullptr) {
  const auto numbers = [](const std::vector<double>& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(number_or_word(value));
    return list;
  };
  Json options = parameters_json(row.candidate.method.parameters);
  if (row.candidate.method.needs_jacobian) {
    options["jacobian"] = to_string(row.candidate.jacobian);
    options["linear"] = to_string(row.candidate.linear_solve);
  }
  if (!std::isnan(row.newton_per_frame)) options["iterations"] = row.newton_per_frame;
  if (!std::isnan(row.linear_per_frame)) options["linear_iterations"] = row.linear_per_frame;
  return {{"method", row.candidate.method.id},
          {"options", std::move(options)},
          {"h", number_or_word(row.h)},
          {"steps_per_frame", row.steps_per_frame},
          {"h_max", number_or_word(row.h_max)},
          {"h_max_observed", number_or_word(row.h_max_observed)},
          {"h_accurate", number_or_word(row.h_accurate)},
          {"bound", name_of(row.bound)},
          {"error", number_or_word(row.error)},
          {"error_of", error_of},
          {"frame_ms",
           {{"p50", number_or_word(1e3 * row.frame.p50)},
            {"p99", number_or_word(1e3 * row.frame.p99)},
            {"max", number_or_word(1e3 * row.frame.max)},
            {"first", number_or_word(1e3 * row.first_frame)},
            {"expected", number_or_word(1e3 * row.expected_frame)}}},
          HMAX_KEYS(row, missed, frames, disturbed),
          {"realtime_factor", number_or_word(row.realtime_factor(question.rate))},
          {"memory_bytes", json_or_null(row.memory)},
          {"damping_added", numbers(row.damping_added)},
          {"frequency_shift", numbers(row.frequency_shift)},
          {"stiffness_shown", number_or_word(row.stiffness_shown)},
          {"stiffness_ceiling", number_or_word(row.stiffness_ceiling)},
          {"margin", margin_json(row.stiffening, load)},
          {"verdict", name_of(row.verdict)},
          {"status", row.status}};
}

Json to_json(const std::vector<ProofRun>& proof) {
  Json list = Json::array();
  for (const ProofRun& run : proof)
    list.push_back({HMAX_KEYS(run, motion, seconds, stable),
                    {"neighbours_part", run.parts},
                    {"inverted", to_json(run.inversion)},
                    HMAX_KEYS(run, frames, missed, disturbed),
                    {"frame_ms_p999", number_or_word(1e3 * run.frame_p999)}});
  return list;
}

/// @param h_max  that the bands are of [s]
Json to_json(const std::vector<LimitBand>& bands, double h_max) {
  Json list = Json::array();
  for (const LimitBand& band : bands)
    list.push_back({HMAX_KEYS(band, quantity, spread),
                    {"h_max_low", band.low * h_max},
                    {"h_max_high", band.high * h_max},
                    {"exponent", band.exponent}});
  return list;
}

}  // namespace

Json advice_json(const Problem& problem, const AdviceQuestion& question, const Advice& advice,
                 bool interrupted) {
  Json rows = Json::array(), ties = Json::array(), remedies = Json::array();
  const AdviceRow* best = advice.recommended();
  for (const AdviceRow& row : advice.rows) {
    rows.push_back(
        to_json(row, question, error_scale(problem), &row == best ? &advice.load_margin : nullptr));
    if (row.verdict == AdviceVerdict::tie) ties.push_back(row.candidate.words());
  }
  for (const Remedy& remedy : advice.remedies)
    remedies.push_back({HMAX_KEYS(remedy, change, from, to, cost), {"then", {HMAX_KEYS(remedy, method, h)}}});
  Json document{
      {"model", problem.id},
      {"material", problem.material},
      {"parameters", parameters_json(problem.parameters)},
      HMAX_KEYS(advice, motion, load_share, gravity_share, scale, reference_error),
      {"inverted", to_json(advice.inversion)},
      {"other_model", to_json(advice.other_model)},
      {"suggested_support", suggested_support_json(advice.suggested_support)},
      {"modes", advice.modes},
      HMAX_KEYS(question, rate, tolerance),
      {"budget_ms", 1e3 * question.frame_budget()},
      {"machine", summary(fingerprint())},
      {"device", device_json(question)},
      {"rows", std::move(rows)},
      {"long_runs", to_json(advice.proof)},
      {"proof", to_json(advice.proof)},  // the old name
      {"uncertainty", to_json(advice.bands, best ? best->h_max : AdviceRow::none)},
      {"recommended", best ? to_json(*best, question, error_scale(problem), &advice.load_margin) : Json()},
      {"ties", std::move(ties)},
      {"remedies", std::move(remedies)},
      {"all_tried", advice.all_tried},
      {"within", number_or_word(question.within)},
      HMAX_KEYS(advice, seconds, out_of_time)};
  if (interrupted) document["interrupted"] = true;
  if (interrupted || advice.out_of_time) document["stage"] = name_of(advice.stage);
  return document;
}

}  // namespace hmax
