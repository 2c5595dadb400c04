#include "problems/tissue/tissue_settings.hpp"

#include <cmath>

namespace hmax {

TissueSettings after_ramps(TissueSettings settings) {
  const auto end = [](TimeProfile& profile, Eigen::Vector3d& full) {
    if (profile.kind != TimeProfile::Kind::ramp) return;
    if (std::isfinite(profile.fall)) full.setZero();
    profile = {};
  };
  for (Support& support : settings.supports) end(support.profile, support.travel);
  for (PressingForce& load : settings.forces) end(load.profile, load.force);
  for (SphereTool& tool : settings.tools) end(tool.profile, tool.travel);
  return settings;
}

}  // namespace hmax
