/// The fastest mode of a body at rest in words.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace hmax {

/// The element that owns it, bounds of it, and what changes would gain.
/// @param mode  of fastest_mode_json()
std::string fastest_mode_in_words(const nlohmann::ordered_json& mode);

}  // namespace hmax
