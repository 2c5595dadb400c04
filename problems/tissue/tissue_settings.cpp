#include "problems/tissue/tissue_settings.hpp"

namespace hmax {

TissueSettings after_ramps(TissueSettings settings) {
  const auto end = [](TimeProfile& profile) {
    if (profile.kind == TimeProfile::Kind::ramp) profile = {};
  };
  for (Support& support : settings.supports) end(support.profile);
  for (PressingForce& load : settings.forces) end(load.profile);
  for (SphereTool& tool : settings.tools) end(tool.profile);
  return settings;
}

}  // namespace hmax
