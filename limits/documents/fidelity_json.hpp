/// What steps show of a material, for programs: the rows of `hmax fidelity --json`.
#pragma once

#include <nlohmann/json.hpp>

#include "limits/fidelity/fidelity.hpp"

namespace hmax {

nlohmann::ordered_json to_json(const Fidelity& row);

}  // namespace hmax
