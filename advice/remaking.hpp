/// Problems of the catalogue made again with changes.
#pragma once

#include <string>

#include "advice/advise.hpp"

namespace hmax {

/// How the problem of make_problem(id, settings) is made again: with other parameters and, of a body, on
/// other meshes.
Remaking remaking(const std::string& id, const ProblemSettings& settings);

}  // namespace hmax
