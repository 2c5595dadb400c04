/// What steps show of a material, for programs: the rows of `hmax fidelity --json`, and of
/// `hmax stability numerical-damping --json` of a body.
#pragma once

#include <nlohmann/json.hpp>

#include "limits/fidelity/fidelity.hpp"

namespace hmax {

/// [{omega, omega_shown, zeta, zeta_shown, likeness}]
nlohmann::ordered_json modes_json(const std::vector<ShownMode>& modes);
nlohmann::ordered_json to_json(const Fidelity& row);
nlohmann::ordered_json to_json(const ShownDamping& row);
/// The document of `hmax fidelity --json`.
nlohmann::ordered_json fidelity_json(const Problem& problem, double rate, const std::vector<Fidelity>& rows);

}  // namespace hmax
