/// Methods for programs: those of the catalogue, the stability of formulas, and the limits of foreign
/// steppers.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/amplification/limits.hpp"
#include "analysis/amplification/region.hpp"
#include "analysis/foreign_steps/own_step.hpp"
#include "analysis/foreign_steps/step_probe.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/methods/method.hpp"

namespace hmax {

/// A row of `hmax list methods --json`, docs/reference/commands/list.md.
nlohmann::ordered_json method_json(const Method& method);

/// The document of `hmax stability limits --json`, docs/reference/commands/stability_limits.md.
nlohmann::ordered_json limits_json(const Formula& formula, const StabilityLimits& limits);

/// The document of `hmax stability region --json`, docs/reference/commands/stability_region.md.
nlohmann::ordered_json region_json(const std::string& method, const PlaneWindow& window,
                                   const std::vector<RegionCurve>& curves);

/// The document of `hmax probe --json`, docs/reference/commands/probe.md.
nlohmann::ordered_json probe_json(const ProbedLimit& found);

/// What a scene's own step size adds to it.
nlohmann::ordered_json own_step_json(const OwnStep& own);

/// What hmax.fidelity of Python says of a step: of compare_steps().
/// @param load  f of the shape of the state, or empty: stiffness_shown = f.y(h0) / f.y(h) of the states of
/// rest
nlohmann::ordered_json comparison_json(const ProbedLimit& found, const Eigen::VectorXd& load);

}  // namespace hmax
