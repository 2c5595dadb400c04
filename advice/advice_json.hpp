/// The answer of `hmax advise` for programs.
#pragma once

#include "advice/advise.hpp"
#include "results/json.hpp"

namespace hmax {

/// The document of docs/reference/commands/advise.md.
/// @param interrupted  the search was
Json advice_json(const Problem& problem, const AdviceQuestion& question, const Advice& advice,
                 bool interrupted);

}  // namespace hmax
