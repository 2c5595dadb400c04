#include "catalogue/scenes/scene_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/tissue_parameters.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "core/process/whole_file.hpp"
#include "core/text/split.hpp"
#include "problems/mesh/files/mesh_text.hpp"

namespace hmax {

namespace {

using NamedUnits = std::vector<std::pair<std::string_view, double>>;

double unit_of(std::string_view what, std::string_view text, const NamedUnits& known) {
  for (const auto& [name, value] : known)
    if (name == text) return value;
  const auto value = to_number(text);
  constexpr double least = 1e-12, most = 1e12;
  if (value && *value >= least && *value <= most) return *value;
  std::string names;
  for (const auto& [name, ignored] : known) names += std::string(name) + ", ";
  throw input_error("'{}' is no unit of {}; write {}or a number of {}", text, what, names,
                    known.front().first);
}

SceneUnits scene_units(std::string_view text) {
  const std::vector<std::string_view> parts = split(text, ",");
  if (text.empty() || parts.size() != 3)
    throw input_error(
        "{}; its moduli and densities need the units of length, mass and time: --unit m,kg,s, or mm,t,s "
        "where moduli are in MPa",
        text.empty() ? std::string("a scene does not say its units")
                     : fmt::format("--unit {} is not enough for a scene", text));
  return {.length = unit_in_metres(parts[0]),
          .mass = unit_of("mass", parts[1], {{"kg", 1}, {"g", 1e-3}, {"t", 1e3}}),
          .time = unit_of("time", parts[2], {{"s", 1}, {"ms", 1e-3}})};
}

struct SceneFormat {
  std::string_view extension;
  void (*read)(const std::string& file, std::string_view bytes, SceneBuilder& builder);
};
constexpr std::array<SceneFormat, 4> formats{{{".inp", read_inp_scene},
                                              {".scn", read_sofa_scene},
                                              {".feb", read_febio_scene},
                                              {".xml", read_mujoco_scene}}};

}  // namespace

SceneBuilder::SceneBuilder(std::string_view units, std::string_view ignored) : given_(units) {
  if (ignored.empty()) return;
  for (std::string_view part : split(ignored, ",")) {
    if (part.starts_with('*')) part.remove_prefix(1);
    if (part.empty()) throw InputError("--ignore has an empty part; write it like CLOAD,AMPLITUDE");
    ignored_.insert(lower(part));
  }
}

void SceneBuilder::take_units(const std::string& where, std::string_view told) {
  if (!told.empty() && given_.empty())
    throw InputError(fmt::format("{}the file tells its units; give --unit {}", where, told));
  units_ = scene_units(given_);
  scene.settings.unit = units_.length;
  if (!told.empty() && units_ != scene_units(told))
    throw InputError(fmt::format("{}the units are {} and not --unit {}; correct one", where, told, given_));
}

void SceneBuilder::refuse(std::string_view part, const std::string& where, const std::string& what) {
  if (!ignored_.contains(lower(part)))
    throw input_error("{}{}; remove it, or leave it out with --ignore {}", where, what, in_quotes(part));
  left_out_.insert(std::string(part));
}

void SceneBuilder::add_material(const std::string& region, double young, double poisson,
                                std::optional<double> density, const std::string& where) {
  const std::string of = region.empty() ? "" : ":" + region;
  const double length = units_.length;
  for (const char* name : {"E", "nu"}) scene.places[name + of] = where;
  set("E" + of, young * units_.mass / (length * units_.time * units_.time));
  set("nu" + of, poisson);
  if (density) set_density(region, *density, where);
}

void SceneBuilder::set_density(const std::string& region, double density, const std::string& where) {
  const std::string name = "rho" + (region.empty() ? "" : ":" + region);
  scene.places[name] = where;
  set(name, density * units_.mass / (units_.length * units_.length * units_.length));
}

void SceneBuilder::set_springs(std::optional<double> stiffness, double young, double damper) {
  const double per_time = 1 / (units_.time * units_.time);
  if (stiffness)
    set("k", *stiffness * units_.mass * per_time);
  else
    set("E", young * units_.mass / units_.length * per_time);
  if (damper != 0) set("damper", damper * units_.time);
}

void SceneBuilder::set_mass(double mass, bool equal) {
  set("mass", mass * units_.mass);
  if (equal) set("equal_masses", 1);
}

void SceneBuilder::set_damping(double alpha, double beta) {
  if (alpha != 0) set("alpha", alpha / units_.time);
  if (beta != 0) set("beta", beta * units_.time);
}

void SceneBuilder::set_gravity(const Eigen::Vector3d& acceleration) {
  if (acceleration.isZero(0)) return set("g", 0);
  for (std::size_t k = 0; k < gravity_names.size(); ++k)
    set(std::string(gravity_names[k]),
        acceleration[static_cast<Eigen::Index>(k)] * units_.length / (units_.time * units_.time));
}

void SceneBuilder::set_support(std::string_view group) {
  if (group.empty()) return set(std::string(support_name), 0);
  set(fmt::format("{}:vertices:{}", support_name, group), 1);
}

void SceneBuilder::add_force(std::int64_t number, const Eigen::Vector3d& force) {
  const auto [at, is_new] = forces_.try_emplace(number, Eigen::Vector3d::Zero());
  at->second += force * units_.mass * units_.length / (units_.time * units_.time);
}

/// One parameter for all points with the same force along an axis.
void SceneBuilder::set_forces() {
  for (std::size_t axis = 0; axis < nodal_force_names.size(); ++axis) {
    std::map<double, std::string> points;
    for (const auto& [number, force] : forces_) {
      const double value = force[static_cast<Eigen::Index>(axis)];
      if (value == 0) continue;
      std::string& list = points[value];
      list += (list.empty() ? "" : ",") + std::to_string(number);
    }
    for (const auto& [value, list] : points)
      set(fmt::format("{}:points:{}", nodal_force_names.at(axis), list), value);
  }
}

Scene SceneBuilder::finish(const std::string& file) {
  for (const std::string& part : ignored_)
    if (std::ranges::none_of(left_out_, [&](const std::string& left) { return lower(left) == part; }))
      throw input_error("--ignore names {}, and {} has nothing of it to leave out; remove it", part, file);
  set_forces();
  if (!left_out_.empty())
    scene.notes.push_back(fmt::format("left out of {}: {}", file, fmt::join(left_out_, ", ")));
  return std::move(scene);
}

void require_four_nodes(const MeshFile& mesh) {
  if (mesh.second_order == 0) return;
  Eigen::Index first = 0;
  while (mesh.middles(0, first) < 0) ++first;
  throw InputError(fmt::format(
      "{} has ten nodes, and scenes of four are read; --mesh with --model fem_quadratic takes all",
      mesh.where(first)));
}

std::string neo_hookean_differs(std::string_view theirs) {
  return fmt::format("the energy of fem_neo_hookean differs from that of {}; small motions are the same",
                     theirs);
}

void leave_out(const Scene& scene, Parameters& parameters, const std::string& name) {
  std::string other = name;
  if (const std::size_t colon = name.find(':'); colon != std::string::npos) {
    const auto named = [&](const auto& region) { return region.second == name.substr(colon + 1); };
    if (std::ranges::none_of(scene.regions, named))
      for (const auto& [number, called] : scene.regions)
        if (std::to_string(number) == name.substr(colon + 1)) other = name.substr(0, colon + 1) + called;
  }
  std::erase_if(parameters, [&](const auto& parameter) {
    return parameter.first == name || parameter.first == other || parameter.first.starts_with(name + ":");
  });
}

void require_in_range(const Scene& scene, const Parameters& parameters) {
  for (const auto& [name, value] : parameters) {
    const auto place = scene.places.find(name);
    if (place == scene.places.end()) continue;
    const std::string_view what = std::string_view(name).substr(0, name.find(':'));
    const bool is_ratio = what == "nu";
    if (is_ratio ? value > -1 && value < 0.5 : value > 0 && std::isfinite(value)) continue;
    throw input_error("{}: {} is {} but must {}; correct it, or replace it with --set {}=", place->second,
                      is_ratio      ? "Poisson's ratio"
                      : what == "E" ? "Young's modulus"
                                    : "the density",
                      is_ratio ? to_text(value) : to_text(value) + (what == "E" ? " Pa" : " kg/m^3"),
                      is_ratio ? "lie above -1 and below 0.5" : "be positive", name);
  }
}

Scene read_scene(const std::string& file, std::string_view units, std::string_view ignored) {
  const std::string extension = lower(std::filesystem::path(file).extension().string());
  const auto* const format = std::ranges::find(formats, extension, &SceneFormat::extension);
  if (is_listed(extension, ".fmu|.urdf"))
    throw input_error("'{}' is no scene by its extension that --scene takes; `hmax probe FILE` does", file);
  if (format == formats.end())
    throw input_error(
        "'{}' is no scene by its extension; name a file .inp of CalculiX or Abaqus, "
        ".scn of SOFA, .feb of FEBio, or .xml of MuJoCo",
        file);
  return told_to_user([&] {
    return within_memory(file, [&] {
      const std::string bytes = read_whole(file, "a scene");
      SceneBuilder builder(units, ignored);
      format->read(file, bytes, builder);
      return builder.finish(file);
    });
  });
}

}  // namespace hmax
