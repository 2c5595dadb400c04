#include "catalogue/scenes/read_scene.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/scenes/inp_scene.hpp"
#include "catalogue/scenes/scene_parts.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/process/whole_file.hpp"
#include "problems/mesh/files/mesh_text.hpp"

namespace hmax {

namespace {

struct NamedUnit {
  std::string_view name;
  double value;
};
constexpr std::array<NamedUnit, 3> masses{{{"kg", 1}, {"g", 1e-3}, {"t", 1e3}}};
constexpr std::array<NamedUnit, 2> times{{{"s", 1}, {"ms", 1e-3}}};

double unit_of(std::string_view what, std::string_view text, std::span<const NamedUnit> known) {
  const auto found = std::ranges::find(known, text, &NamedUnit::name);
  if (found != known.end()) return found->value;
  const auto value = to_number(text);
  constexpr double least = 1e-12, most = 1e12;
  if (!value || !(*value >= least && *value <= most)) {
    std::vector<std::string_view> names;
    for (const NamedUnit& each : known) names.push_back(each.name);
    throw InputError(fmt::format("'{}' is no unit of {}; write {} or a number of {}", text, what,
                                 fmt::join(names, ", "), known.front().name));
  }
  return *value;
}

}  // namespace

SceneUnits scene_units(std::string_view text) {
  const std::vector<std::string_view> parts = between_commas(text);
  if (text.empty() || parts.size() != 3)
    throw InputError(fmt::format(
        "{}; its moduli and densities need the units of length, mass and time: --unit m,kg,s, or mm,t,s "
        "where moduli are in MPa",
        text.empty() ? std::string("a scene does not say its units")
                     : fmt::format("--unit {} is not enough for a scene", text)));
  return {.length = unit_in_metres(parts[0]),
          .mass = unit_of("mass", parts[1], masses),
          .time = unit_of("time", parts[2], times)};
}

Scene read_scene(const std::string& file, std::string_view units, std::string_view ignored) {
  const std::string extension = lower(std::filesystem::path(file).extension().string());
  if (extension != ".inp")
    throw InputError(
        fmt::format("'{}' is no scene by its extension; name a file .inp of CalculiX or Abaqus", file));
  IgnoredParts parts(ignored);
  try {
    return within_memory(file, [&] {
      const std::string bytes = read_whole(file, "a scene");
      const SceneUnits in = scene_units(units);
      Scene scene = inp_scene(file, bytes, in, parts);
      scene.settings.unit = in.length;
      parts.finish(file, scene);
      return scene;
    });
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
}

}  // namespace hmax
