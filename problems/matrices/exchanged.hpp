/// What is said of stiffness and mass that look exchanged.
#pragma once

#include <string_view>

namespace hmax {

inline constexpr std::string_view exchanged_matrices =
    "no entry of the stiffness is negative, and most rows of the mass sum to zero, as if both were exchanged; check "
    "which file is stiffness= and which is mass=";

}  // namespace hmax
