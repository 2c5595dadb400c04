/// CalculiX's and Abaqus' .inp as a body.
#pragma once

#include <string>
#include <string_view>

#include "catalogue/scenes/scene_parts.hpp"

namespace hmax {

/// @throws InputError, std::invalid_argument  one sentence with file, line and remedy
Scene inp_scene(const std::string& file, std::string_view bytes, const SceneUnits& units,
                IgnoredParts& ignored);

}  // namespace hmax
