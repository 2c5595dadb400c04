#include "catalogue/scenes/scene_parts.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "problems/mesh/files/scenes/inp_file.hpp"

namespace hmax {

std::vector<std::string_view> between_commas(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

IgnoredParts::IgnoredParts(std::string_view list) {
  if (list.empty()) return;
  for (std::string_view part : between_commas(list)) {
    if (part.starts_with('*')) part.remove_prefix(1);
    if (part.empty()) throw InputError("--ignore has an empty part; write it like CLOAD,AMPLITUDE");
    parts_.insert(upper(part));
  }
}

void IgnoredParts::refuse(const std::string& part, const std::string& where, const std::string& what) {
  if (!parts_.contains(upper(part)))
    throw InputError(fmt::format("{}{}; remove it, or leave it out with --ignore '{}'", where, what, part));
  left_out_.insert(upper(part));
}

void IgnoredParts::finish(const std::string& file, Scene& scene) const {
  for (const std::string& part : parts_)
    if (!left_out_.contains(part))
      throw InputError(
          fmt::format("--ignore names {}, and {} has nothing of it to leave out; remove it", part, file));
  if (!left_out_.empty())
    scene.notes.push_back(fmt::format("left out of {}: {}", file, fmt::join(left_out_, ", ")));
}

void require_elastic(const std::string& where, double young, double poisson, double density) {
  const auto refuse = [&](std::string_view what, double value, std::string_view range) {
    throw InputError(
        fmt::format("{}{} is {} but must be {}; correct it", where, what, to_text(value), range));
  };
  if (!(young > 0)) refuse("Young's modulus", young, "positive");
  if (!(poisson > -1 && poisson < 0.5)) refuse("Poisson's ratio", poisson, "above -1 and below 0.5");
  if (!(density > 0)) refuse("the density", density, "positive");
}

void add_material(Scene& scene, const std::string& region, const SceneUnits& units, double young,
                  double poisson, double density) {
  const std::string of = region.empty() ? "" : ":" + region;
  const double length = units.length;
  auto& parameters = scene.settings.parameters;
  parameters.emplace_back("E" + of, young * units.mass / (length * units.time * units.time));
  parameters.emplace_back("nu" + of, poisson);
  parameters.emplace_back("rho" + of, density * units.mass / (length * length * length));
}

}  // namespace hmax
