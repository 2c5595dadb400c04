#include "problems/tissue/tissue_model.hpp"

#include <array>
#include <numbers>
#include <stdexcept>
#include <string>

#include "problems/tissue/forces/green_elements.hpp"
#include "problems/tissue/forces/nodal_pressure.hpp"
#include "problems/tissue/forces/quadratic_elements.hpp"
#include "problems/tissue/forces/tet_elements.hpp"

namespace hmax {
namespace {

/// @tparam ElementsT  of one law
template <class ElementsT>
std::shared_ptr<const Elements> make(const TetMesh& mesh, std::span<const Lame> lame,
                                     const BlockPattern& pattern) {
  return std::make_shared<const ElementsT>(mesh, lame, pattern);
}

/// E s (s^2 - 1) / 2 is least at the stretch s = 1 / sqrt(3): E / (3 sqrt(3)) of compression.
constexpr double most_compression_of_green = std::numbers::inv_sqrt3 / 3;

constexpr auto models = std::to_array<TissueModel>({
    {.id = "fem_green",
     .note = "finite elements of Green's strain (St. Venant-Kirchhoff)",
     .most_compression = most_compression_of_green,
     .sofa = SofaField::st_venant_kirchhoff,
     .make_elements = make<GreenElements>,
     .point_law = TetLaw::green},
    {.id = "fem_cauchy",
     .note = "finite elements of small strain, linear",
     .is_linear = true,
     .sofa = SofaField::small,
     .make_elements = make<TetElements<SmallStrain>>,
     .point_law = TetLaw::small_strain},
    {.id = "fem_corotational",
     .note = "finite elements of small strain in the frame of their rotation",
     .resists_inversion = true,
     .sofa = SofaField::polar,
     .make_elements = make<TetElements<Corotational>>,
     .point_law = TetLaw::corotational},
    {.id = "fem_neo_hookean",
     .note = "finite elements of the stable neo-Hookean solid, which restore inverted ones",
     .resists_inversion = true,
     .resists_crushing = true,
     .sofa = SofaField::neo_hookean,
     .make_elements = make<TetElements<StableNeoHookean>>,
     .point_law = TetLaw::neo_hookean,
     .has_constraints = true},
    {.id = "fem_nodal_pressure",
     .note = "fem_neo_hookean with pressures averaged at the points, which do not lock near nu = 1/2",
     .resists_inversion = true,
     .resists_crushing = true,
     .resists_locking = true,
     .averages_at_points = true,
     .make_elements = make<NodalPressure>},
    {.id = "fem_quadratic",
     .note = "fem_neo_hookean on tetrahedra of ten nodes, of the file or with inserted middles of edges",
     .resists_locking = true,
     .has_ten_nodes = true,
     .make_elements = make<QuadraticElements>},
    {.id = "mass_spring", .note = "springs along the edges of the mesh, Poisson's ratio 1/4"},
});

}  // namespace

MeshEdges acting_pairs(const TissueModel& model, const TetMesh& mesh, const EdgeTable& table) {
  if (model.has_ten_nodes) return element_pairs(mesh);
  return model.averages_at_points ? two_edge_pairs(table) : table.edges;
}

std::span<const TissueModel> tissue_models() { return models; }

const TissueModel& tissue_model(std::string_view id) {
  std::string known;
  for (const TissueModel& model : models) {
    if (model.id == id) return model;
    known += (known.empty() ? "" : ", ") + std::string(model.id);
  }
  throw std::invalid_argument("there is no tissue model '" + std::string(id) + "'; use one of " + known);
}

}  // namespace hmax
