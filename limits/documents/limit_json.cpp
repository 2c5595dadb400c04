#include "limits/documents/limit_json.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"
#include "core/text/sentences.hpp"
#include "limits/documents/number_json.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

/// A mode by the numbers of a row; NaN where there is none.
Json mode_json(double re, double im, double omega, double zeta, double rate_fast, double rate_slow) {
  const auto number = [](double value) { return std::isnan(value) ? Json() : Json(value); };
  Json document{{"re", re}, {"im", im}, {"omega", number(omega)}, {"zeta", number(zeta)}};
  const bool has_rates = !std::isnan(rate_fast);
  if (has_rates) document["rates"] = {rate_fast, rate_slow};
  if (std::isnan(omega))
    document["status"] = has_rates ? "negative stiffness has no natural frequency"
                                   : "a real eigenvalue without a known partner has no natural frequency";
  else if (std::isnan(zeta))
    document["status"] = "without stiffness there is no damping ratio";
  return document;
}

Json mode_json(const Mode& mode) {
  const auto rates = mode.rates.value_or(std::array{LimitRow::none, LimitRow::none});
  return mode_json(mode.lambda.real(), mode.lambda.imag(), mode.omega.value_or(LimitRow::none),
                   mode.zeta.value_or(LimitRow::none), rates[0], rates[1]);
}

/// The largest step that runs of the motion showed to be safe.
Json safe_json(const LimitRow& row) {
  if (!std::isnan(row.safe()))
    return {{"h", row.safe()}, {"how", "runs"}, {"fails_beyond", row.safe() == row.from_start}};
  Json document{{"h", nullptr}, {"how", nullptr}};
  if (std::isnan(row.from_start_stride))
    document["status"] = "no run from the start of the motion was made; --verify makes them";
  else if (row.bound != name_of(Bound::error_control))
    document["status"] =
        "no run from the start of the motion tells: too few or too many steps, the shortest one fails, or nothing moves";
  return document;
}

}  // namespace

Json details_json(const Prediction& prediction) {
  // Of large models those with the least margins.
  constexpr std::size_t most_modes = 50;
  std::vector<ModeMargin> shown = prediction.modes;
  if (shown.size() > most_modes) {
    std::ranges::stable_sort(shown, {}, &ModeMargin::h_max);
    shown.resize(most_modes);
  }
  Json modes = Json::array();
  for (const ModeMargin& margin : shown) {
    Json mode = mode_json(margin.mode);
    mode["h_max"] = number_or_word(margin.h_max);
    modes.push_back(std::move(mode));
  }
  Json details{{"modes", std::move(modes)}};
  if (prediction.growing) {
    const Complex lambda = prediction.growing->lambda;
    details["growth"] = {
        {"re", lambda.real()}, {"im", lambda.imag()}, {"doubling_time", std::numbers::ln2 / lambda.real()}};
  }
  return details;
}

Json options_json(const std::optional<StepChoices>& options) {
  if (!options) return nullptr;
  return {{"jacobian", to_string(options->jacobian)}, {"linear", to_string(options->linear)}};
}

Json tolerances_json(const MotionTolerances& tolerances) {
  Json document{{"rtol", tolerances.rtol}, {"atol", tolerances.atol}};
  if (tolerances.has_velocities) document["atol_velocities"] = tolerances.atol_velocities;
  return document;
}

std::string words_of_growth(const LimitRow& row) {
  if (std::isnan(row.along_grows_from)) return {};
  return row.point.path == "load"
             ? fmt::format(
                   "the body buckles between {} and {} of the load: the stiffness of its equilibrium has a negative "
                   "eigenvalue from there on; take less load, or look where it goes with `--along motion`",
                   short_number(std::max(0.0, row.along_grows_from - 1.0 / load_strides), 4),
                   short_number(row.along_grows_from, 4))
             : fmt::format(
                   "the tangent grows on {} % of the motion, from t = {} s on, where neighbours part "
                   "whatever the step",
                   short_number(100 * row.along_growing, 3), short_number(row.along_grows_from, 4));
}

Json path_json(const TrajectoryLimit& along, const LimitRow& row, const Problem& problem) {
  const bool of_load = row.point.path == "load";
  Json document{{"h_min", number_or_word(along.least)}, {of_load ? "share" : "t", along.t_least}};
  Json path = Json::array();
  for (std::size_t i = 0; i < along.t.size(); ++i)
    path.push_back({along.t[i], number_or_word(along.h_max[i])});
  // The states of bodies are long, and those of linear models do not matter.
  const bool of_matrices = problem.matrices != nullptr;
  const Eigen::VectorXd& y = along.y_least;
  if (problem.body)
    document["max_displacement"] = largest_displacement(y.head(y.size() / 2));
  else if (!of_matrices)
    document["y"] = std::vector<double>(y.begin(), y.end());
  document["growing_share"] = along.growing;
  if (!of_load && !of_matrices) document["tolerances"] = tolerances_json(along.tolerances);
  document["path"] = std::move(path);
  const std::string status = joined(words_of_growth(row), row.path_note);
  if (!status.empty()) document["status"] = status;
  return document;
}

Json to_json(const LimitRow& row, const std::string& state_status,
             const std::vector<std::pair<std::string, double>>& parameters) {
  Json details = Json::parse(row.details);
  const bool seen = row.is_observed();
  Json document{{"problem", row.point.problem},
                {"material", row.point.material},
                {"method", id_in(row.method)},
                {"h_max", number_or_word(row.h_max)},
                {"h_unstable", number_or_word(row.h_unstable)},
                {"bound", row.bound},
                {"limiting", std::isnan(row.re) ? Json()
                                                : mode_json(row.re, row.im, row.omega, row.zeta,
                                                            row.rate_fast, row.rate_slow)},
                {"observed", number_or_word(row.observed)},
                {"gap", number_or_null(row.gap)},
                {"steps_used", seen ? Json(static_cast<std::int64_t>(row.steps_used)) : Json()},
                {"agrees", seen ? Json(row.verdict == "confirmed") : Json()},
                {"step_defect", seen ? number_or_word(row.step_defect) : Json()},
                {"modes", std::move(details["modes"])},
                {"state_kind", row.state_kind},
                {"state", row.state},
                {"parameters", parameters_json(parameters)}};
  if (details.contains("growth")) document["growth"] = std::move(details["growth"]);
  if (details.contains("options")) document["options"] = std::move(details["options"]);
  if (!row.newton.empty())
    document["newton_step"] = {{"h", row.newton_h},
                               {"is_limit", row.newton == "limit"},
                               {"error_mm", number_or_null(1000 * row.newton_error)},
                               {"error_bound_mm", number_or_null(1000 * row.newton_error_bound)}};
  const std::string status = joined(state_status, row.note);
  if (!status.empty()) document["status"] = status;
  if (details.contains("along")) document["along"] = std::move(details["along"]);
  if (row.point.path == "motion") document["safe"] = safe_json(row);
  if (!std::isnan(row.from_start)) {
    document["observed_from_start"] = number_or_word(row.from_start);
    document["observed_from_start_stride"] = row.from_start_stride;
  }
  return document;
}

}  // namespace hmax
