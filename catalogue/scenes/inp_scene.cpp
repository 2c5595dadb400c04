/// CalculiX's and Abaqus' .inp as a body: what each keyword is taken for stands in the function that reads
/// it.
#include <array>
#include <map>
#include <optional>
#include <set>
#include <unordered_set>

#include <Eigen/Core>
#include <fmt/format.h>

#include "catalogue/scenes/scene_builder.hpp"
#include "core/numbers.hpp"
#include "core/text/split.hpp"
#include "problems/mesh/files/scenes/inp_file.hpp"

namespace hmax {

namespace {

struct Material {
  std::int64_t place = 0, elastic_place = 0, density_place = 0;
  std::optional<double> young, poisson, density;
  double alpha = 0, beta = 0;
};

struct Amplitude {
  std::int64_t place = 0;
  std::optional<double> value;  ///< at all times; nothing where it changes
};

/// Keywords on which neither the body nor its steps depend, whatever their parameters are, and those that
/// inp_mesh() reads or refuses.
constexpr std::string_view passed_over =
    "NODE|ELEMENT|NSET|ELSET|"
    "HEADING|PREPRINT|SURFACE|STATIC|FREQUENCY|OUTPUT|NODE FILE|EL FILE|NODE PRINT|EL PRINT|NODE OUTPUT|"
    "ELEMENT OUTPUT|RESTART|TIME POINTS";

class InpSceneReader {
 public:
  InpSceneReader(const InpFile& file, SceneBuilder& builder)
      : file_(file), builder_(builder), body_(inp_mesh(file)) {}

  void read() {
    require_four_nodes(body_.mesh);
    builder_.scene.model = "fem_cauchy";
    for (const InpCard& card : file_.cards())
      if (card.keyword == "AMPLITUDE") read_amplitude(card);
    for (const InpCard& card : file_.cards()) read(card);
    if (in_step_)
      file_.fail(file_.cards().back().place,
                 "*STEP has no *END STEP; the file is cut off, so copy or export it again");
    set_materials();
    set_supports();
    builder_.set_gravity(gravity_.value_or(Eigen::Vector3d::Zero()));
  }

 private:
  /// A keyword that is understood.
  struct Keyword {
    std::string_view name, parameters;                       ///< these as a list
    void (InpSceneReader::*read)(const InpCard&) = nullptr;  ///< null: only the mesh has it
  };

  static const Keyword* known(std::string_view name) {
    using Self = InpSceneReader;
    static constexpr std::array<Keyword, 18> keywords{
        {{"SOLID SECTION", "ELSET|MATERIAL"},
         {"BOUNDARY", boundary_parameters},
         {"PART", "NAME"},
         {"END PART", ""},
         {"ASSEMBLY", "NAME"},
         {"END ASSEMBLY", ""},
         {"INSTANCE", "NAME|PART"},
         {"END INSTANCE", ""},
         {"AMPLITUDE", "NAME|DEFINITION|TIME|VALUE|SMOOTH"},
         {"CLOAD", "OP|AMPLITUDE", &Self::read_forces},
         {"MATERIAL", "NAME", &Self::read_material},
         {"ELASTIC", "TYPE", &Self::read_elastic},
         {"DENSITY", "", &Self::read_density},
         {"DAMPING", "ALPHA|BETA", &Self::read_damping},
         {"DLOAD", "OP|AMPLITUDE", &Self::read_loads},
         {"STEP", "NLGEOM|INC|NAME", &Self::read_step},
         {"DYNAMIC", "ALPHA|EXPLICIT|DIRECT|SOLVER", &Self::read_dynamic},
         {"END STEP", "", &Self::end_step}}};
    const auto* const found = std::ranges::find(keywords, name, &Keyword::name);
    return found == keywords.end() ? nullptr : found;
  }

  void refuse(const InpCard& card, const std::string& what) { refuse(card.keyword, card.place, what); }
  void refuse(std::string_view part, std::int64_t place, const std::string& what) {
    builder_.refuse(part, where(place) + ": ", what);
  }
  /// "bar.inp, line 7"
  [[nodiscard]] std::string where(std::int64_t place) const {
    return fmt::format("{}, line {}", file_.at(place).name(), file_.line(place));
  }

  /// Reads a keyword that is understood with all of its parameters.
  void read(const InpCard& card) {
    if (is_listed(card.keyword, passed_over)) return;
    const Keyword* const keyword = known(card.keyword);
    if (!keyword) return refuse(card, fmt::format("*{} is not understood", card.keyword));
    if (const std::string* const other = card.unknown_parameter(keyword->parameters)) {
      const std::string what = fmt::format("{} of *{} is not understood", *other, card.keyword);
      if (is_listed(card.keyword, "SOLID SECTION|PART|INSTANCE"))  // the mesh has them all the same
        file_.fail(card.place, what + "; remove it");
      return refuse(card, what);
    }
    if (keyword->read) (this->*keyword->read)(card);
  }

  const InpLine& only_line(const InpCard& card) {
    if (card.lines.size() != 1)
      file_.fail(card.place,
                 fmt::format("*{} has {} lines and should have one: values that change with temperature are "
                             "not read",
                             card.keyword, card.lines.size()));
    return card.lines.front();
  }

  void read_material(const InpCard& card) {
    const std::string called = card.parameter("NAME").value_or("");
    const auto [made, is_new] = materials_.try_emplace(called);
    if (!is_new) file_.fail(card.place, fmt::format("the material '{}' is given twice; remove one", called));
    made->second.place = card.place;
    material_ = &made->second;
  }

  Material& of_material(const InpCard& card) {
    if (!material_)
      file_.fail(card.place,
                 fmt::format("*{} stands before any *MATERIAL; move it behind one", card.keyword));
    return *material_;
  }

  void read_elastic(const InpCard& card) {
    const std::string type = card.parameter("TYPE").value_or("ISO");
    if (!type.starts_with("ISO"))
      file_.fail(
          card.place,
          fmt::format("*ELASTIC is of type {}, and only isotropic solids are read; give E and nu", type));
    of_material(card).young = file_.number(only_line(card), 0, "Young's modulus");
    material_->elastic_place = only_line(card).place;
    material_->poisson = file_.number(only_line(card), 1, "Poisson's ratio");
  }

  void read_density(const InpCard& card) {
    of_material(card).density = file_.number(only_line(card), 0, "density");
    material_->density_place = only_line(card).place;
  }

  void read_damping(const InpCard& card) {
    of_material(card).alpha = number_of(card, "ALPHA", 0);
    material_->beta = number_of(card, "BETA", 0);
  }

  double number_of(const InpCard& card, const char* parameter, double otherwise) {
    const auto text = card.parameter(parameter);
    return text ? file_.number({.place = card.place, .fields = {*text}}, 0, parameter) : otherwise;
  }

  /// One value at all times; others are refused where something follows them.
  void read_amplitude(const InpCard& card) {
    Amplitude& made = amplitudes_[card.parameter("NAME").value_or("")];
    made = {.place = card.place, .value = {}};
    const std::string definition = card.parameter("DEFINITION").value_or("TABULAR");
    if (definition != "TABULAR" || card.unknown_parameter(known(card.keyword)->parameters)) return;
    for (const InpLine& line : card.lines)
      for (std::size_t k = 1; k < line.fields.size(); k += 2) {
        const double value = file_.number(line, k, "an amplitude");
        if (made.value && *made.value != value) {
          made.value.reset();
          return;
        }
        made.value = value;
      }
  }

  /// What the numbers of loads are multiplied with.
  double amplitude_of(const InpCard& card) {
    const auto called = card.parameter("AMPLITUDE");
    if (!called) return 1;
    const auto found = amplitudes_.find(*called);
    if (found == amplitudes_.end())
      file_.fail(card.place,
                 fmt::format("there is no *AMPLITUDE '{}'; define it, or correct the name", *called));
    if (found->second.value) return *found->second.value;
    refuse("AMPLITUDE", card.place,
           fmt::format("*{} follows the amplitude {} of line {}, which changes with time, and loads here are "
                       "steady; write the load at the time that you ask for, without it",
                       card.keyword, *called, file_.line(found->second.place)));
    return 1;
  }

  /// Forces on points or on each point of a set, along directions 1 to 3.
  void read_forces(const InpCard& card) {
    const double amplitude = amplitude_of(card);
    for (const InpLine& line : card.lines) {
      const std::int64_t direction = file_.integer(line, 1, "direction");
      if (direction < 1 || direction > 3) {
        refuse(card.keyword, line.place,
               fmt::format("*CLOAD is along direction {}, and points have 1 to 3", direction));
        continue;
      }
      const Eigen::Vector3d force =
          amplitude * file_.number(line, 2, "force") * Eigen::Vector3d::Unit(direction - 1);
      for (const std::int64_t number : points_of(line)) builder_.add_force(number, force);
    }
  }

  /// The numbers of the points that a line begins with, outside of the part.
  std::vector<std::int64_t> points_of(const InpLine& line) {
    std::string name = line.fields.empty() ? "" : upper(line.fields[0]);
    const std::vector<std::int64_t>& numbers = body_.mesh.point_numbers;
    const auto set = std::ranges::find_if(body_.mesh.groups, [&](const MeshGroup& group) {
      return group.dimension == 0 && group.name == name;
    });
    if (set != body_.mesh.groups.end()) {
      std::vector<std::int64_t> found;
      for (const TetMesh::Index corner : set->corners)
        found.push_back(numbers[static_cast<std::size_t>(corner)]);
      return found;
    }
    if (const std::string& prefix = file_.prefix(); !prefix.empty() && name.starts_with(prefix))
      name.erase(0, prefix.size());
    if (name.empty() || name.find_first_not_of("0123456789") != std::string::npos)
      file_.fail(line.place, fmt::format("there is no node set {}; define it, or correct the name",
                                         in_quotes(line.fields.empty() ? "" : line.fields[0])));
    const std::int64_t number = file_.integer({.place = line.place, .fields = {name}}, 0, "node");
    if (numbers_.empty()) numbers_.insert(numbers.begin(), numbers.end());
    if (!numbers_.contains(number))
      file_.fail(line.place, fmt::format("there is no node {}; correct it", number));
    return {number};
  }

  /// Weight of the whole body, which no set names too: its size, and its direction of any length.
  void read_loads(const InpCard& card) {
    const double amplitude = amplitude_of(card);
    for (const InpLine& line : card.lines) {
      if (line.fields.size() < 2 || upper(line.fields[1]) != "GRAV") {
        refuse(card, "*DLOAD is not GRAV, the only distributed load that is read");
        continue;
      }
      const auto set = body_.element_sets.find(upper(line.fields[0]));
      if (!line.fields[0].empty() &&
          (set == body_.element_sets.end() ||
           std::set(set->second.begin(), set->second.end()).size() != body_.mesh.numbers.size())) {
        refuse(card,
               fmt::format("GRAV is of the set {}, which is not the whole body", in_quotes(line.fields[0])));
        continue;
      }
      if (gravity_) file_.fail(line.place, "GRAV is given twice; remove one");
      const double size = file_.number(line, 2, "acceleration");
      Eigen::Vector3d direction;
      for (std::size_t k = 0; k < 3; ++k)
        direction[static_cast<Eigen::Index>(k)] = file_.number(line, 3 + k, "direction of gravity");
      if (direction.isZero(0)) file_.fail(line.place, "gravity has no direction; correct it");
      gravity_ = amplitude * size * direction.normalized();
    }
  }

  /// With NLGEOM CalculiX takes *ELASTIC for the St. Venant-Kirchhoff law. Abaqus has the Cauchy stress by
  /// the rate of deformation there.
  void read_step(const InpCard& card) {
    if (has_step_)
      file_.fail(card.place, "there is a second *STEP, and one is read; keep that whose limit you ask for");
    has_step_ = in_step_ = true;
    if (card.parameter("NLGEOM").value_or("NO") == "NO") return;
    builder_.scene.model = "fem_green";
    builder_.scene.notes.emplace_back(
        "under NLGEOM *ELASTIC is the St. Venant-Kirchhoff law, as in CalculiX; Abaqus differs for large strains");
  }

  void end_step(const InpCard&) { in_step_ = false; }

  /// Abaqus/Explicit takes forces of dampers at the velocities of half a step before, as symplectic Euler
  /// does, and so do undamped central differences. EXPLICIT of 0 and 1 is of fluids alone in CalculiX, whose
  /// structures are implicit then.
  void read_dynamic(const InpCard& card) {
    if (!in_step_) file_.fail(card.place, "*DYNAMIC stands in no *STEP; put it behind one");
    const double alpha = number_of(card, "ALPHA", -0.05);
    if (!(alpha >= -1.0 / 3 && alpha <= 0))
      file_.fail(card.place,
                 fmt::format("ALPHA is {} but must lie between -1/3 and 0; correct it", to_text(alpha)));
    const std::string kind = card.parameter("EXPLICIT").value_or("0");
    if (!kind.empty() && !is_listed(kind, "0|1|2|3"))
      return refuse(card, fmt::format("EXPLICIT={} of *DYNAMIC is not understood", kind));
    const bool is_explicit = !is_listed(kind, "0|1");
    if (is_explicit && card.parameter("ALPHA"))
      return refuse(card, "ALPHA of *DYNAMIC, EXPLICIT is not understood");
    const std::vector<std::string_view> times =
        card.lines.empty() ? std::vector<std::string_view>{} : card.lines[0].fields;
    if (is_explicit && times.size() > 2 && !times[2].empty() &&
        file_.number(card.lines[0], 2, "least time increment") != 0)
      return refuse(card, "the least time increment of *DYNAMIC, EXPLICIT scales masses, which is not read");
    Scene& scene = builder_.scene;
    scene.integrator = is_explicit ? "*DYNAMIC, EXPLICIT" : fmt::format("*DYNAMIC, ALPHA={}", to_text(alpha));
    scene.method = is_explicit ? "symplectic_euler" : fmt::format("hht_alpha:alpha={}", to_text(alpha));
    scene.notes.emplace_back(
        is_explicit
            ? "the limit is that of central differences, as in Abaqus; CalculiX has its alpha method under EXPLICIT and "
              "chooses smaller increments itself"
            : "the program steps a consistent mass and hmax a lumped one; modes of few elements differ");
    if (times.empty() || times[0].empty()) return;
    const double step = file_.number(card.lines[0], 0, "time increment");
    if (!(step > 0))
      file_.fail(card.lines[0].place,
                 fmt::format("the time increment is {} but must be positive; correct it", to_text(step)));
    builder_.set_step(step);
  }

  void set_materials() {
    if (body_.sections.empty())
      throw std::invalid_argument(file_.name() +
                                  " has no *SOLID SECTION, so no element has a material; add one");
    const Material* first = nullptr;
    for (const InpCard* section : body_.sections) {
      const std::string called = section->parameter("MATERIAL").value_or("");
      const auto found = materials_.find(called);
      if (found == materials_.end())
        file_.fail(section->place,
                   fmt::format("there is no material '{}'; define it, or correct the name", called));
      const Material& material = found->second;
      if (!material.young || !material.density)
        file_.fail(material.place, fmt::format("the material '{}' has no *{}; add it", called,
                                               material.young ? "DENSITY" : "ELASTIC"));
      if (!first) first = &material;
      if (material.alpha != first->alpha || material.beta != first->beta)
        file_.fail(material.place,
                   fmt::format("the material '{}' has another *DAMPING than the first one, and bodies here "
                               "have one; give both the same",
                               called));
      const std::string region = body_.sections.size() == 1 ? "" : section->parameter("ELSET").value_or("");
      builder_.add_material(region, *material.young, *material.poisson, {}, where(material.elastic_place));
      builder_.set_density(region, *material.density, where(material.density_place));
    }
    builder_.scene.regions = body_.mesh.names;
    builder_.set_damping(first->alpha, first->beta);
  }

  void set_supports() {
    const bool holds =
        std::ranges::find(body_.mesh.groups, held_points, &MeshGroup::name) != body_.mesh.groups.end();
    if (const InpLine* line = body_.otherwise_held)
      refuse(
          "BOUNDARY", line->place,
          fmt::format("*BOUNDARY does not fix {} in all directions 1 to 3 at 0, and a point here is fixed in "
                      "all of them or free; fix all with {}, 1, 3",
                      in_quotes(line->fields[0]), line->fields[0]));
    builder_.set_support(holds ? held_points : "");
  }

  const InpFile& file_;
  SceneBuilder& builder_;
  InpMesh body_;
  std::unordered_set<std::int64_t> numbers_{};  ///< of the points, once one is asked for
  std::optional<Eigen::Vector3d> gravity_;
  std::map<std::string, Material> materials_;
  std::map<std::string, Amplitude> amplitudes_;
  Material* material_ = nullptr;
  bool has_step_ = false, in_step_ = false;
};

}  // namespace

void read_inp_scene(const std::string& file, std::string_view bytes, SceneBuilder& builder) {
  builder.take_units();
  const InpFile parsed(file, bytes);
  InpSceneReader(parsed, builder).read();
}

}  // namespace hmax
