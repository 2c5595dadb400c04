/// FEBio's .feb as a body.
#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "catalogue/scenes/scene_builder.hpp"
#include "core/numbers.hpp"
#include "core/text/split.hpp"
#include "problems/mesh/files/scenes/febio_file.hpp"

namespace hmax {

namespace {

class FebioSceneReader {
 public:
  FebioSceneReader(const XmlFile& file, SceneBuilder& builder)
      : file_(file), builder_(builder), mesh_(febio_mesh(file)) {
    for (const MeshGroup& group : mesh_.groups) sets_.emplace(group.name, &group);
  }

  void read() {
    const XmlPart& root = file_.parts().front();
    take_units(root);
    require_four_nodes(mesh_);
    check_children(root);
    for (const XmlPart& part : file_.parts()) {
      const XmlPart* const parent = file_.parent(part);
      if (parent == &root)
        read_section(part);
      else if (parent && parent->type == "MeshDomains" && part.type == "SolidDomain")
        read_domain(part);
      else if (parent && parent->type == "Control" && part.type == "solver")
        read_solver(part);
      else if (parent && parent->type == "Control" && part.type == "time_stepper")
        read_stepper(part);
      else if (parent && parent->type == "Loads")
        read_load(part);
      else if (parent && parent->type == "Boundary" && part.type == "bc" && !part.has("node_set"))
        refuse("Boundary", part,
               fmt::format("the bc is {}, and zero displacement is read",
                           in_quotes(part.tag.attribute("type"))));
    }
    if (regions_ != mesh_.names.size() || regions_ == 0)
      file_.fail(root,
                 "there is not one SolidDomain of each Elements, which gives it a material; correct them");
    read_control();
    set_supports();
    builder_.set_gravity(gravity_);
    builder_.scene.regions = mesh_.names;
  }

 private:
  /// What may be in a part.
  struct Known {
    std::string_view parent, types, attributes;
    bool is_single = false;  ///< is there at most once
  };

  static std::vector<Known> known(std::string_view parent) {
    static constexpr std::array<Known, 23> all{
        {{"febio_spec", "Module", "type", true},
         {"febio_spec", "Control", "", true},
         // Load curves act through loads and conditions.
         {"febio_spec", "Globals|Material|Mesh|MeshDomains|Boundary|Loads|LoadData|Output", ""},
         {"Module", "units", ""},
         {"Control", "analysis", "type", true},
         {"Control", "solver", "type", true},
         {"Control", "step_size|time_steps", "", true},
         {"Control", "time_stepper", "type", true},
         {"time_stepper", "dtmin|dtmax|dtforce|max_retries|opt_iter|aggressiveness|cutback", "lc"},
         {"Control",
          "plot_level|plot_range|plot_stride|plot_zero_state|output_level|output_stride|adaptor_re_solve|"
          "print_level",
          ""},
         {"solver", "rhoi|alpha|beta|gamma", "", true},
         // How equations are solved, exactly.
         {"solver",
          "symmetric_stiffness|equation_scheme|equation_order|optimize_bw|lstol|lsmin|lsiter|max_refs|"
          "check_zero_diagonal|zero_diagonal_tol|force_partition|reform_each_time_step|reform_augment|"
          "diverge_reform|min_residual|max_residual|dtol|etol|rtol|logSolve|qn_method|linear_solver",
          "type"},
         {"Mesh", "Nodes|Elements|NodeSet|Surface|Edge|ElementSet|PartList|SurfacePair", "name|type"},
         {"MeshDomains", "SolidDomain", "name|mat|type|elem_type"},
         {"Boundary", "bc", "name|type|node_set|surface"},
         {"Loads", "nodal_load", "name|type|node_set"},
         {"Loads", "body_load", "name|type"},
         {"nodal_load", "dof", "", true},
         {"nodal_load", "scale|value", "lc", true},
         {"nodal_load", "relative", "", true},
         {"body_load", "x|y|z|force", "lc", true},
         {"Material", "material", "id|name|type"},
         {"material", "E|v|density", "", true}}};
    std::vector<Known> of_parent;
    std::ranges::copy_if(all, std::back_inserter(of_parent),
                         [&](const Known& each) { return each.parent == parent; });
    return of_parent;
  }

  /// Refuses what is not known in a part, and what is there twice.
  void check_children(const XmlPart& parent) {
    const std::vector<Known> here = known(parent.type);
    const std::string of = file_.parent(parent) ? fmt::format(" of a {}", parent.type) : std::string();
    std::set<std::string_view> seen;
    for (const XmlPart* child : file_.within(parent)) {
      const XmlPart& part = *child;
      const auto found =
          std::ranges::find_if(here, [&](const Known& each) { return is_listed(part.type, each.types); });
      if (found == here.end()) {
        refuse(part.type, part, fmt::format("{}{} is not understood", in_quotes(part.type), of));
        continue;
      }
      for (const auto& [name, value] : part.tag.attributes)
        if (!is_listed(name, found->attributes))
          refuse(name, part, fmt::format("{} of {} is not understood", in_quotes(name), part.type));
      if (!seen.insert(part.type).second && found->is_single)
        file_.fail(part, fmt::format("{} is given twice; remove one", part.type));
    }
  }

  void refuse(std::string_view part, const XmlPart& at, const std::string& what) {
    builder_.refuse(part, fmt::format("{}, line {}: ", file_.name(), at.place), what);
  }

  /// Of the system that the file names; an unknown one says nothing.
  void take_units(const XmlPart& root) {
    constexpr std::array<std::pair<std::string_view, const char*>, 7> systems{{{"SI", "m,kg,s"},
                                                                               {"CGS", "cm,g,s"},
                                                                               {"mm-N-s", "mm,t,s"},
                                                                               {"mm-kg-s", "mm,kg,s"},
                                                                               {"mm-g-s", "mm,g,s"},
                                                                               {"mm-mg-s", "mm,1e-6,s"},
                                                                               {"um-nN-s", "1e-6,g,s"}}};
    const XmlPart* const above = file_.first(root, "Module");
    const XmlPart* const units = above ? file_.first(*above, "units") : nullptr;
    const std::string_view called = units ? trimmed(units->text) : "";
    const auto* const known = std::ranges::find(systems, called, [](const auto& each) { return each.first; });
    if (known == systems.end()) return builder_.take_units();
    builder_.take_units(fmt::format("{}, line {}: ", file_.name(), units->place), known->second);
  }

  void read_section(const XmlPart& part) {
    if (part.type == "Module" && part.tag.attribute("type") != "solid")
      file_.fail(part,
                 fmt::format("the module is {}, and solid is read", in_quotes(part.tag.attribute("type"))));
    if (part.type == "Control") control_ = &part;
    if (!known(part.type).empty()) check_children(part);
  }

  void read_solver(const XmlPart& part) {
    if (const std::string_view type = part.tag.attribute("type", "solid"); type != "solid")
      file_.fail(part, fmt::format("the solver is {}, and solid is read", in_quotes(type)));
    check_children(part);
    solver_ = &part;
  }

  /// It shortens steps whose Newton iteration fails, and may lengthen them.
  void read_stepper(const XmlPart& part) {
    check_children(part);
    const auto longest = number(part, "dtmax");
    builder_.scene.notes.push_back(
        "time_stepper changes the step during a run; the step that is judged is step_size" +
        (longest ? fmt::format(", and dtmax is {}", to_text(*longest)) : std::string()));
  }

  /// What a load is multiplied with: the value of its load curve where that is one at all times.
  double amplitude_of(const XmlPart& part) {
    const std::string_view called = part.tag.attribute("lc");
    if (called.empty() || called == "0") return 1;
    const auto& [controller, steady] = controller_of(part, called);
    if (steady) return *steady;
    refuse(
        "lc", part,
        fmt::format("{} follows the load controller {} of line {}, which changes with time, and loads here "
                    "are steady; write the load at the time that you ask for, without it",
                    part.type, called, controller->place));
    return 1;
  }

  /// A load controller, and its value where it has one at all times.
  struct Controller {
    const XmlPart* part;
    std::optional<double> steady;
  };

  /// Of an id that a part names. Each is read once, as all loads of a file may follow one.
  const Controller& controller_of(const XmlPart& part, std::string_view called) {
    if (const auto known = controllers_.find(called); known != controllers_.end()) return known->second;
    const auto controller = std::ranges::find_if(file_.parts(), [&](const XmlPart& each) {
      return each.type == "load_controller" && each.tag.attribute("id") == called;
    });
    if (controller == file_.parts().end())
      file_.fail(part, fmt::format("there is no load_controller {}; define it", in_quotes(called)));
    std::set<double> values;
    for (const XmlPart& each : file_.parts())
      if (is_listed(each.type, "pt|point") && is_in(each, *controller)) {
        const std::vector<double> pair = file_.numbers(each);
        if (pair.size() != 2)
          file_.fail(each, "a point of a load curve is not a time and a value; correct it");
        values.insert(pair[1]);
      }
    const bool is_steady = controller->tag.attribute("type") == "loadcurve" && values.size() == 1;
    return controllers_
        .emplace(called, Controller{&*controller, is_steady ? std::optional(*values.begin()) : std::nullopt})
        .first->second;
  }

  [[nodiscard]] bool is_in(const XmlPart& part, const XmlPart& outer) const {
    for (const XmlPart* above = file_.parent(part); above; above = file_.parent(*above))
      if (above == &outer) return true;
    return false;
  }

  /// Numbers of a part of a load at its amplitude; zeros where a part that may be left out is.
  Eigen::VectorXd amounts(const XmlPart& load, std::string_view type, Eigen::Index count) {
    const XmlPart* const part = file_.first(load, type);
    if (!part && !is_listed(type, "x|y|z"))
      file_.fail(load, fmt::format("{} has no {}; add it", load.type, type));
    if (!part) return Eigen::VectorXd::Zero(count);
    const std::vector<double> values = file_.numbers(*part);
    if (std::ssize(values) != count)
      file_.fail(*part,
                 fmt::format("{} has {} numbers and should have {}; correct it", type, values.size(), count));
    return amplitude_of(*part) * Eigen::Map<const Eigen::VectorXd>(values.data(), count);
  }

  void read_load(const XmlPart& load) {
    if (!is_listed(load.type, "nodal_load|body_load")) return;
    check_children(load);
    const std::string_view type = load.tag.attribute("type");
    if (load.type == "nodal_load") return read_nodal_load(load, type);
    // FEBio subtracts it: "const" and "body force" point against the acceleration.
    if (type == "const")
      gravity_ -=
          Eigen::Vector3d(amounts(load, "x", 1)[0], amounts(load, "y", 1)[0], amounts(load, "z", 1)[0]);
    else if (type == "body force")
      gravity_ -= amounts(load, "force", 3);
    else
      refuse(load.type, load,
             fmt::format("the body_load is {}, and const and body force are read", in_quotes(type)));
  }

  /// A force on each point of a set.
  void read_nodal_load(const XmlPart& load, std::string_view type) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    if (type == "nodal_load") {
      const XmlPart* const dof = file_.first(load, "dof");
      const std::size_t axis =
          dof ? std::string_view("xyz").find(trimmed(dof->text)) : std::string_view::npos;
      if (!dof || trimmed(dof->text).size() != 1 || axis == std::string_view::npos)
        file_.fail(load, "the dof of a nodal_load is not x, y or z; correct it");
      force[static_cast<Eigen::Index>(axis)] = amounts(load, "scale", 1)[0];
    } else if (type == "nodal_force") {
      force = amounts(load, "value", 3);
    } else {
      return refuse(
          load.type, load,
          fmt::format("the nodal_load is {}, and nodal_load and nodal_force are read", in_quotes(type)));
    }
    if (number(load, "relative").value_or(0) != 0)
      refuse("relative", load, "a relative nodal_load adds to that of an earlier step, and one step is read");
    const std::string_view called = load.tag.attribute("node_set");
    const auto set = sets_.find(called);
    if (set == sets_.end())
      file_.fail(load,
                 fmt::format("there is no NodeSet {}; define it, or correct the name", in_quotes(called)));
    for (const TetMesh::Index corner : set->second->corners)
      builder_.add_force(mesh_.point_numbers[static_cast<std::size_t>(corner)], force);
  }

  std::optional<double> number(const XmlPart& parent, std::string_view type) {
    const XmlPart* const part = file_.first(parent, type);
    if (!part) return std::nullopt;
    const std::vector<double> values = file_.numbers(*part);
    if (values.size() != 1 || !file_.within(*part).empty())
      file_.fail(*part, fmt::format("{} is not one number; correct it", type));
    return values.front();
  }

  /// FEBio's isotropic elastic solid is that of St. Venant and Kirchhoff.
  void read_domain(const XmlPart& domain) {
    // Of four nodes, whose volume changes evenly, both are the same.
    if (const std::string_view type = domain.tag.attribute("type", "elastic-solid");
        !is_listed(type, "elastic-solid|three-field-solid"))
      file_.fail(domain,
                 fmt::format("the SolidDomain is {}, and elastic-solid and three-field-solid are read",
                             in_quotes(type)));
    check_children(domain);
    const std::string_view called = domain.tag.attribute("mat");
    const auto material = std::ranges::find_if(file_.parts(), [&](const XmlPart& part) {
      return part.type == "material" && (part.name() == called || part.tag.attribute("id") == called);
    });
    if (material == file_.parts().end())
      file_.fail(domain,
                 fmt::format("there is no material {}; define it, or correct the name", in_quotes(called)));
    const std::string_view type = material->tag.attribute("type");
    if (!is_listed(type, "isotropic elastic|neo-Hookean"))
      file_.fail(*material, fmt::format("the material is {}, and isotropic elastic and neo-Hookean are read",
                                        in_quotes(type)));
    check_children(*material);
    const std::string model = type == "neo-Hookean" ? "fem_neo_hookean" : "fem_green";
    if (model == "fem_neo_hookean" && regions_ == 0)
      builder_.scene.notes.push_back(neo_hookean_differs("FEBio's neo-Hookean"));
    if (std::exchange(builder_.scene.model, model) != model && regions_ > 0)
      file_.fail(domain,
                 "the regions are of different laws, and bodies here have one; give all the same type");
    const auto young = number(*material, "E"), poisson = number(*material, "v"),
               density = number(*material, "density");
    if (!young || !poisson || !density)
      file_.fail(*material, "the material does not have E, v and density; add them");
    ++regions_;
    if (std::ranges::none_of(mesh_.names, [&](const auto& each) { return each.second == domain.name(); }))
      file_.fail(domain, fmt::format("there are no Elements {}; correct the name", in_quotes(domain.name())));
    builder_.add_material(mesh_.names.size() == 1 ? "" : std::string(domain.name()), *young, *poisson,
                          *density, fmt::format("{}, line {}", file_.name(), material->place));
  }

  /// Newmark's method, or generalized alpha where the spectral radius of infinite steps is given.
  void read_control() {
    const XmlPart* const analysis = control_ ? file_.first(*control_, "analysis") : nullptr;
    const std::string kind =
        analysis ? lower(analysis->has("type") ? analysis->tag.attribute("type") : trimmed(analysis->text))
                 : "static";
    if (!is_listed(kind, "static|dynamic"))
      file_.fail(*analysis, fmt::format("the analysis is {}; take STATIC or DYNAMIC", in_quotes(kind)));
    if (kind == "static") return;
    const auto of_solver = [&](std::string_view type, double otherwise) {
      return solver_ ? number(*solver_, type).value_or(otherwise) : otherwise;
    };
    const double radius = of_solver("rhoi", -2);
    if (of_solver("alpha", 1) != 1)
      file_.fail(*solver_, "alpha of the solver is not 1, which is not read; give rhoi");
    builder_.scene.integrator = "DYNAMIC";
    builder_.scene.method =
        radius >= 0 && radius <= 1 ? fmt::format("generalized_alpha:rho_inf={}", to_text(radius))
        : radius == -1             ? "newmark"
                                   : fmt::format("newmark:beta={},gamma={}", to_text(of_solver("beta", 0.25)),
                                                 to_text(of_solver("gamma", 0.5)));
    builder_.scene.notes.emplace_back(
        "the program steps a consistent mass and hmax a lumped one; modes of few elements differ");
    const auto step = number(*control_, "step_size");
    if (step && !(*step > 0))
      file_.fail(*control_, fmt::format("step_size is {} but must be positive; correct it", to_text(*step)));
    if (step) builder_.set_step(*step);
  }

  void set_supports() {
    if (sets_.contains(febio_otherwise_held))
      builder_.refuse("Boundary", file_.name() + ": ",
                      "a node is not fixed in x, y and z alone, the only way that is read");
    builder_.set_support(sets_.contains(febio_held) ? febio_held : "");
  }

  const XmlFile& file_;
  SceneBuilder& builder_;
  MeshFile mesh_;
  std::map<std::string_view, const MeshGroup*> sets_;  ///< of mesh_, by name
  std::map<std::string_view, Controller> controllers_;
  const XmlPart *control_ = nullptr, *solver_ = nullptr;
  std::size_t regions_ = 0;
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
};

}  // namespace

void read_febio_scene(const std::string& file, std::string_view bytes, SceneBuilder& builder) {
  const XmlFile parsed(file, bytes, febio_root);
  FebioSceneReader(parsed, builder).read();
}

}  // namespace hmax
