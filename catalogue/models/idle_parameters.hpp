/// Which parameters of a body on a mesh change nothing, and why.
#pragma once

#include <string>
#include <string_view>

#include "catalogue/models/tissue_parameters.hpp"

namespace hmax {

/// Why a parameter that the model and the load read changes nothing beside the others, and what to do; empty
/// where it acts.
/// @param name  of one parameter, with a region behind a colon where it has one
std::string why_idle(const TissueId& id, const TissueParameters& parameters, std::string_view name);

}  // namespace hmax
