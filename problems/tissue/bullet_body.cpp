#include "problems/tissue/bullet_body.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "problems/digits.hpp"

namespace hmax {
namespace {

void require(bool holds, const std::string& what, const char* remedy) {
  if (!holds) throw std::invalid_argument("Bullet's soft body " + what + "; " + remedy);
}

void check(const TissueSettings& settings) {
  const TissueMaterial& first = settings.materials.front();
  require(std::ranges::all_of(settings.materials,
                              [&](const TissueMaterial& each) {
                                return each.young == first.young && each.poisson == first.poisson;
                              }),
          "has one material", "give all regions the same");
  require(settings.skin.kind == SkinSettings::Kind::none && first.fibre_young == 0,
          "has no skin and no fibres", "leave them out");
  require(settings.mass_step == 0, "has no mass scaling", "leave mass_step out");
  require(settings.tools.empty() && settings.forces.empty(), "has no load but gravity", "leave it out");
  require(
      settings.elastic_supports.empty() &&
          std::ranges::all_of(settings.supports, [](const Support& each) { return each.travel.isZero(); }),
      "has fixed supports", "leave others out");
}

}  // namespace

std::string bullet_text(const TissueBody& body) {
  const TissueSettings& settings = body.settings();
  const TetMesh& mesh = body.mesh();
  check(settings);
  const bool is_neo_hookean = settings.model.id == "fem_neo_hookean";
  require(is_neo_hookean || settings.model.id == "fem_corotational",
          "has no model " + std::string(settings.model.id), "choose fem_neo_hookean or fem_corotational");
  require(!is_neo_hookean || settings.alpha == 0, "of fem_neo_hookean has no damping alpha",
          "choose --model fem_corotational, or --set alpha=0");
  std::string text = is_neo_hookean ? "neo_hookean" : "linear";
  const auto add = [&](double number) { text += " " + shortest_digits(number); };
  const TissueMaterial& material = settings.materials.front();
  for (const double number :
       {material.young, material.poisson, settings.alpha, settings.beta, settings.gravity.x(),
        settings.gravity.y(), settings.gravity.z(), static_cast<double>(mesh.point_count()),
        static_cast<double>(mesh.tetrahedron_count())})
    add(number);
  for (Eigen::Index i = 0; i < mesh.point_count(); ++i) {
    text += "\n";
    for (const double x : mesh.points.col(i)) add(x);
    add(body.point_mass()[i]);
    text += body.free_numbers()[static_cast<std::size_t>(i)] < 0 ? " 1" : " 0";
  }
  for (const auto& tetrahedron : mesh.tetrahedra.colwise()) {
    text += "\n";
    for (const TetMesh::Index point : tetrahedron) text += " " + std::to_string(point);
  }
  return text;
}

}  // namespace hmax
