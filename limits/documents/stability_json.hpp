/// The stability of a formula for programs.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/amplification/limits.hpp"
#include "analysis/amplification/region.hpp"
#include "catalogue/methods/choice/formulas.hpp"

namespace hmax {

/// The document of `hmax stability limits --json`, docs/reference/commands/stability_limits.md.
nlohmann::ordered_json limits_json(const Formula& formula, const StabilityLimits& limits);

/// The document of `hmax stability region --json`, docs/reference/commands/stability_region.md.
nlohmann::ordered_json region_json(const std::string& method, const PlaneWindow& window,
                                   const std::vector<RegionCurve>& curves);

}  // namespace hmax
