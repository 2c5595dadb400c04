/// Reads scenes of other programs: a subset of each format, and what is not in it is refused by name.
#pragma once

#include <string>
#include <string_view>

#include "catalogue/scenes/scene.hpp"

namespace hmax {

/// @param text  "m,kg,s", "mm,t,s": names, or numbers of metres, kilograms and seconds
/// @throws InputError  for another form, and for unknown units
SceneUnits scene_units(std::string_view text);

/// Reads CalculiX and Abaqus .inp: *NODE, *ELEMENT of C3D4, *NSET, *ELSET, *SOLID SECTION; *MATERIAL with
/// *ELASTIC, *DENSITY and *DAMPING; *BOUNDARY that fixes directions 1 to 3; *DLOAD of GRAV; one *STEP with
/// *DYNAMIC, *STATIC or *FREQUENCY.
/// @param units   like "mm,t,s"; must be given
/// @param ignored  keywords whose parts that are not understood are left out, "CLOAD,BOUNDARY"
/// @throws InputError  one sentence with file, line and remedy
Scene read_scene(const std::string& file, std::string_view units, std::string_view ignored);

}  // namespace hmax
