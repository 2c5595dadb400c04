#include "problems/tissue/sofa_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <variant>
#include <vector>

#include "core/own_files.hpp"
#include "core/sort_unique.hpp"
#include "problems/digits.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/spring_sets.hpp"

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

bool is_linear(const TissueSettings& settings) {
  return settings.model.sofa == SofaField::small || settings.model.sofa == SofaField::polar;
}

/// True when all materials have the same number.
bool is_same(const TissueSettings& settings, double TissueMaterial::*what) {
  const double first = settings.materials.front().*what;
  return std::ranges::all_of(settings.materials,
                             [&](const TissueMaterial& material) { return material.*what == first; });
}

bool is_explicit(const SofaStep& step) {
  return step.solver != SofaStep::Solver::implicit_euler && step.solver != SofaStep::Solver::newmark;
}

/// Each number behind a blank.
template <class Numbers>
std::string listed(const Numbers& numbers) {
  std::string text;
  for (const auto value : numbers)
    text += (text.empty() ? "" : " ") + shortest_digits(static_cast<double>(value));
  return text;
}

/// Young's modulus, or that of each tetrahedron.
std::string young_moduli(const TissueBody& body) {
  const std::vector<TissueMaterial>& materials = body.settings().materials;
  if (is_same(body.settings(), &TissueMaterial::young)) return shortest_digits(materials.front().young);
  const TetMesh& mesh = body.mesh();
  Eigen::MatrixXd young(1, mesh.tetrahedron_count());
  for (Eigen::Index t = 0; t < young.cols(); ++t)
    young(0, t) = materials[static_cast<std::size_t>(mesh.region(t))].young;
  if (body.origin()) young = body.origin()->on_tetrahedra(young);
  return listed(young.reshaped());
}

/// @param moduli  Young's modulus, or one of each tetrahedron; hyperelastic fields take that of the
///                material instead
std::string force_field(SofaField field, const TissueMaterial& material, const std::string& moduli) {
  const double young = material.young, poisson = material.poisson;
  const double mu = young / (2 * (1 + poisson));
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const std::string linear = "<TetrahedronFEMForceField template=\"Vec3d\" youngModulus=\"" + moduli +
                             "\" poissonRatio=\"" + shortest_digits(poisson) + "\" method=\"";
  const std::string hyperelastic =
      "<TetrahedronHyperelasticityFEMForceField template=\"Vec3d\" ParameterSet=\"" + shortest_digits(mu) +
      " ";
  switch (field) {
    case SofaField::small:
      return linear + "small\"/>";
    case SofaField::polar:
      return linear + "polar\"/>";
    case SofaField::st_venant_kirchhoff:
      return hyperelastic + shortest_digits(lambda) + "\" materialName=\"StVenantKirchhoff\"/>";
    default:
      return hyperelastic + shortest_digits(lambda + 2 * mu / 3) + "\" materialName=\"NeoHookean\"/>";
  }
}

/// Whether one force field holds all materials: of E of each tetrahedron, or of one material.
bool has_one_field(const TissueSettings& settings) {
  return is_same(settings, &TissueMaterial::poisson) &&
         (is_linear(settings) || is_same(settings, &TissueMaterial::young));
}

/// The tetrahedra of each region, as the file lists their corners.
std::vector<std::vector<TetMesh::Index>> corners_of_regions(const TissueBody& body) {
  const TetMesh& mesh = body.mesh();
  Eigen::MatrixXd regions(1, mesh.tetrahedron_count());
  for (Eigen::Index t = 0; t < regions.cols(); ++t) regions(0, t) = static_cast<double>(mesh.region(t));
  if (body.origin()) regions = body.origin()->on_tetrahedra(regions);
  const TetMesh& written = body.origin() ? body.origin()->file.mesh : mesh;
  std::vector<std::vector<TetMesh::Index>> corners(body.settings().materials.size());
  for (Eigen::Index t = 0; t < regions.cols(); ++t)
    for (const TetMesh::Index corner : written.tetrahedra.col(t))
      corners[static_cast<std::size_t>(regions(0, t))].push_back(corner);
  return corners;
}

/// The force field of the body, or a child node of each region with a force field on its tetrahedra. A node
/// without a MechanicalObject takes the one above it, so that all act on the same points.
std::string force_fields(const TissueBody& body) {
  const TissueSettings& settings = body.settings();
  if (has_one_field(settings))
    return force_field(settings.model.sofa, settings.materials[0], young_moduli(body));
  const std::vector<std::vector<TetMesh::Index>> corners = corners_of_regions(body);
  std::string nodes;
  for (std::size_t region = 0; region < corners.size(); ++region) {
    if (corners[region].empty()) continue;
    const TissueMaterial& material = settings.materials[region];
    nodes += (nodes.empty() ? "<Node name=\"region_" : "\n    <Node name=\"region_") +
             std::to_string(region + 1) +
             "\">\n      <TetrahedronSetTopologyContainer name=\"part\" position=\"@../mesh.position\" "
             "tetrahedra=\"" +
             listed(corners[region]) + "\"/>\n      " +
             force_field(settings.model.sofa, material, shortest_digits(material.young)) + "\n    </Node>";
  }
  return nodes;
}

/// Where a point of the body stands in the file.
TetMesh::Index place_of(const TissueBody& body, TetMesh::Index point) {
  return body.origin() ? body.origin()->points[static_cast<std::size_t>(point)] : point;
}

/// Every spring: its points in the file, stiffness, damper and length at rest.
std::string springs(const TissueBody& body) {
  const TetMesh& mesh = body.mesh();
  std::string list;
  for (const SpringSet::Spring& spring :
       tissue_springs(mesh, edge_table(mesh), surface_of(mesh), body.settings())) {
    std::array<double, 2> places{};
    for (const std::size_t end : {0U, 1U}) places[end] = place_of(body, spring.points[end]);
    const double length = (mesh.points.col(spring.points[0]) - mesh.points.col(spring.points[1])).norm();
    list += (list.empty() ? "" : " ") +
            listed(std::array{places[0], places[1], spring.stiffness, spring.damper, length});
  }
  return "<StiffSpringForceField template=\"Vec3d\" spring=\"" + list + "\"/>";
}

std::string mass(const TissueBody& body) {
  const TissueSettings& settings = body.settings();
  if (settings.equal_masses || !is_same(settings, &TissueMaterial::density)) {
    Eigen::MatrixXd masses = body.point_mass().transpose();
    if (body.origin()) masses = body.origin()->on_points(masses);
    return "<DiagonalMass vertexMass=\"" + listed(masses.reshaped()) + "\"/>";
  }
  if (settings.total_mass)
    return "<DiagonalMass totalMass=\"" + shortest_digits(*settings.total_mass) + "\"/>";
  return "<DiagonalMass massDensity=\"" + shortest_digits(settings.materials[0].density) + "\"/>";
}

/// A dead load on points of the file, each with its share.
std::string constant_force(const TissueBody& body, const PressingForce& force) {
  std::vector<TetMesh::Index> places;
  std::vector<double> each;
  for (std::size_t i = 0; i < force.points.size(); ++i) {
    places.push_back(place_of(body, force.points[i]));
    const double share =
        force.shares.empty() ? 1 / static_cast<double>(force.points.size()) : force.shares[i];
    for (const double component : force.force) each.push_back(share * component);
  }
  return "<ConstantForceField template=\"Vec3d\" indices=\"" + listed(places) + "\" forces=\"" +
         listed(each) + "\"/>";
}

/// Springs to the places at rest, each with its stiffness.
std::string rest_springs(const TissueBody& body, const ElasticSupport& support) {
  std::vector<TetMesh::Index> places;
  for (const TetMesh::Index point : support.points) places.push_back(place_of(body, point));
  return "<RestShapeSpringsForceField template=\"Vec3d\" points=\"" + listed(places) + "\" stiffness=\"" +
         listed(support.stiffness) + "\"/>";
}

/// Points that a scene holds, by their places in the file: the supports, and those in no tetrahedron.
std::vector<TetMesh::Index> fixed_points(const TissueBody& body) {
  std::vector<TetMesh::Index> fixed;
  for (const Support& support : body.settings().supports)
    for (const TetMesh::Index point : support.points) fixed.push_back(place_of(body, point));
  if (body.origin())
    for (const TetMesh::Index idle : unused_points(body.origin()->file.mesh)) fixed.push_back(idle);
  sort_unique(fixed);
  return fixed;
}

std::string solver(const TissueSettings& settings, const SofaStep& step) {
  const std::string rayleigh = " rayleighMass=\"" + shortest_digits(settings.alpha) +
                               "\" rayleighStiffness=\"" + shortest_digits(settings.beta) + "\"/>";
  switch (step.solver) {
    case SofaStep::Solver::newmark:
      return "<NewmarkImplicitSolver beta=\"" + shortest_digits(step.beta) + "\" gamma=\"" +
             shortest_digits(step.gamma) + "\"" + rayleigh;
    case SofaStep::Solver::symplectic_euler:
      return "<EulerExplicitSolver symplectic=\"1\"/>";
    case SofaStep::Solver::explicit_euler:
      return "<EulerExplicitSolver symplectic=\"0\"/>";
    case SofaStep::Solver::runge_kutta_4:
      return "<RungeKutta4Solver/>";
    default:
      return "<EulerImplicitSolver" + rayleigh;
  }
}

/// -alpha m v at each point.
std::string velocity_damping(const TissueBody& body) {
  Eigen::MatrixXd masses = body.point_mass().transpose();
  if (body.origin()) masses = body.origin()->on_points(masses);
  const Eigen::MatrixXd coefficients = (body.settings().alpha * masses).replicate(3, 1);
  return "<DiagonalVelocityDampingForceField template=\"Vec3d\" dampingCoefficient=\"" +
         listed(coefficients.reshaped()) + "\"/>";
}

/// The modules of SOFA with the components of a scene.
std::string plugins(const TissueSettings& settings, const SofaStep& step) {
  std::vector<const char*> names{"Constraint.Projective", "Mass"};
  if (is_explicit(step))
    names.push_back("ODESolver.Forward");
  else
    names.insert(names.end(), {"LinearSolver.Iterative", "ODESolver.Backward"});
  names.insert(names.end(), {settings.model.is_of_springs() ? "SolidMechanics.Spring"
                             : is_linear(settings)          ? "SolidMechanics.FEM.Elastic"
                                                            : "SolidMechanics.FEM.HyperElastic",
                             "StateContainer", "Topology.Container.Dynamic", "Visual"});
  if (!settings.forces.empty() || (is_explicit(step) && settings.alpha != 0))
    names.push_back("MechanicalLoad");
  if (!settings.elastic_supports.empty() && !settings.model.is_of_springs())
    names.push_back("SolidMechanics.Spring");
  std::string text;
  for (const char* name : names)
    text += std::string("  <RequiredPlugin name=\"Sofa.Component.") + name + "\"/>\n";
  return text;
}

}  // namespace

void check_sofa_scene(const TissueSettings& settings, const SofaStep& step) {
  if (settings.model.is_of_springs())
    require_none(std::holds_alternative<LinearSpring>(settings.springs.law), "springs that are not linear");
  else if (settings.model.sofa == SofaField::none)
    throw std::invalid_argument("SOFA has no force field of the model " + std::string(settings.model.id) +
                                "; choose another model");
  require_none(settings.skin.kind == SkinSettings::Kind::none, "skins");
  require_none(settings.tools.empty(), "tools");
  require_none(settings.mass_step == 0, "masses that mass_step adds");
  require_none(std::ranges::all_of(
                   settings.materials, [](double E) { return E == 0; }, &TissueMaterial::fibre_young),
               "fibres");
  for (const PressingForce& force : settings.forces)
    require_none(force.profile.kind == TimeProfile::Kind::steady, "forces that change with time");
  for (const Support& support : settings.supports) require_none(support.travel.isZero(), "moving supports");
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  for (const TissueMaterial& material : settings.materials) {
    require(positive(material.young), "Young's modulus", material.young, "give a positive one in Pa");
    require(positive(material.density), "density", material.density, "give a positive one in kg/m3");
  }
  for (const double damping : {settings.alpha, settings.beta})
    require(damping == 0 || positive(damping), "Rayleigh damping", damping, "give 0 or more");
  require(positive(step.h), "step", step.h, "give a positive one in seconds");
  if (is_explicit(step))
    require(settings.beta == 0, "Rayleigh damping by stiffness", settings.beta,
            "SOFA's explicit solvers have none, so set beta=0 or take an implicit method");
}

std::string sofa_text(const TissueBody& body, const SofaStep& step) {
  const TissueSettings& settings = body.settings();
  check_sofa_scene(settings, step);
  const TetMesh& mesh = body.origin() ? body.origin()->file.mesh : body.mesh();
  const std::vector<TetMesh::Index> fixed = fixed_points(body);
  std::string text = "<?xml version=\"1.0\"?>\n<!-- " + std::string(own_mark) +
                     " -->\n<Node name=\"root\" dt=\"" + shortest_digits(step.h) + "\" gravity=\"" +
                     listed(settings.gravity) + "\">\n";
  text += plugins(settings, step);
  text += "  <DefaultAnimationLoop/>\n  <VisualStyle displayFlags=\"showBehaviorModels showForceFields\"/>\n";
  text += "  <Node name=\"tissue\">\n";
  const auto add = [&](const std::string& component) { text += "    " + component + "\n"; };
  add(solver(settings, step));
  if (!is_explicit(step))
    add("<CGLinearSolver iterations=\"1000\" tolerance=\"1e-10\" threshold=\"1e-20\"/>");
  add("<TetrahedronSetTopologyContainer name=\"mesh\" position=\"" + listed(mesh.points.reshaped()) +
      "\" tetrahedra=\"" + listed(mesh.tetrahedra.reshaped()) + "\"/>");
  add("<TetrahedronSetGeometryAlgorithms template=\"Vec3d\"/>");
  add("<MechanicalObject template=\"Vec3d\" name=\"points\"/>");
  add(mass(body));
  if (!fixed.empty()) add("<FixedProjectiveConstraint indices=\"" + listed(fixed) + "\"/>");
  add(settings.model.is_of_springs() ? springs(body) : force_fields(body));
  for (const ElasticSupport& support : settings.elastic_supports) add(rest_springs(body, support));
  for (const PressingForce& force : settings.forces) add(constant_force(body, force));
  if (is_explicit(step) && settings.alpha != 0) add(velocity_damping(body));
  return text + "  </Node>\n</Node>\n";
}

}  // namespace hmax
