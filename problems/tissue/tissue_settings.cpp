#include "problems/tissue/tissue_settings.hpp"

#include <array>
#include <stdexcept>
#include <string>

namespace hmax {
namespace {

struct Named {
  TissueModel model;
  std::string_view id;
};
constexpr std::array<Named, 5> models{{{TissueModel::mass_spring, "mass_spring"},
                                       {TissueModel::fem_cauchy, "fem_cauchy"},
                                       {TissueModel::fem_green, "fem_green"},
                                       {TissueModel::fem_corotational, "fem_corotational"},
                                       {TissueModel::fem_neo_hookean, "fem_neo_hookean"}}};

}  // namespace

TissueModel tissue_model(std::string_view id) {
  std::string known;
  for (const Named& named : models) {
    if (named.id == id) return named.model;
    known += (known.empty() ? "" : ", ") + std::string(named.id);
  }
  throw std::invalid_argument("there is no tissue model '" + std::string(id) + "'; use one of " + known);
}

std::string_view id_of(TissueModel model) {
  for (const Named& named : models)
    if (named.model == model) return named.id;
  return "";
}

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
