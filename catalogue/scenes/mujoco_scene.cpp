/// A flexcomp of MuJoCo's .xml as a body.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "catalogue/scenes/scene_builder.hpp"
#include "core/numbers.hpp"
#include "core/text/split.hpp"
#include "problems/mesh/files/scenes/mujoco_file.hpp"

namespace hmax {

namespace {

/// What says nothing of how a body moves.
constexpr std::string_view without_effect =
    "compiler|statistic|visual|size|default|asset|custom|sensor|option|worldbody|light|camera|site";

/// What has no counterpart in a body, or acts on it.
struct Refused {
  std::string_view type, why;
};
constexpr std::array<Refused, 8> refused{{{"include", "what another file holds is not read; write it here"},
                                          {"keyframe", "a body begins at rest, where its points are"},
                                          {"contact", "contacts are not read"},
                                          {"geom", "contacts with geoms are not read"},
                                          {"equality", "constraints are not read"},
                                          {"tendon", "tendons are not read"},
                                          {"actuator", "actuators are not read"},
                                          {"extension", "plugins are not read"}}};

struct MujocoIntegrator {
  std::string_view name, method;
};
/// `implicit` and `implicitfast` have no derivative of the elasticity and damping of points of their own, so
/// that both are explicit. `discrete`: (M + h D + h^2 K) dv = h (f - h K v), with K at rest as ours.
constexpr std::array<MujocoIntegrator, 5> integrators{{{"Euler", "symplectic_euler"},
                                                       {"discrete", "linearly_implicit_euler"},
                                                       {"implicit", "symplectic_euler"},
                                                       {"implicitfast", "symplectic_euler"},
                                                       {"RK4", "rk4"}}};

class MujocoSceneReader {
 public:
  MujocoSceneReader(const XmlFile& file, SceneBuilder& builder)
      : file_(file), builder_(builder), flex_(mujoco_flexcomp(file)) {}

  void read() {
    const MeshFile mesh = mujoco_mesh(file_);
    const XmlPart& root = file_.parts().front();
    for (const XmlPart* part : file_.within(root)) {
      look_at(*part);
      if (part->type == "option") read_option(*part);
      if (part->type == "worldbody") look_within(*part);
      if (part->type == "compiler" && number(*part, "settotalmass", -1) > 0)
        refuse("settotalmass", *part, "settotalmass is there, and the mass of the flexcomp is read");
    }
    read_flexcomp();
    set_method();
    const double mass = number(flex_, "mass", 1);
    if (!(mass > 0)) file_.fail(flex_, "mass is not positive; correct it");
    builder_.set_mass(mass, true);
    builder_.scene.model = "fem_green";
    builder_.set_gravity(gravity_);
    builder_.set_step(step_);
    const bool pins = std::ranges::find(mesh.groups, mujoco_pinned, &MeshGroup::name) != mesh.groups.end();
    builder_.set_support(pins ? mujoco_pinned : "");
    builder_.scene.notes.emplace_back("contacts of the flexcomp with itself and others are not read");
  }

 private:
  void refuse(std::string_view part, const XmlPart& at, const std::string& what) {
    builder_.refuse(part, fmt::format("{}, line {}: ", file_.name(), at.place), what);
  }

  double number(const XmlPart& part, std::string_view attribute, double otherwise) {
    return part.has(attribute) ? file_.numbers(part, attribute, 1).front() : otherwise;
  }

  void look_at(const XmlPart& part) {
    if (is_listed(part.type, without_effect)) return;
    for (const Refused& each : refused)
      if (each.type == part.type)
        return refuse(part.type, part, fmt::format("{} is there, and {}", part.type, each.why));
    refuse(part.type, part, fmt::format("{} is not understood", in_quotes(part.type)));
  }

  [[nodiscard]] bool holds_flexcomp(const XmlPart& part) const {
    for (const XmlPart* above = &flex_; above; above = file_.parent(*above))
      if (above == &part) return true;
    return false;
  }

  /// Bodies around the flexcomp place it; they must not move.
  void look_within(const XmlPart& outer) {
    for (const XmlPart* each : file_.within(outer)) {
      const XmlPart& part = *each;
      if (&part == &flex_) continue;
      if (is_listed(part.type, "body|frame")) {
        if (holds_flexcomp(part))
          look_within(part);
        else
          refuse(part.type, part,
                 fmt::format("a {} is beside the flexcomp, and bodies are of one", part.type));
      } else if (is_listed(part.type, "joint|freejoint")) {
        file_.fail(part, "the flexcomp is in a body that moves, and bodies stand; remove the joint");
      } else if (part.type == "geom" && part.tag.attribute("contype") == "0" &&
                 part.tag.attribute("conaffinity") == "0") {
        continue;
      } else if (part.type != "inertial") {
        look_at(part);
      }
    }
  }

  void read_option(const XmlPart& option) {
    constexpr std::string_view passed =
        "apirate|impratio|tolerance|ls_tolerance|noslip_tolerance|ccd_tolerance|mpr_tolerance|sleep_tolerance|"
        "magnetic|o_margin|o_solref|o_solimp|o_friction|cone|jacobian|solver|iterations|ls_iterations|"
        "noslip_iterations|ccd_iterations|mpr_iterations|sdf_iterations|sdf_initpoints|actuatorgroupdisable|"
        "collision";
    for (const auto& [name, value] : option.tag.attributes) {
      if (name == "timestep") {
        step_ = number(option, name, 0);
        if (!(step_ > 0)) file_.fail(option, "timestep is not positive; correct it");
      } else if (name == "gravity") {
        const std::vector<double> g = file_.numbers(option, name, 3);
        gravity_ = Eigen::Vector3d(g[0], g[1], g[2]);
      } else if (name == "integrator") {
        integrator_ = value;
        integrator_place_ = &option;
      } else if (is_listed(name, "density|viscosity|wind")) {
        for (const double each : file_.numbers(option, name))
          if (each != 0)
            refuse(name, option, fmt::format("{} is there, and bodies have no medium around them", name));
      } else if (!is_listed(name, passed)) {
        refuse(name, option, fmt::format("{} of option is not understood", in_quotes(name)));
      }
    }
    for (const XmlPart* flag : file_.within(option)) read_flag(*flag);
  }

  void set_method() {
    const auto* const known = std::ranges::find(integrators, integrator_, &MujocoIntegrator::name);
    if (known == integrators.end())
      file_.fail(
          *integrator_place_,
          fmt::format("the integrator is {}, and Euler, implicit, implicitfast, RK4 and discrete are read",
                      in_quotes(integrator_)));
    builder_.scene.integrator = known->name;
    builder_.scene.method = known->method;
  }

  void read_flag(const XmlPart& flag) {
    for (const auto& [name, value] : flag.tag.attributes) {
      if (value != "disable") continue;
      if (name == "gravity")
        gravity_.setZero();
      else if (is_listed(name, "passive|spring|damper"))
        refuse(name, flag,
               fmt::format("{} is disabled, so that the flexcomp has no elasticity or damping", name));
    }
  }

  void read_flexcomp() {
    constexpr std::string_view known =
        "name|type|dim|count|spacing|scale|point|element|file|mass|pos|quat|dof|rigid|radius|inertiabox|rgba|"
        "group|flatskin|material|texcoord|origin";
    for (const auto& [name, value] : flex_.tag.attributes)
      if (!is_listed(name, known))
        refuse(name, flex_, fmt::format("{} of flexcomp is not understood", in_quotes(name)));
    if (const std::string_view dof = flex_.tag.attribute("dof", "full"); dof != "full")
      file_.fail(flex_, fmt::format("dof is {}, and points that move by themselves are read; write full",
                                    in_quotes(dof)));
    if (flex_.tag.attribute("rigid") == "true") file_.fail(flex_, "the flexcomp is rigid; remove it");
    for (const XmlPart* part : file_.within(flex_)) {
      if (part->type == "edge")
        read_edge(*part);
      else if (part->type == "plugin")
        file_.fail(*part,
                   "a plugin gives the flexcomp its elasticity, as before MuJoCo 3.3; write "
                   "<elasticity young= poisson= damping=/>");
      else if (part->type == "elasticity" && elasticity_)
        file_.fail(*part, "elasticity is given twice; remove one");
      else if (part->type == "elasticity")
        elasticity_ = part;
      else if (!is_listed(part->type, "contact|pin"))
        refuse(part->type, *part, fmt::format("{} of a flexcomp is not understood", in_quotes(part->type)));
    }
    if (!elasticity_ || !(number(*elasticity_, "young", 0) > 0))
      file_.fail(elasticity_ ? *elasticity_ : flex_,
                 "the flexcomp has no elasticity with a positive young; add it");
    for (const auto& [name, value] : elasticity_->tag.attributes)
      if (!is_listed(name, "young|poisson|damping|thickness|elastic2d"))
        refuse(name, *elasticity_, fmt::format("{} of elasticity is not understood", in_quotes(name)));
    builder_.add_material("", number(*elasticity_, "young", 0), number(*elasticity_, "poisson", 0),
                          std::nullopt, fmt::format("{}, line {}", file_.name(), elasticity_->place));
    const double damping = number(*elasticity_, "damping", 0);
    builder_.set_damping(0, damping);
    if (damping != 0)
      builder_.scene.notes.emplace_back(
          "MuJoCo damps with the stiffness of the state, hmax with that at rest");
  }

  void read_edge(const XmlPart& edge) {
    if (edge.tag.attribute("equality", "false") != "false")
      refuse("edge", edge, "edges are held by constraints, which are not read");
    if (number(edge, "stiffness", 0) != 0 || number(edge, "damping", 0) != 0)
      refuse("edge", edge, "edges are springs besides the elasticity, which are not read");
  }

  const XmlFile& file_;
  SceneBuilder& builder_;
  const XmlPart& flex_;
  const XmlPart *elasticity_ = nullptr, *integrator_place_ = nullptr;
  std::string_view integrator_ = "Euler";
  Eigen::Vector3d gravity_{0, 0, -9.81};
  double step_ = 0.002;
};

}  // namespace

void read_mujoco_scene(const std::string& file, std::string_view bytes, SceneBuilder& builder) {
  builder.take_units();
  const XmlFile parsed(file, bytes, mujoco_root);
  MujocoSceneReader(parsed, builder).read();
}

}  // namespace hmax
