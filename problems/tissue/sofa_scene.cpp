#include "problems/tissue/sofa_scene.hpp"

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

void check(const SofaScene& scene) {
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  const auto not_negative = [](double value) { return value >= 0 && std::isfinite(value); };
  require(positive(scene.young), "Young's modulus", scene.young, "give a positive one in Pa");
  require(scene.poisson > -1 && scene.poisson < 0.5, "Poisson ratio", scene.poisson,
          "give one between -1 and 0.5");
  require(positive(scene.density), "density", scene.density, "give a positive one in kg/m3");
  require(positive(scene.step), "step", scene.step, "give a positive one in seconds");
  require(not_negative(scene.alpha), "damping alpha", scene.alpha, "give 0 or more");
  require(not_negative(scene.beta), "damping beta", scene.beta, "give 0 or more");
  for (int k = 0; k < 3; ++k)
    require(std::isfinite(scene.gravity(k)), "gravity", scene.gravity(k), "give a finite one");
  for (const TetMesh::Index point : scene.fixed)
    require(point >= 0 && point < scene.mesh.point_count(), "fixed point", point,
            "the mesh does not have it");
}

/// Each number behind a blank.
template <class Numbers>
std::string listed(const Numbers& numbers) {
  std::string text;
  for (const auto value : numbers)
    text += (text.empty() ? "" : " ") + shortest_digits(static_cast<double>(value));
  return text;
}

std::string force_field(const SofaScene& scene) {
  const double mu = scene.young / (2 * (1 + scene.poisson));
  const double lambda = scene.young * scene.poisson / ((1 + scene.poisson) * (1 - 2 * scene.poisson));
  const std::string linear = "    <TetrahedronFEMForceField template=\"Vec3d\" youngModulus=\"" +
                             shortest_digits(scene.young) + "\" poissonRatio=\"" +
                             shortest_digits(scene.poisson) + "\" method=\"";
  const std::string hyperelastic =
      "    <TetrahedronHyperelasticityFEMForceField template=\"Vec3d\" ParameterSet=\"" +
      shortest_digits(mu) + " ";
  switch (scene.material) {
    case SofaMaterial::cauchy:
      return linear + "small\"/>\n";
    case SofaMaterial::corotational:
      return linear + "polar\"/>\n";
    case SofaMaterial::green:
      return hyperelastic + shortest_digits(lambda) + "\" materialName=\"StVenantKirchhoff\"/>\n";
    case SofaMaterial::neo_hookean:
      return hyperelastic + shortest_digits(lambda + 2 * mu / 3) + "\" materialName=\"NeoHookean\"/>\n";
  }
  throw std::invalid_argument("a SOFA scene has no such material");
}

}  // namespace

std::string sofa_text(const SofaScene& scene) {
  check(scene);
  const bool linear = scene.material == SofaMaterial::cauchy || scene.material == SofaMaterial::corotational;
  std::string text = "<?xml version=\"1.0\"?>\n<Node name=\"root\" dt=\"" + shortest_digits(scene.step) +
                     "\" gravity=\"" + listed(scene.gravity) + "\">\n";
  for (const std::string& plugin :
       {std::string("Constraint.Projective"), std::string("LinearSolver.Iterative"), std::string("Mass"),
        std::string("ODESolver.Backward"),
        std::string(linear ? "SolidMechanics.FEM.Elastic" : "SolidMechanics.FEM.HyperElastic"),
        std::string("StateContainer"), std::string("Topology.Container.Dynamic"), std::string("Visual")})
    text += "  <RequiredPlugin name=\"Sofa.Component." + plugin + "\"/>\n";
  text +=
      "  <DefaultAnimationLoop/>\n"
      "  <VisualStyle displayFlags=\"showBehaviorModels showForceFields\"/>\n"
      "  <Node name=\"tissue\">\n"
      "    <EulerImplicitSolver rayleighMass=\"" +
      shortest_digits(scene.alpha) + "\" rayleighStiffness=\"" + shortest_digits(scene.beta) +
      "\"/>\n"
      "    <CGLinearSolver iterations=\"1000\" tolerance=\"1e-10\" threshold=\"1e-20\"/>\n"
      "    <TetrahedronSetTopologyContainer name=\"mesh\" position=\"" +
      listed(scene.mesh.points.reshaped()) + "\" tetrahedra=\"" + listed(scene.mesh.tetrahedra.reshaped()) +
      "\"/>\n"
      "    <TetrahedronSetGeometryAlgorithms template=\"Vec3d\"/>\n"
      "    <MechanicalObject template=\"Vec3d\" name=\"points\"/>\n" +
      force_field(scene) + "    <DiagonalMass massDensity=\"" + shortest_digits(scene.density) + "\"/>\n";
  if (!scene.fixed.empty())
    text += "    <FixedProjectiveConstraint indices=\"" + listed(scene.fixed) + "\"/>\n";
  return text + "  </Node>\n</Node>\n";
}

}  // namespace hmax
