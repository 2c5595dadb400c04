/// From bodies and their motions to what a page turns in space.
#pragma once

#include <string>

#include "advice/motion/motion_limits.hpp"
#include "plots/pages/body_scene.hpp"

namespace hmax {

/// A body on its probing motion, with the fastest mode at rest, which limits explicit steps, and the slowest
/// at the start of the motion where it takes no longer than a second.
/// @param model  of a body: AnalysedModel::motion has one
/// @returns JSON of scene_text(); empty for a body whose surface is too large for a page
std::string body_scene_text(const AnalysedModel& model);

}  // namespace hmax
