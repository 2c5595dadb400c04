/// Which parameters of a body on a mesh change nothing, and why.
#pragma once

#include <string>
#include <string_view>

#include "catalogue/models/tissue_parameters.hpp"

namespace hmax {

/// Readers of a parameter: these, or the names of loads with blanks between them; empty where all do.
inline constexpr std::string_view only_springs = "springs", only_elements = "elements";

/// Whether the model or the load is among the readers of a parameter.
bool is_read(std::string_view readers, const TissueId& id);
/// @throws InputError  when neither the model nor the load reads it: it would change nothing
void require_read(std::string_view parameter, std::string_view readers, const TissueId& id);

/// Why a parameter that the model and the load read changes nothing beside the others, and what to do; empty
/// where it acts.
/// @param name  of one parameter, with a region behind a colon where it has one
std::string why_idle(const TissueId& id, const TissueParameters& parameters, std::string_view name);

}  // namespace hmax
