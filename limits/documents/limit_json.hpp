/// Limits of the step for programs: the keys of `hmax stability predict --json`.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "limits/along/trajectory_limit.hpp"
#include "limits/by_steps/step_map.hpp"
#include "limits/point/prediction.hpp"
#include "results/limit_row.hpp"

namespace hmax {

/// LimitRow::details of a prediction: the margins of its modes, of many the least.
nlohmann::ordered_json details_json(const Prediction& prediction);
/// {jacobian, linear} of a method that has them; null of others.
nlohmann::ordered_json options_json(const std::optional<StepChoices>& options);

/// The key `along` of these details: the path with the limit at each state.
/// @param row  with the limit along the path
nlohmann::ordered_json path_json(const TrajectoryLimit& along, const LimitRow& row, const Problem& problem);

nlohmann::ordered_json tolerances_json(const MotionTolerances& tolerances);

/// Where on the path of a row tangents grow, so that the limits there are those of no step; empty where none
/// does.
std::string words_of_growth(const LimitRow& row);

/// A row.
/// @param state_status  status_of_state() of its model
nlohmann::ordered_json to_json(const LimitRow& row, const std::string& state_status,
                               const std::vector<std::pair<std::string, double>>& parameters);

}  // namespace hmax
