#include "problems/oscillator/liver_materials.hpp"

#include <array>
#include <stdexcept>

namespace hmax {
namespace {

constexpr std::array<LiverMaterial, 6> materials{{{"male_slim", 4.6, 5, 1.4, 1.5},
                                                  {"male_normal", 5.3, 6, 1.4, 1.5},
                                                  {"male_fat", 6.7, 8, 1.4, 1.5},
                                                  {"female_slim", 4.3, 4.5, 1.2, 1.4},
                                                  {"female_normal", 5.1, 6, 1.2, 1.4},
                                                  {"female_fat", 6.6, 8, 1.2, 1.4}}};

}  // namespace

std::span<const LiverMaterial> liver_materials() { return materials; }

const LiverMaterial& liver_material(std::string_view id) {
  const auto colon = id.find(':');
  const auto name = id.substr(0, colon);
  if (colon != id.npos) {
    const auto suffix = id.substr(colon + 1);
    if (suffix != "light" && suffix != "heavy")
      throw std::invalid_argument("material '" + std::string(id) +
                                  "' has the unknown suffix ':" + std::string(suffix) +
                                  "'; use :light or :heavy for the ends of the mass range, or no suffix");
  }
  return liver_item(liver_materials(), name, "material");
}

OscillatorParameters with_material(OscillatorParameters base, std::string_view id) {
  const auto& material = liver_material(id);
  base.m = id.ends_with(":light")   ? material.mass_low
           : id.ends_with(":heavy") ? material.mass_high
                                    : material.mass_middle();
  base.c = material.damping;
  base.k1 = material.stiffness;
  return base;
}

}  // namespace hmax
