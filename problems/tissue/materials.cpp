#include "problems/tissue/materials.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "problems/oscillator/liver_materials.hpp"

namespace hmax {
namespace {
constexpr std::string_view prefix = "liver:";
constexpr double usual_poisson = 0.45;

/// E [Pa] and its spread, rho [kg/m^3], nu. Arda, Roulot, Samani, Budday: mean and one standard deviation.
constexpr PublishedTissue measured(std::string_view id, double young, double density, double young_low,
                                   double young_high, std::string_view source, std::string_view note,
                                   double poisson = usual_poisson) {
  return {id, {young, poisson, density}, young_low, young_high, source, note};
}

constexpr auto tissues = std::to_array<PublishedTissue>({
    measured("tissue:liver", 5500, 1060, 3900, 7100, "roulot2008liver", "healthy, transient elastography"),
    measured("tissue:kidney", 5000, 1050, 2100, 7900, "arda2011quantitative",
             "cortex, shear-wave elastography"),
    measured("tissue:spleen", 2900, 1060, 1100, 4700, "arda2011quantitative", "shear-wave elastography"),
    measured("tissue:pancreas", 4800, 1040, 1800, 7800, "arda2011quantitative", "shear-wave elastography"),
    measured("tissue:thyroid", 10970, 1050, 7870, 14070, "arda2011quantitative", "shear-wave elastography"),
    measured("tissue:muscle", 11100, 1050, 7000, 15200, "arda2011quantitative",
             "gastrocnemius at rest, shear-wave elastography"),
    measured("tissue:heart", 25200, 1050, 14700, 27400, "kossivas2013regional",
             "passive, murine left ventricle, indentation"),
    measured("tissue:brain_grey", 1389, 1040, 1100, 1678, "budday2015mechanical", "bovine, indentation"),
    measured("tissue:brain_white", 1895, 1040, 1303, 2487, "budday2015mechanical", "bovine, indentation"),
    measured("tissue:fat", 3250, 950, 2340, 4160, "samani2007elastic", "of the breast, indentation"),
    measured("tissue:breast_gland", 3240, 1020, 2630, 3850, "samani2007elastic",
             "fibroglandular, indentation"),
    measured("tissue:fibroadenoma", 6410, 1020, 3550, 9270, "samani2007elastic",
             "benign tumour of the breast, indentation; density of the gland"),
    measured(
        "tissue:carcinoma", 19990, 1020, 10400, 42520, "samani2007elastic",
        "invasive ductal, intermediate grade, indentation; means of low and high grade; density of the gland"),
    measured("tissue:skin", 344e3, 1090, 195e3, 480e3, "sutradhar2013vivo", "of the breast, suction"),
    measured("tissue:epidermis", 1.5e6, 1090, 1e6, 2e6, "geerligs2011vitro", "indentation; density of skin"),
    measured("tissue:cartilage", 639e3, 1100, 420e3, 859e3, "soltz2000conewise",
             "bovine, equilibrium in compression, from the aggregate modulus 0.64 MPa", 0.03),
    measured("tissue:tendon", 1.16e9, 1120, 1.01e9, 1.31e9, "maganaris2002tensile",
             "gastrocnemius, along its fibres at maximum load, here in all directions; density assumed"),
});
}  // namespace

std::span<const PublishedTissue> published_tissues() { return tissues; }

const PublishedTissue* find_published_tissue(std::string_view id) {
  const auto* const found = std::ranges::find(tissues, id, &PublishedTissue::id);
  return found == tissues.end() ? nullptr : found;
}

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
