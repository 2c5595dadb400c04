/// The liver materials of the study as tissue, and tissues as other studies have measured them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "problems/tissue/tissue_settings.hpp"

namespace hmax {

/// Names of the materials, `liver:male_slim` to `liver:female_fat`. Each takes `:light` or `:heavy` after it
/// for the ends of the published range of masses; without them its middle is meant.
std::vector<std::string> tissue_material_ids();

/// `base` made of one of these materials everywhere.
///
/// What the study publishes and what is chosen here:
///   E     = the published stiffness, printed in kPa: as a modulus it has the right unit, which it lacks in
///   the
///           oscillator (problems/oscillator/liver_materials.hpp). 4.3 to 6.7 kPa agrees with elastography of
///           healthy livers, 5.5 +- 1.6 kPa [roulot2008liver]
///   mass  = the published mass of the whole organ, whatever the volume of the mesh
///   alpha = c / m, the published damping over that mass: the whole body moving as one is damped like the
///           oscillator of the study, a'' + alpha a' + ...; beta stays that of `base`
///   nu    = 0.45, a choice: nearly incompressible; the nearer to 1/2, the stiffer linear tetrahedra become
///   (locking) density is that of liver, and only says how the mass is shared between regions; all have the
///   same here.
/// @throws std::invalid_argument  for an unknown id, naming the known ones
TissueSettings with_tissue_material(TissueSettings base, std::string_view id);

/// A tissue as a study has measured it. Densities are those of
/// [schneider2000correlation], where the note says nothing else; Poisson's ratio is the 0.45 of
/// with_tissue_material() where the study measures none.
struct PublishedTissue {
  std::string_view id;  ///< "tissue:muscle"
  TissueMaterial material;
  double young_low, young_high;  ///< one standard deviation, or the range of the study [Pa]
  std::string_view source;       ///< bibliography key of Young's modulus
  std::string_view note;         ///< what was measured
};
std::span<const PublishedTissue> published_tissues();
/// Null where none is called so.
const PublishedTissue* find_published_tissue(std::string_view id);

}  // namespace hmax
