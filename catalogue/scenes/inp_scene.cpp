/// CalculiX's and Abaqus' .inp as a body: what each keyword is taken for stands in the function that reads
/// it.
#include "catalogue/scenes/inp_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/Core>
#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "problems/mesh/files/scenes/inp_file.hpp"

namespace hmax {

namespace {

/// A keyword that is understood, with its parameters.
struct KnownCard {
  std::string_view keyword;
  std::string_view parameters;  ///< with blanks between them; "?": whatever they are
};
constexpr std::array<KnownCard, 28> known_cards{{
    {"HEADING", "?"},
    {"PREPRINT", "?"},
    {"NODE", "NSET"},
    {"ELEMENT", "TYPE ELSET"},
    {"NSET", "NSET GENERATE"},
    {"ELSET", "ELSET GENERATE"},
    {"SURFACE", "?"},
    {"MATERIAL", "NAME"},
    {"ELASTIC", "TYPE"},
    {"DENSITY", ""},
    {"DAMPING", "ALPHA BETA"},
    {"SOLID SECTION", "ELSET MATERIAL"},
    {"BOUNDARY", "OP"},
    {"DLOAD", "OP"},
    {"STEP", "NLGEOM INC NAME"},
    {"DYNAMIC", "ALPHA EXPLICIT DIRECT SOLVER"},
    {"STATIC", "?"},
    {"FREQUENCY", "?"},
    {"END STEP", ""},
    {"OUTPUT", "?"},
    {"NODE FILE", "?"},
    {"EL FILE", "?"},
    {"NODE PRINT", "?"},
    {"EL PRINT", "?"},
    {"NODE OUTPUT", "?"},
    {"ELEMENT OUTPUT", "?"},
    {"RESTART", "?"},
    {"TIME POINTS", "?"},
}};

bool is_word_of(std::string_view word, std::string_view words) {
  return (" " + std::string(words) + " ").find(" " + std::string(word) + " ") != std::string::npos;
}

struct Material {
  std::int64_t place = 0;
  std::optional<double> young, poisson, density;
  double alpha = 0, beta = 0;
};

class InpSceneReader {
 public:
  InpSceneReader(const InpFile& file, const SceneUnits& units, IgnoredParts& ignored)
      : file_(file), units_(units), ignored_(ignored), body_(inp_mesh(file)) {}

  Scene read() {
    scene_.model = "fem_cauchy";
    for (const InpCard& card : file_.cards())
      if (is_known(card)) read(card);
    if (in_step_)
      throw InputError(
          fmt::format("{}: *STEP has no *END STEP; the file is cut off, so copy or export it again", name()));
    set_materials();
    set_supports();
    if (!has_gravity_) scene_.settings.parameters.emplace_back("g", 0);
    return std::move(scene_);
  }

 private:
  [[nodiscard]] const std::string& name() const { return file_.text().name(); }
  [[nodiscard]] std::string at(std::int64_t place) const {
    return fmt::format("{}, line {}: ", name(), place);
  }
  void refuse(const InpCard& card, const std::string& what) {
    ignored_.refuse(card.keyword, at(card.place), what);
  }

  /// Whether it can be read; refuses it otherwise.
  bool is_known(const InpCard& card) {
    const auto* const known = std::ranges::find(known_cards, card.keyword, &KnownCard::keyword);
    if (known == known_cards.end()) {
      refuse(card,
             card.keyword == "CLOAD"
                 ? "*CLOAD is forces at single points, which bodies here have not; limits of linear bodies "
                   "do not depend on them"
                 : fmt::format("*{} is not understood", card.keyword));
      return false;
    }
    if (known->parameters == "?") return true;
    for (const auto& [parameter, value] : card.parameters) {
      if (is_word_of(parameter, known->parameters) && (parameter != "OP" || value == "MOD")) continue;
      refuse(card, fmt::format("{} of *{} is not understood", parameter, card.keyword));
      return false;
    }
    return true;
  }

  void read(const InpCard& card) {
    if (card.keyword == "MATERIAL")
      read_material(card);
    else if (card.keyword == "ELASTIC")
      read_elastic(card);
    else if (card.keyword == "DENSITY")
      of_material(card).density = file_.number(only_line(card), 0, "density");
    else if (card.keyword == "DAMPING")
      read_damping(card);
    else if (card.keyword == "DLOAD")
      read_loads(card);
    else if (card.keyword == "STEP")
      read_step(card);
    else if (card.keyword == "DYNAMIC")
      read_dynamic(card);
    else if (card.keyword == "END STEP")
      in_step_ = false;
  }

  const InpLine& only_line(const InpCard& card) {
    if (card.lines.size() != 1)
      throw InputError(fmt::format(
          "{}*{} has {} lines and should have one: values that change with temperature are not read",
          at(card.place), card.keyword, card.lines.size()));
    return card.lines.front();
  }

  void read_material(const InpCard& card) {
    const std::string called = card.parameter("NAME").value_or("");
    const auto [made, is_new] = materials_.try_emplace(called);
    if (!is_new)
      throw InputError(fmt::format("{}the material '{}' is given twice; remove one", at(card.place), called));
    made->second.place = card.place;
    material_ = &made->second;
  }

  Material& of_material(const InpCard& card) {
    if (!material_)
      throw InputError(
          fmt::format("{}*{} stands before any *MATERIAL; move it behind one", at(card.place), card.keyword));
    return *material_;
  }

  void read_elastic(const InpCard& card) {
    const std::string type = card.parameter("TYPE").value_or("ISO");
    if (!type.starts_with("ISO"))
      throw InputError(
          fmt::format("{}*ELASTIC is of type {}, and only isotropic solids are read; give E and nu",
                      at(card.place), type));
    Material& material = of_material(card);
    const InpLine& line = only_line(card);
    material.young = file_.number(line, 0, "Young's modulus");
    material.poisson = file_.number(line, 1, "Poisson's ratio");
  }

  /// Rayleigh damping, alpha M + beta K.
  void read_damping(const InpCard& card) {
    Material& material = of_material(card);
    material.alpha = parameter_number(card, "ALPHA").value_or(0);
    material.beta = parameter_number(card, "BETA").value_or(0);
    if (!(material.alpha >= 0 && material.beta >= 0))
      throw InputError(fmt::format("{}*DAMPING has a negative value; correct it", at(card.place)));
  }

  std::optional<double> parameter_number(const InpCard& card, std::string_view parameter) {
    const auto text = card.parameter(parameter);
    if (!text) return std::nullopt;
    const auto value = to_number(*text);
    if (!value || !std::isfinite(*value))
      throw InputError(fmt::format("{}{} of *{} is '{}' and no number; correct it", at(card.place), parameter,
                                   card.keyword, *text));
    return value;
  }

  /// Weight of the whole body: its size, and its direction of any length.
  void read_loads(const InpCard& card) {
    for (const InpLine& line : card.lines) {
      if (line.fields.size() < 2 || upper(line.fields[1]) != "GRAV") {
        refuse(card, "*DLOAD is not GRAV, the only distributed load that is read");
        continue;
      }
      const auto set = body_.element_sets.find(upper(line.fields[0]));
      const std::string all = set == body_.element_sets.end() ? "" : set->first;
      std::vector<std::size_t> members = all.empty() ? std::vector<std::size_t>{} : set->second;
      std::ranges::sort(members);
      members.erase(std::unique(members.begin(), members.end()), members.end());
      if (all.empty() || members.size() != static_cast<std::size_t>(body_.mesh.mesh.tetrahedron_count())) {
        refuse(card,
               fmt::format("GRAV is of the set {}, which is not the whole body", in_quotes(line.fields[0])));
        continue;
      }
      if (has_gravity_) throw InputError(fmt::format("{}GRAV is given twice; remove one", at(line.place)));
      has_gravity_ = true;
      const double size = file_.number(line, 2, "acceleration") * units_.length / (units_.time * units_.time);
      Eigen::Vector3d direction;
      for (int k = 0; k < 3; ++k)
        direction[k] = file_.number(line, static_cast<std::size_t>(3 + k), "direction of gravity");
      if (!(direction.norm() > 0))
        throw InputError(fmt::format("{}gravity has no direction; correct it", at(line.place)));
      direction.normalize();
      constexpr std::array names{"gx", "gy", "gz"};
      for (int k = 0; k < 3; ++k)
        scene_.settings.parameters.emplace_back(names[static_cast<std::size_t>(k)], size * direction[k]);
    }
  }

  /// With NLGEOM CalculiX and Abaqus/Standard take *ELASTIC for the St. Venant-Kirchhoff law.
  void read_step(const InpCard& card) {
    if (has_step_)
      throw InputError(fmt::format(
          "{}there is a second *STEP, and one is read; keep that whose limit you ask for", at(card.place)));
    has_step_ = in_step_ = true;
    if (const auto large = card.parameter("NLGEOM"); large && *large != "NO") scene_.model = "fem_green";
  }

  void read_dynamic(const InpCard& card) {
    if (!in_step_)
      throw InputError(fmt::format("{}*DYNAMIC stands in no *STEP; put it behind one", at(card.place)));
    const double alpha = parameter_number(card, "ALPHA").value_or(-0.05);
    if (!(alpha >= -1.0 / 3 && alpha <= 0))
      throw InputError(fmt::format("{}ALPHA is {} but must lie between -1/3 and 0; correct it",
                                   at(card.place), to_text(alpha)));
    const bool is_explicit = card.parameter("EXPLICIT").has_value();
    scene_.integrator =
        is_explicit ? "*DYNAMIC, EXPLICIT" : fmt::format("*DYNAMIC, ALPHA={}", to_text(alpha));
    scene_.method = is_explicit ? "central_difference" : fmt::format("hht_alpha:alpha={}", to_text(alpha));
    scene_.notes.emplace_back(
        is_explicit
            ? "CalculiX chooses smaller increments itself under EXPLICIT; the limit is that of central differences"
            : "the program steps a consistent mass and hmax a lumped one; modes of few elements differ");
    if (card.lines.empty() || card.lines[0].fields.empty() || card.lines[0].fields[0].empty()) return;
    const double step = file_.number(card.lines[0], 0, "time increment");
    if (!(step > 0))
      throw InputError(fmt::format("{}the time increment is {} but must be positive; correct it",
                                   at(card.lines[0].place), to_text(step)));
    scene_.step = step * units_.time;
  }

  void set_materials() {
    if (body_.sections.empty())
      throw InputError(
          fmt::format("{} has no *SOLID SECTION, so no element has a material; add one", name()));
    const Material* first = nullptr;
    for (const InpCard* section : body_.sections) {
      const std::string called = section->parameter("MATERIAL").value_or("");
      const auto found = materials_.find(called);
      if (found == materials_.end())
        throw InputError(fmt::format("{}there is no material '{}'; define it, or correct the name",
                                     at(section->place), called));
      const Material& material = found->second;
      for (const auto& [value, keyword] :
           {std::pair(&material.young, "ELASTIC"), {&material.density, "DENSITY"}})
        if (!*value)
          throw InputError(
              fmt::format("{}the material '{}' has no *{}; add it", at(material.place), called, keyword));
      require_elastic(fmt::format("{}of the material '{}' ", at(material.place), called), *material.young,
                      *material.poisson, *material.density);
      if (!first) first = &material;
      if (material.alpha != first->alpha || material.beta != first->beta)
        throw InputError(fmt::format(
            "{}the material '{}' has another *DAMPING than the first one, and bodies here have one; give both the same",
            at(material.place), called));
      const bool is_only = body_.sections.size() == 1;
      add_material(scene_, is_only ? "" : section->parameter("ELSET").value_or(""), units_, *material.young,
                   *material.poisson, *material.density);
    }
    if (first->alpha != 0) scene_.settings.parameters.emplace_back("alpha", first->alpha / units_.time);
    if (first->beta != 0) scene_.settings.parameters.emplace_back("beta", first->beta * units_.time);
  }

  void set_supports() {
    const auto group = [&](std::string_view called) {
      const auto found = std::ranges::find(body_.mesh.groups, called, &MeshGroup::name);
      return found == body_.mesh.groups.end() ? nullptr : &*found;
    };
    if (const MeshGroup* other = group(otherwise_held_points))
      ignored_.refuse(
          "BOUNDARY", name() + ": ",
          fmt::format(
              "*BOUNDARY does not fix node {} in directions 1 to 3 alone, at 0, the only way that is read",
              body_.mesh.point_numbers[static_cast<std::size_t>(other->corners.front())]));
    if (group(held_points))
      scene_.settings.parameters.emplace_back(fmt::format("support:vertices:{}", held_points), 1);
    else
      scene_.settings.parameters.emplace_back("support", 0);
  }

  const InpFile& file_;
  SceneUnits units_;
  IgnoredParts& ignored_;
  InpMesh body_;
  Scene scene_;
  std::map<std::string, Material> materials_;
  Material* material_ = nullptr;
  bool has_step_ = false, in_step_ = false, has_gravity_ = false;
};

}  // namespace

Scene inp_scene(const std::string& file, std::string_view bytes, const SceneUnits& units,
                IgnoredParts& ignored) {
  const InpFile parsed(file, bytes);
  return InpSceneReader(parsed, units, ignored).read();
}

}  // namespace hmax
