/// SOFA's .scn as a body. What a component is taken for is what its sources compute, not what its
/// attributes are called; those whose defaults differ between versions must be given.
#include <algorithm>
#include <array>
#include <optional>

#include <Eigen/Core>
#include <fmt/format.h>

#include "catalogue/scenes/scene_builder.hpp"
#include "core/numbers.hpp"
#include "core/text/split.hpp"
#include "problems/mesh/files/scenes/sofa_file.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

namespace {

/// Components on which neither the body nor its steps depend. What looks for contacts does so when a
/// CollisionPipeline asks for it, and mapped points move with the body.
bool is_inert(std::string_view type) {
  constexpr std::array<std::string_view, 11> ends{
      "Mapping",      "CollisionModel", "GeometryAlgorithms", "TopologyModifier", "Camera",      "Light",
      "Intersection", "BroadPhase",     "NarrowPhase",        "OBJLoader",        "SphereLoader"};
  return type.starts_with("Ogl") || type.starts_with("Visual") ||
         std::ranges::any_of(ends, [&](std::string_view end) { return type.ends_with(end); }) ||
         is_listed(type,
                   "RequiredPlugin|DefaultAnimationLoop|DefaultVisualManagerLoop|CollisionResponse|"
                   "BackgroundSetting|LightManager|ViewerSetting|APIVersion|PointSetTopologyContainer|"
                   "EdgeSetTopologyContainer|TriangleSetTopologyContainer|STLLoader|MeshSTLLoader|"
                   // What solves exactly makes the same step.
                   "SparseLDLSolver|SparseCholeskySolver|SparseLUSolver|CholeskySolver|BTDLinearSolver|"
                   "SVDLinearSolver|EigenSimplicialLDLT|EigenSimplicialLLT|EigenSparseLU");
}

class SofaSceneReader {
 public:
  SofaSceneReader(const XmlFile& file, SceneBuilder& builder)
      : file_(file), builder_(builder), state_(sofa_state(file)), mesh_(sofa_mesh(file)) {}

  void read() {
    if (is_mapped(state_))
      file_.fail(state_, "the points of the body are mapped from others, which is not read");
    for (const XmlPart& part : file_.parts()) read(part);
    for (const auto& [part, what] : {std::pair(field_, "force field of tetrahedra"), {mass_, "mass"}})
      if (!part) file_.fail(state_, fmt::format("there is no {} beside the MechanicalObject; add one", what));
    for (std::size_t i = 0; i < moduli_.size(); ++i)
      builder_.add_material(moduli_.size() > 1 ? std::to_string(i + 1) : "", moduli_[i], poisson_, density_);
    builder_.set_gravity(gravity_);
    const bool fixes = std::ranges::any_of(
        mesh_.groups, [](const MeshGroup& group) { return group.name == fixed_points_of_sofa; });
    builder_.set_support(fixes ? fixed_points_of_sofa : "");
    if (!solver_) return;
    builder_.set_step(step_);
    if (gradients_ && solver_->type.starts_with("EulerImplicit"))
      builder_.scene.notes.push_back(fmt::format(
          "the limit is of exact solves; --linear cg:TOLERANCE,{} takes conjugate gradients as this scene does",
          gradients_->tag.attribute("iterations", "25")));
  }

 private:
  using Self = SofaSceneReader;

  /// Components that are understood.
  struct Known {
    std::string_view types, attributes;
    std::string_view idle;  ///< attributes that must be 0 or false, and 1 of scales
    void (Self::*read)(const XmlPart&) = nullptr;
    bool is_of_body = true;  ///< acts on the points beside it
  };

  static const Known* known(std::string_view type) {
    static constexpr std::array<Known, 15> all{
        {{"Node", "dt|gravity|bbox|time|animate", "", &Self::read_node, false},
         {"MechanicalObject", "position|src|topology|size", "translation|rotation|scale|scale3d|velocity",
          &Self::read_state, false},
         {"TetrahedronSetTopologyContainer|MeshTopology",
          "position|tetrahedra|src|filename|edges|triangles|lines|createTriangleArray", "", nullptr, false},
         {"MeshGmshLoader|MeshVTKLoader", "filename", "translation|rotation|scale|scale3d", nullptr, false},
         {"BoxROI", "box|position", "", nullptr, false},
         {"CGLinearSolver", "iterations|tolerance|threshold|linearSystem", "", &Self::read_gradients, false},
         {"FixedConstraint|FixedProjectiveConstraint", "indices|topology", "fixAll|activate_projectVelocity",
          &Self::read_fixed},
         {"UniformMass", "totalMass|vertexMass|topology", "separateGravity|rayleighMass", &Self::read_mass},
         {"DiagonalMass", "massDensity|totalMass|vertexMass|topology", "separateGravity|rayleighMass",
          &Self::read_mass},
         {"MeshMatrixMass", "massDensity|totalMass|lumping|topology", "separateGravity|rayleighMass",
          &Self::read_mass},
         {"TetrahedronFEMForceField|TetrahedralCorotationalFEMForceField|FastTetrahedralCorotationalForceField",
          "youngModulus|poissonRatio|method|topology",
          "rayleighStiffness|plasticMaxThreshold|updateStiffnessMatrix", &Self::read_elastic},
         {"TetrahedronHyperelasticityFEMForceField", "materialName|ParameterSet|topology",
          "rayleighStiffness", &Self::read_hyperelastic},
         {"EulerImplicitSolver|EulerImplicit",
          "rayleighStiffness|rayleighMass|threadSafeVisitor|linearSolver",
          "firstOrder|trapezoidalScheme|vdamping|solveConstraint", &Self::read_implicit},
         {"NewmarkImplicitSolver", "rayleighStiffness|rayleighMass|gamma|beta|threadSafeVisitor|linearSolver",
          "vdamping", &Self::read_implicit},
         {"EulerExplicitSolver|EulerExplicit|EulerSolver|Euler|RungeKutta4Solver|RungeKutta4",
          "symplectic|threadSafeVisitor|linearSolver", "", &Self::read_explicit}}};
    const auto* const found =
        std::ranges::find_if(all, [&](const Known& each) { return is_listed(type, each.types); });
    return found == all.end() ? nullptr : found;
  }

  void refuse(std::string_view part, const XmlPart& at, const std::string& what) {
    builder_.refuse(part, fmt::format("{}, line {}: ", file_.name(), at.place), what);
  }

  void read(const XmlPart& part) {
    if (is_inert(part.type)) return;
    const Known* const known_part = known(part.type);
    if (!known_part)
      return refuse(part.type, part, fmt::format("{} is not understood", in_quotes(part.type)));
    const bool solves =
        part.type.ends_with("Solver") || part.type.starts_with("Euler") || part.type == "RungeKutta4";
    if (known_part->is_of_body && !(solves ? is_above_body(part.node) : part.node == state_.node))
      return refuse(
          part.type, part,
          fmt::format("{} is not beside the first MechanicalObject, whose body is read", part.type));
    for (const auto& [name, value] : part.tag.attributes) check(part, *known_part, name);
    if (known_part->read) (this->*known_part->read)(part);
  }

  void check(const XmlPart& part, const Known& known_part, std::string_view name) {
    if (is_listed(name, known_part.attributes) ||
        is_listed(name, "name|type|template|printLog|tags|listening") || name.starts_with("show") ||
        name.starts_with("draw") || name.starts_with("compute"))
      return;
    const std::string_view value = trimmed(part.tag.attribute(name)),
                           neutral = name.starts_with("scale") ? "1" : "0";
    if (is_listed(name, known_part.idle)) {
      const std::vector<std::string_view> words = split(value, " ");
      if (value == "false" || std::ranges::all_of(words, [&](std::string_view word) {
            return to_number(word) == to_number(neutral);
          }))
        return;
    }
    refuse(name, part,
           fmt::format("{} = {} of {} is not understood", in_quotes(name), in_quotes(value), part.type));
  }

  /// Whether a node is that of the body, or has it in it.
  [[nodiscard]] bool is_above_body(std::optional<std::size_t> node) const {
    for (auto above = state_.node; above; above = file_.parts()[*above].node)
      if (above == node) return true;
    return false;
  }

  [[nodiscard]] bool is_mapped(const XmlPart& state) const {
    return std::ranges::any_of(file_.parts(), [&](const XmlPart& part) {
      return part.node == state.node && part.type.ends_with("Mapping") &&
             !part.type.ends_with("TopologicalMapping");
    });
  }

  double number(const XmlPart& part, std::string_view attribute, double otherwise) {
    return part.has(attribute) ? file_.numbers(part, attribute, 1).front() : otherwise;
  }

  /// One number, given once or for each element.
  double common_number(const XmlPart& part, std::string_view attribute) {
    const std::vector<double> values = file_.numbers(part, attribute);
    if (values.empty() || std::ranges::count(values, values.front()) != std::ssize(values))
      file_.fail(part, fmt::format("{} of {} is {}; give one number", attribute, part.type,
                                   values.empty() ? "missing" : "not the same everywhere"));
    return values.front();
  }

  bool is_on(const XmlPart& part, std::string_view attribute, std::string_view otherwise) {
    const std::string_view value = part.tag.attribute(attribute, otherwise);
    if (!is_listed(value, "0|1|false|true"))
      file_.fail(part, fmt::format("{} is {}; write 0 or 1", attribute, in_quotes(value)));
    return value == "1" || value == "true";
  }

  void only(const XmlPart*& slot, const XmlPart& part) {
    if (slot)
      file_.fail(part, fmt::format("{} stands beside {} of line {}, and one is read; remove one", part.type,
                                   slot->type, slot->place));
    slot = &part;
  }

  void read_node(const XmlPart& part) {
    const auto index = static_cast<std::size_t>(&part - file_.parts().data());
    if (index == 0) step_ = number(part, "dt", step_);
    if (!(step_ > 0))
      file_.fail(part, fmt::format("dt is {} but must be positive; correct it", to_text(step_)));
    if (part.has("gravity") && is_above_body(index))
      gravity_ = Eigen::Map<const Eigen::Vector3d>(file_.numbers(part, "gravity", 3).data());
  }

  void read_state(const XmlPart& part) {
    if (&part != &state_ && !is_mapped(part))
      refuse(part.type, part, "there is a second MechanicalObject, and one body is read");
  }

  void read_gradients(const XmlPart& part) { gradients_ = &part; }

  void read_fixed(const XmlPart& part) {
    if (!part.has("indices"))
      file_.fail(part, fmt::format("{} has no indices, so that SOFA fixes point 0; write them", part.type));
  }

  void read_mass(const XmlPart& part) {
    only(mass_, part);
    const auto given = std::ranges::count_if(std::array{"massDensity", "totalMass", "vertexMass"},
                                             [&](const char* each) { return part.has(each); });
    if (given != 1)
      file_.fail(part, fmt::format("{} has {} of massDensity, totalMass and vertexMass; give one", part.type,
                                   given));
    if (part.type == "MeshMatrixMass" && !is_on(part, "lumping", "0"))
      refuse("lumping", part,
             "MeshMatrixMass without lumping couples points, and bodies here have lumped masses");
    if (part.has("massDensity")) {
      density_ = common_number(part, "massDensity");
    } else if (part.type != "UniformMass" && part.has("totalMass")) {
      builder_.set_mass(common_number(part, "totalMass"), false);
    } else {
      // Points in no tetrahedron have the same mass as others in SOFA, and none here.
      const auto points = static_cast<double>(mesh_.mesh.point_count());
      const double each = part.has("totalMass") ? common_number(part, "totalMass") / points
                                                : common_number(part, "vertexMass");
      builder_.set_mass(each * (points - static_cast<double>(unused_points(mesh_.mesh).size())), true);
    }
  }

  /// Rotations of elements by QR ("large") and by polar decomposition differ for large strains alone.
  void read_elastic(const XmlPart& part) {
    only(field_, part);
    const std::string_view method = part.tag.attribute("method", "large");
    if (!is_listed(method, "small|large|polar|svd|qr|none"))
      file_.fail(part, fmt::format("the method {} of {} is not understood; take small, large, polar or svd",
                                   in_quotes(method), part.type));
    const bool is_linear = method == "small" || method == "none";
    builder_.scene.model = is_linear ? "fem_cauchy" : "fem_corotational";
    if (!is_linear && method != "polar")
      builder_.scene.notes.push_back(fmt::format(
          "elements are rotated by polar decomposition and in SOFA by method {}; small motions are the same",
          in_quotes(method)));
    moduli_ = sorted_moduli(file_.numbers(part, "youngModulus"));
    if (moduli_.empty()) file_.fail(part, fmt::format("{} has no youngModulus; write it", part.type));
    poisson_ = common_number(part, "poissonRatio");
  }

  /// SOFA's StVenantKirchhoff has mu and lambda, its NeoHookean mu and the bulk modulus.
  void read_hyperelastic(const XmlPart& part) {
    only(field_, part);
    const std::string_view material = part.tag.attribute("materialName");
    if (!is_listed(material, "StVenantKirchhoff|NeoHookean"))
      file_.fail(part, fmt::format("the material {} is not understood; take StVenantKirchhoff or NeoHookean",
                                   in_quotes(material)));
    const std::vector<double> values = file_.numbers(part, "ParameterSet", 2);
    const bool is_neo_hookean = material == "NeoHookean";
    const double mu = values[0], lambda = is_neo_hookean ? values[1] - 2 * mu / 3 : values[1];
    moduli_ = {mu * (3 * lambda + 2 * mu) / (lambda + mu)};
    poisson_ = lambda / (2 * (lambda + mu));
    builder_.scene.model = is_neo_hookean ? "fem_neo_hookean" : "fem_green";
    if (is_neo_hookean)
      builder_.scene.notes.emplace_back(
          "the energy of fem_neo_hookean differs from that of SOFA's NeoHookean; small motions are the same");
  }

  /// One linear solve a step, as for Newmark in SOFA; Rayleigh damping alpha M + beta K.
  void read_implicit(const XmlPart& part) {
    take_solver(part, "linearly_implicit_euler");
    if (part.type.starts_with("Newmark"))
      builder_.scene.method = fmt::format("newmark:beta={},gamma={}", to_text(number(part, "beta", 0.25)),
                                          to_text(number(part, "gamma", 0.5)));
    builder_.set_damping(number(part, "rayleighMass", 0), number(part, "rayleighStiffness", 0));
  }

  void read_explicit(const XmlPart& part) {
    const bool is_symplectic = is_on(part, "symplectic", "1");
    take_solver(part, part.type.starts_with("Runge") ? "rk4"
                      : is_symplectic                ? "symplectic_euler"
                                                     : "explicit_euler");
  }

  void take_solver(const XmlPart& part, const char* method) {
    only(solver_, part);
    builder_.scene.integrator = part.type;
    builder_.scene.method = method;
  }

  const XmlFile& file_;
  SceneBuilder& builder_;
  const XmlPart& state_;
  MeshFile mesh_;
  const XmlPart *field_ = nullptr, *mass_ = nullptr, *solver_ = nullptr, *gradients_ = nullptr;
  std::vector<double> moduli_;
  double poisson_ = 0, step_ = 0.01;  // SOFA's default of the root
  std::optional<double> density_;
  Eigen::Vector3d gravity_{0, -9.81, 0};
};

}  // namespace

void read_sofa_scene(const std::string& file, std::string_view bytes, SceneBuilder& builder) {
  const XmlFile parsed(file, bytes, sofa_root);
  SofaSceneReader(parsed, builder).read();
}

}  // namespace hmax
