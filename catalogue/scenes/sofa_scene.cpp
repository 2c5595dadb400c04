/// SOFA's .scn as a body. What a component is taken for is what its sources compute, not what its
/// attributes are called; those whose defaults differ between versions must be given.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/scenes/scene_builder.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "core/sort_unique.hpp"
#include "core/text/split.hpp"
#include "problems/mesh/files/scenes/sofa_file.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/spring_sets.hpp"

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

struct SofaMethod {
  std::string_view method;
  SofaStep::Solver solver;
};

/// Of numbers in files that should be one number, or in one ratio.
constexpr double rounding = 1e-9;

constexpr std::array<SofaMethod, 5> sofa_solvers{
    {{"linearly_implicit_euler", SofaStep::Solver::implicit_euler},
     {"newmark", SofaStep::Solver::newmark},
     {"symplectic_euler", SofaStep::Solver::symplectic_euler},
     {"explicit_euler", SofaStep::Solver::explicit_euler},
     {"rk4", SofaStep::Solver::runge_kutta_4}}};

class SofaSceneReader {
 public:
  SofaSceneReader(const XmlFile& file, SceneBuilder& builder)
      : file_(file), builder_(builder), state_(sofa_state(file)), mesh_(sofa_mesh(file)) {}

  void read() {
    if (is_mapped(state_))
      file_.fail(state_, "the points of the body are mapped from others, which is not read");
    for (const XmlPart& part : file_.parts()) read(part);
    for (const auto& [has, what] :
         {std::pair(!fields_.empty() || springs_, "force field of tetrahedra or springs"),
          {mass_ != nullptr, "mass"}})
      if (!has) file_.fail(state_, fmt::format("there is no {} beside the MechanicalObject; add one", what));
    set_materials();
    if (springs_) set_springs();
    set_densities();
    builder_.set_gravity(gravity_);
    const bool fixes = std::ranges::any_of(
        mesh_.groups, [](const MeshGroup& group) { return group.name == fixed_points_of_sofa; });
    builder_.set_support(fixes ? fixed_points_of_sofa : "");
    set_velocity_damping();
    builder_.set_damping(alpha_, beta_);
    if (!solver_) return;
    builder_.set_step(step_);
    if (gradients_ && solver_->type.starts_with("EulerImplicit"))
      builder_.scene.gradients = gradients_->tag.attribute("iterations", "25");
  }

 private:
  using Self = SofaSceneReader;

  /// A force field of tetrahedra: Young's modulus, or that of each region, and Poisson's ratio.
  struct Field {
    const XmlPart* part;
    std::vector<double> moduli;
    double poisson;
  };

  /// Components that are understood.
  struct Known {
    std::string_view types, attributes;
    std::string_view idle;  ///< attributes that must be 0 or false
    void (Self::*read)(const XmlPart&) = nullptr;
    bool is_of_body = true;  ///< acts on the points beside it
  };

  static const Known* known(std::string_view type) {
    static constexpr std::array<Known, 19> all{
        {{"Node", "dt|gravity|bbox|time|animate", "", &Self::read_node, false},
         {"MechanicalObject", "position|src|topology|size|translation|rotation|scale|scale3d", "velocity",
          &Self::read_state, false},
         {"TetrahedronSetTopologyContainer|MeshTopology",
          "position|tetrahedra|src|filename|edges|triangles|lines|createTriangleArray", "", nullptr, false},
         {"MeshGmshLoader|MeshVTKLoader", "filename|translation|rotation|scale|scale3d", "", nullptr, false},
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
         {"StiffSpringForceField|SpringForceField", "spring", "rayleighStiffness", &Self::read_springs},
         {"MeshSpringForceField",
          "tetrahedraStiffness|tetrahedraDamping|tetrasStiffness|tetrasDamping|trianglesStiffness|"
          "trianglesDamping|linesStiffness|linesDamping|topology",
          "rayleighStiffness|noCompression", &Self::read_springs},
         {"ConstantForceField", "indices|forces|force|totalForce", "", &Self::read_forces},
         {"DiagonalVelocityDampingForceField", "dampingCoefficient", "", &Self::read_velocity_damping},
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
    const bool masses = part.type.ends_with("Mass");
    if (known_part->is_of_body && !(solves   ? is_above_body(part.node)
                                    : masses ? part.node == state_.node
                                             : states_.of(part) == &state_))
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
    const std::string_view value = trimmed(part.tag.attribute(name));
    if (is_listed(name, known_part.idle)) {
      const std::vector<std::string_view> words = split(value, " ");
      if (value == "false" ||
          std::ranges::all_of(words, [](std::string_view word) { return to_number(word) == 0; }))
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
      densities_ = {common_number(part, "massDensity")};
      masses_ = densities_.front() * volumes_of_points().rowwise().sum();
    } else if (part.type != "UniformMass" && part.has("totalMass")) {
      const double total = common_number(part, "totalMass");
      builder_.set_mass(total, false);
      masses_ = volumes_of_points().rowwise().sum();
      masses_ *= total / masses_.sum();
    } else {
      // Points in no tetrahedron have the same mass as others in SOFA, and none here.
      const auto points = static_cast<double>(mesh_.mesh.point_count());
      if (const std::vector<double> own = file_.numbers(part, "vertexMass");
          std::ranges::count(own, own.empty() ? 0 : own.front()) != std::ssize(own))
        return fit_densities(part, Eigen::Map<const Eigen::VectorXd>(own.data(), std::ssize(own)));
      const double each = part.has("totalMass") ? common_number(part, "totalMass") / points
                                                : common_number(part, "vertexMass");
      masses_ = Eigen::VectorXd::Constant(mesh_.mesh.point_count(), each);
      builder_.set_mass(each * (points - static_cast<double>(unused_points(mesh_.mesh).size())), true);
    }
  }

  /// A quarter of each tetrahedron of a region, shape (points, regions).
  [[nodiscard]] Eigen::MatrixXd volumes_of_points() const {
    const TetMesh& mesh = mesh_.mesh;
    Eigen::MatrixXd volumes = Eigen::MatrixXd::Zero(mesh.point_count(), region_count());
    for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
      const auto corners = mesh.tetrahedra.col(t);
      Eigen::Matrix3d edges;
      for (Eigen::Index k = 0; k < 3; ++k)
        edges.col(k) = mesh.points.col(corners[k + 1]) - mesh.points.col(corners[0]);
      for (const TetMesh::Index corner : corners)
        volumes(corner, region_index(t)) += std::abs(edges.determinant()) / 24;
    }
    return volumes;
  }
  /// The numbers of the regions of the mesh, sorted; 0 where it has none.
  [[nodiscard]] std::vector<TetMesh::Index> region_numbers() const {
    std::vector<TetMesh::Index> numbers = mesh_.mesh.regions;
    sort_unique(numbers);
    if (numbers.empty()) numbers.push_back(0);
    return numbers;
  }
  [[nodiscard]] Eigen::Index region_count() const { return std::ssize(region_numbers_); }
  [[nodiscard]] Eigen::Index region_index(Eigen::Index tetrahedron) const {
    if (mesh_.mesh.regions.empty()) return 0;
    return std::ranges::lower_bound(region_numbers_,
                                    mesh_.mesh.regions[static_cast<std::size_t>(tetrahedron)]) -
           region_numbers_.begin();
  }

  /// One density of each region, of which these masses are.
  void fit_densities(const XmlPart& part, const Eigen::VectorXd& masses) {
    const Eigen::MatrixXd volumes = volumes_of_points();
    if (masses.size() != volumes.rows())
      file_.fail(part, fmt::format("vertexMass has {} numbers for {} points; give one of each", masses.size(),
                                   volumes.rows()));
    const Eigen::VectorXd densities = volumes.colPivHouseholderQr().solve(masses);
    if (!((volumes * densities - masses).lpNorm<Eigen::Infinity>() <=
          rounding * masses.lpNorm<Eigen::Infinity>()))
      file_.fail(part,
                 "vertexMass is not the same everywhere and not by one density of each region, which is "
                 "not read; give massDensity or totalMass");
    densities_.assign(densities.begin(), densities.end());
    masses_ = masses;
  }

  void set_densities() {
    if (densities_.size() == 1) return builder_.set_density("", densities_.front(), where(*mass_));
    for (std::size_t i = 0; i < densities_.size(); ++i)
      builder_.set_density(std::to_string(region_numbers_[i]), densities_[i], where(*mass_));
  }

  [[nodiscard]] std::string where(const XmlPart& part) const {
    return fmt::format("{}, line {}", file_.name(), part.place);
  }

  /// Of one force field, or of one of each region.
  void set_materials() {
    if (springs_ && !fields_.empty())
      file_.fail(*springs_,
                 "there are springs beside a force field of tetrahedra, and one is read; remove one");
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const auto& [part, moduli, poisson] = fields_[i];
      if (fields_.size() > 1 && (moduli.size() > 1 || std::ssize(fields_) != region_count()))
        file_.fail(*part,
                   "there are several force fields, and not one of each region; give each node its own "
                   "tetrahedra and one youngModulus");
      for (std::size_t k = 0; k < moduli.size(); ++k)
        builder_.add_material(fields_.size() > 1  ? std::to_string(i + 1)
                              : moduli.size() > 1 ? std::to_string(k + 1)
                                                  : "",
                              moduli[k], poisson, {}, where(*part));
    }
  }

  /// Takes the law of a force field. @throws std::invalid_argument  where another one has another law
  void add_field(const XmlPart& part, std::vector<double> moduli, double poisson, const char* model) {
    if (moduli.empty()) file_.fail(part, fmt::format("{} has no youngModulus; write it", part.type));
    const bool has_own = std::ranges::any_of(
        file_.parts(), [&](const XmlPart& each) { return each.node == part.node && each.has("tetrahedra"); });
    if (part.node == state_.node || !has_own) only(field_, part);
    if (std::exchange(builder_.scene.model, model) != model && !fields_.empty())
      file_.fail(part, "the force fields are of different laws, and bodies here have one; give all the same");
    fields_.push_back({&part, std::move(moduli), poisson});
  }

  /// Rotations of elements by QR ("large") and by polar decomposition differ for large strains alone.
  void read_elastic(const XmlPart& part) {
    const std::string_view method = part.tag.attribute("method", "large");
    if (!is_listed(method, "small|large|polar|svd|qr|none"))
      file_.fail(part, fmt::format("the method {} of {} is not understood; take small, large, polar or svd",
                                   in_quotes(method), part.type));
    const bool is_linear = method == "small" || method == "none";
    if (!is_linear && method != "polar")
      builder_.scene.notes.push_back(fmt::format(
          "elements are rotated by polar decomposition and in SOFA by method {}; small motions are the same",
          in_quotes(method)));
    std::vector<double> moduli = sorted_moduli(file_.numbers(part, "youngModulus"));
    add_field(part, std::move(moduli), common_number(part, "poissonRatio"),
              is_linear ? "fem_cauchy" : "fem_corotational");
  }

  /// SOFA's StVenantKirchhoff has mu and lambda, its NeoHookean mu and the bulk modulus.
  void read_hyperelastic(const XmlPart& part) {
    const std::string_view material = part.tag.attribute("materialName");
    if (!is_listed(material, "StVenantKirchhoff|NeoHookean"))
      file_.fail(part, fmt::format("the material {} is not understood; take StVenantKirchhoff or NeoHookean",
                                   in_quotes(material)));
    const std::vector<double> values = file_.numbers(part, "ParameterSet", 2);
    const bool is_neo_hookean = material == "NeoHookean";
    const double mu = values[0], lambda = is_neo_hookean ? values[1] - 2 * mu / 3 : values[1];
    add_field(part, {mu * (3 * lambda + 2 * mu) / (lambda + mu)}, lambda / (2 * (lambda + mu)),
              is_neo_hookean ? "fem_neo_hookean" : "fem_green");
    if (is_neo_hookean) builder_.scene.notes.push_back(neo_hookean_differs("SOFA's NeoHookean"));
  }

  /// One linear solve a step, as for Newmark in SOFA; Rayleigh damping alpha M + beta K.
  void read_implicit(const XmlPart& part) {
    take_solver(part, "linearly_implicit_euler");
    if (part.type.starts_with("Newmark"))
      builder_.scene.method = fmt::format("newmark:beta={},gamma={}", to_text(number(part, "beta", 0.25)),
                                          to_text(number(part, "gamma", 0.5)));
    alpha_ += number(part, "rayleighMass", 0);
    beta_ += number(part, "rayleighStiffness", 0);
  }

  void read_springs(const XmlPart& part) { only(springs_, part); }

  /// A spring on every edge, slack at rest, of one stiffness or of one Young's modulus, and one ratio of
  /// damper and stiffness.
  void set_springs() {
    const EdgeTable edges = edge_table(mesh_.mesh);
    const Eigen::Index count = edges.edges.cols();
    Eigen::ArrayXd k = Eigen::ArrayXd::Zero(count), c = k;
    springs_->type == "MeshSpringForceField" ? take_mesh_springs(k, c) : take_listed_springs(edges, k, c);
    if (!(k > 0).all())
      file_.fail(*springs_,
                 "an edge of a tetrahedron has no spring, and bodies of springs here have one on each; "
                 "add it");
    const auto are_same = [](const Eigen::ArrayXd& values) {
      return values.maxCoeff() - values.minCoeff() <= rounding * values.abs().maxCoeff();
    };
    TissueSettings unit{.model = tissue_model("mass_spring")};
    unit.materials.front().young = 1;
    Eigen::ArrayXd of_unit(count);
    const auto springs = tissue_springs(mesh_.mesh, edges, surface_of(mesh_.mesh), unit);
    for (Eigen::Index e = 0; e < count; ++e) of_unit[e] = springs[static_cast<std::size_t>(e)].stiffness;
    if (!are_same(c / k))
      file_.fail(*springs_,
                 "dampers are not in one ratio to the stiffness of their springs, as here; give one");
    if (!are_same(k) && !are_same(k / of_unit))
      file_.fail(*springs_,
                 "springs have neither one stiffness nor that of one Young's modulus, as here; give one "
                 "stiffness");
    builder_.scene.model = "mass_spring";
    builder_.set_springs(are_same(k) ? std::optional(k[0]) : std::nullopt, (k / of_unit)[0], (c / k)[0]);
  }

  /// One for all edges of tetrahedra, those of triangles and lines among them.
  void take_mesh_springs(Eigen::ArrayXd& k, Eigen::ArrayXd& c) {
    const XmlPart& part = *springs_;
    const auto of_tetrahedra = [&](const std::string& what) {
      return number(part, part.has("tetras" + what) ? "tetras" + what : "tetrahedra" + what, 0);
    };
    for (const auto& [what, values] : {std::pair(std::string("Stiffness"), &k), {"Damping", &c}}) {
      const double own = of_tetrahedra(what);
      for (const char* other : {"triangles", "lines"})
        if (part.has(other + what) && number(part, other + what, 0) != own &&
            number(part, std::string(other) + "Stiffness", 0) != 0)
          file_.fail(part, fmt::format("{}{} is not that of tetrahedra; give both the same", other, what));
      *values = own;
    }
  }

  /// "point point stiffness damper length" of each.
  void take_listed_springs(const EdgeTable& edges, Eigen::ArrayXd& k, Eigen::ArrayXd& c) {
    const std::vector<double> values = file_.numbers(*springs_, "spring");
    if (values.size() % 5 != 0)
      file_.fail(*springs_,
                 fmt::format("spring has {} numbers, which are not five of each; correct it", values.size()));
    const auto points = static_cast<double>(mesh_.mesh.point_count());
    for (std::size_t i = 0; i < values.size(); i += 5) {
      const double one = values[i], other = values[i + 1];
      const bool are_points = one >= 0 && other >= 0 && one < points && other < points;
      const auto a = static_cast<TetMesh::Index>(are_points ? one : 0),
                 b = static_cast<TetMesh::Index>(are_points ? other : 0);
      const auto edge = edges.find(a, b);
      if (edge < 0 || k[edge] != 0)
        file_.fail(*springs_,
                   fmt::format("the spring between points {} and {} is not the only one on an edge of a "
                               "tetrahedron, which bodies of springs here have; remove it",
                               to_text(one), to_text(other)));
      const double length = (mesh_.mesh.points.col(a) - mesh_.mesh.points.col(b)).norm();
      if (!(std::abs(values[i + 4] - length) <= rounding * length))
        file_.fail(*springs_,
                   fmt::format("the spring between points {} and {} has length {} at rest and not {}, so "
                               "that it is stretched, which is not read",
                               to_text(one), to_text(other), to_text(values[i + 4]), to_text(length)));
      k[edge] = values[i + 2];
      c[edge] = values[i + 3];
    }
  }

  /// Dead loads: one of each point, the same on all, or one that all share.
  void read_forces(const XmlPart& part) {
    const std::vector<double> indices = file_.numbers(part, "indices");
    const char* const given = part.has("forces") ? "forces" : part.has("force") ? "force" : "totalForce";
    const std::vector<double> values = file_.numbers(part, given);
    const bool of_each = part.has("forces") && values.size() != 3;
    if (indices.empty() || values.size() != (of_each ? 3 * indices.size() : 3) ||
        (part.has("forces") && !of_each && indices.size() != 1) ||
        part.has("forces") + part.has("force") + part.has("totalForce") != 1)
      file_.fail(part,
                 "ConstantForceField needs indices, and forces of each, or force or totalForce; correct it");
    const double share = part.has("totalForce") ? 1 / static_cast<double>(indices.size()) : 1;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (!(indices[i] >= 0 && indices[i] < static_cast<double>(mesh_.mesh.point_count())) ||
          indices[i] != std::floor(indices[i]))
        file_.fail(part, fmt::format("a force acts on point {}, but there are {}, counted from 0; correct it",
                                     to_text(indices[i]), mesh_.mesh.point_count()));
      const double* const force = values.data() + (of_each ? 3 * i : 0);
      builder_.add_force(mesh_.point_numbers[static_cast<std::size_t>(indices[i])],
                         share * Eigen::Vector3d(force[0], force[1], force[2]));
    }
  }

  void read_velocity_damping(const XmlPart& part) { only(velocity_damping_, part); }

  /// -c v with c = alpha m at every point.
  void set_velocity_damping() {
    if (!velocity_damping_) return;
    const std::vector<double> c = file_.numbers(*velocity_damping_, "dampingCoefficient");
    const bool fits = std::ssize(c) == 3 * masses_.size();
    const double alpha =
        fits ? Eigen::Map<const Eigen::ArrayXd>(c.data(), std::ssize(c)).sum() / (3 * masses_.sum()) : 0;
    for (Eigen::Index i = 0; i < masses_.size(); ++i)
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        if (!fits || !(std::abs(c[static_cast<std::size_t>(3 * i + axis)] - alpha * masses_[i]) <=
                       rounding * alpha * masses_.maxCoeff()))
          file_.fail(*velocity_damping_,
                     "dampingCoefficient is not in one ratio to the mass of its points, as here; "
                     "write three numbers of each point, or leave it out");
    alpha_ += alpha;
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
  const SofaStates states_{file_};
  MeshFile mesh_;
  std::vector<TetMesh::Index> region_numbers_ = region_numbers();
  const XmlPart *field_ = nullptr, *springs_ = nullptr, *mass_ = nullptr, *solver_ = nullptr,
                *gradients_ = nullptr, *velocity_damping_ = nullptr;
  std::vector<Field> fields_;
  double alpha_ = 0, beta_ = 0, step_ = 0.01;  // SOFA's default of the root
  std::vector<double> densities_;              ///< of the body, or of each region
  Eigen::VectorXd masses_;                     ///< of points, in the units of the file
  Eigen::Vector3d gravity_{0, -9.81, 0};
};

}  // namespace

std::vector<std::string> sofa_methods() {
  std::vector<std::string> ids;
  for (const SofaMethod& each : sofa_solvers) ids.emplace_back(each.method);
  return ids;
}

SofaStep sofa_step(const std::string& method, double h) {
  const Method made = find_method(method);
  const std::string id = made.id.substr(0, made.id.find(':'));
  const auto* const found = std::ranges::find(sofa_solvers, id, &SofaMethod::method);
  if (found == sofa_solvers.end())
    throw input_error("SOFA has no solver that steps as {}; take {}", made.id,
                      fmt::join(sofa_methods(), ", "));
  return {.h = h,
          .solver = found->solver,
          .beta = made.parameter("beta").value_or(SofaStep{}.beta),
          .gamma = made.parameter("gamma").value_or(SofaStep{}.gamma)};
}

void read_sofa_scene(const std::string& file, std::string_view bytes, SceneBuilder& builder) {
  builder.take_units();
  const XmlFile parsed(file, bytes, sofa_root);
  SofaSceneReader(parsed, builder).read();
}

}  // namespace hmax
