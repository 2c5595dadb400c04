/// The answer of `hmax advise` for programs.
#pragma once

#include <nlohmann/json.hpp>

#include "advice/advise.hpp"

namespace hmax {

/// The document of docs/reference/commands/advise.md.
/// @param interrupted  the search was
nlohmann::ordered_json advice_json(const Problem& problem, const AdviceQuestion& question,
                                   const Advice& advice, bool interrupted);

}  // namespace hmax
