#include "problems/tissue/materials.hpp"

#include <stdexcept>

#include "problems/oscillator/liver_materials.hpp"

namespace hmax {
namespace {
constexpr std::string_view prefix = "liver:";
constexpr double usual_poisson = 0.45;
}  // namespace

std::vector<std::string> tissue_material_ids() {
  std::vector<std::string> ids;
  for (const LiverMaterial& material : liver_materials())
    ids.push_back(std::string(prefix) + std::string(material.id));
  return ids;
}

TissueSettings with_tissue_material(TissueSettings base, std::string_view id) {
  if (!id.starts_with(prefix)) {
    std::string known;
    for (const std::string& name : tissue_material_ids()) known += (known.empty() ? "" : ", ") + name;
    throw std::invalid_argument("there is no tissue material '" + std::string(id) + "'; use one of " + known);
  }
  const OscillatorParameters published = with_material({}, id.substr(prefix.size()));
  base.materials.assign(1, {1000 * published.k1, usual_poisson, TissueMaterial{}.density});
  base.total_mass = published.m;
  base.alpha = published.c / published.m;
  return base;
}

}  // namespace hmax
