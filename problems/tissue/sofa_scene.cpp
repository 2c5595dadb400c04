#include "problems/tissue/sofa_scene.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "problems/digits.hpp"

namespace hmax {

namespace {

void require(bool holds, const char* what, double value, const char* remedy) {
  if (!holds)
    throw std::invalid_argument(std::string("the ") + what + " of a SOFA scene is " + shortest_digits(value) +
                                "; " + remedy);
}

void require_none(bool none, const char* what) {
  if (!none)
    throw std::invalid_argument(std::string("a SOFA scene is written without ") + what + "; leave them out");
}

void check(const TetMesh& mesh, const TissueSettings& settings, double step) {
  if (settings.model == TissueModel::mass_spring)
    throw std::invalid_argument("a SOFA scene is written for finite elements only; choose a model fem_...");
  if (settings.materials.size() != 1)
    throw std::invalid_argument("a SOFA scene is written for one material and the body has " +
                                std::to_string(settings.materials.size()) + "; give it one");
  require_none(settings.skin.kind == SkinSettings::Kind::none, "skins");
  require_none(settings.tools.empty(), "tools");
  require_none(settings.forces.empty(), "pressing forces");
  const TissueMaterial& material = settings.materials[0];
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  const auto not_negative = [](double value) { return value >= 0 && std::isfinite(value); };
  require(positive(material.young), "Young's modulus", material.young, "give a positive one in Pa");
  require(material.poisson > -1 && material.poisson < 0.5, "Poisson ratio", material.poisson,
          "give one between -1 and 0.5");
  require(positive(material.density), "density", material.density, "give a positive one in kg/m3");
  if (settings.total_mass)
    require(positive(*settings.total_mass), "mass", *settings.total_mass, "give a positive one");
  require(positive(step), "step", step, "give a positive one in seconds");
  require(not_negative(settings.alpha), "damping alpha", settings.alpha, "give 0 or more");
  require(not_negative(settings.beta), "damping beta", settings.beta, "give 0 or more");
  for (int k = 0; k < 3; ++k)
    require(std::isfinite(settings.gravity(k)), "gravity", settings.gravity(k), "give a finite one");
  for (const Support& support : settings.supports) {
    require_none(support.travel.isZero(), "moving supports");
    for (const TetMesh::Index point : support.points)
      require(point >= 0 && point < mesh.point_count(), "fixed point", point, "the mesh does not have it");
  }
}

/// Each number behind a blank.
template <class Numbers>
std::string listed(const Numbers& numbers) {
  std::string text;
  for (const auto value : numbers)
    text += (text.empty() ? "" : " ") + shortest_digits(static_cast<double>(value));
  return text;
}

std::string force_field(const TissueSettings& settings) {
  const auto& [young, poisson, density] = settings.materials[0];
  const double mu = young / (2 * (1 + poisson));
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const std::string linear = "<TetrahedronFEMForceField template=\"Vec3d\" youngModulus=\"" +
                             shortest_digits(young) + "\" poissonRatio=\"" + shortest_digits(poisson) +
                             "\" method=\"";
  const std::string hyperelastic =
      "<TetrahedronHyperelasticityFEMForceField template=\"Vec3d\" ParameterSet=\"" + shortest_digits(mu) +
      " ";
  switch (settings.model) {
    case TissueModel::fem_cauchy:
      return linear + "small\"/>";
    case TissueModel::fem_corotational:
      return linear + "polar\"/>";
    case TissueModel::fem_green:
      return hyperelastic + shortest_digits(lambda) + "\" materialName=\"StVenantKirchhoff\"/>";
    default:
      return hyperelastic + shortest_digits(lambda + 2 * mu / 3) + "\" materialName=\"NeoHookean\"/>";
  }
}

std::string mass(const TissueSettings& settings) {
  if (settings.total_mass)
    return "<DiagonalMass totalMass=\"" + shortest_digits(*settings.total_mass) + "\"/>";
  return "<DiagonalMass massDensity=\"" + shortest_digits(settings.materials[0].density) + "\"/>";
}

}  // namespace

std::string sofa_text(const TetMesh& mesh, const TissueSettings& settings, double step) {
  check(mesh, settings, step);
  const bool linear =
      settings.model == TissueModel::fem_cauchy || settings.model == TissueModel::fem_corotational;
  std::vector<TetMesh::Index> fixed;
  for (const Support& support : settings.supports)
    fixed.insert(fixed.end(), support.points.begin(), support.points.end());
  std::ranges::sort(fixed);
  fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());

  std::string text = "<?xml version=\"1.0\"?>\n<Node name=\"root\" dt=\"" + shortest_digits(step) +
                     "\" gravity=\"" + listed(settings.gravity) + "\">\n";
  for (const char* plugin : {"Constraint.Projective", "LinearSolver.Iterative", "Mass", "ODESolver.Backward",
                             linear ? "SolidMechanics.FEM.Elastic" : "SolidMechanics.FEM.HyperElastic",
                             "StateContainer", "Topology.Container.Dynamic", "Visual"})
    text += std::string("  <RequiredPlugin name=\"Sofa.Component.") + plugin + "\"/>\n";
  text += "  <DefaultAnimationLoop/>\n  <VisualStyle displayFlags=\"showBehaviorModels showForceFields\"/>\n";
  text += "  <Node name=\"tissue\">\n";
  const auto add = [&](const std::string& component) { text += "    " + component + "\n"; };
  add("<EulerImplicitSolver rayleighMass=\"" + shortest_digits(settings.alpha) + "\" rayleighStiffness=\"" +
      shortest_digits(settings.beta) + "\"/>");
  add("<CGLinearSolver iterations=\"1000\" tolerance=\"1e-10\" threshold=\"1e-20\"/>");
  add("<TetrahedronSetTopologyContainer name=\"mesh\" position=\"" + listed(mesh.points.reshaped()) +
      "\" tetrahedra=\"" + listed(mesh.tetrahedra.reshaped()) + "\"/>");
  add("<TetrahedronSetGeometryAlgorithms template=\"Vec3d\"/>");
  add("<MechanicalObject template=\"Vec3d\" name=\"points\"/>");
  add(force_field(settings));
  add(mass(settings));
  if (!fixed.empty()) add("<FixedProjectiveConstraint indices=\"" + listed(fixed) + "\"/>");
  return text + "  </Node>\n</Node>\n";
}

}  // namespace hmax
