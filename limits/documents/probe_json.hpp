/// The limit of a foreign stepper for programs.
#pragma once

#include <nlohmann/json.hpp>

#include "analysis/foreign_steps/step_probe.hpp"

namespace hmax {

/// The document of `hmax probe --json`, docs/reference/commands/probe.md.
nlohmann::ordered_json probe_json(const ProbedLimit& found);

}  // namespace hmax
