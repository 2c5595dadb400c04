#include "cli/scene.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

std::string percent(double share) { return rounded_text(100 * share, 3) + " %"; }

std::string largest_in_words(double largest, double value) {
  if (std::isinf(largest)) return "any";
  if (largest == 0) return "none";
  return fmt::format("{}, {} times its own", rounded_text(largest, 4), rounded_text(largest / value, 3));
}

std::string in_words(const LimitOwner& owner, double h) {
  const std::string name = owner.part.kind + " " + owner.part.name;
  std::string text = fmt::format("owner     {} has {} of the limit", name, percent(owner.share));
  if (owner.alike > 1)
    text += fmt::format("; the {} of its stiffness and damping have {}", owner.alike,
                        percent(owner.share_of_alike));
  text += "\n";
  const auto add = [&](std::string_view what, double value, const LargestNumber& largest) {
    if (std::isnan(largest.alone)) return;
    text += fmt::format("largest   {} of {} at {} s: {}", what, name, to_text(h),
                        largest_in_words(largest.alone, value));
    if (owner.alike > 1)
      text += fmt::format("; of all {}: {}", owner.alike, largest_in_words(largest.together, value));
    text += "\n";
  };
  add("stiffness", owner.part.stiffness, owner.stiffness);
  add("damping", owner.part.damping, owner.damping);
  return text;
}

}  // namespace

PluginName plugin_of(const SceneName& scene) {
  if (scene.file.find('\n') != scene.file.npos || scene.keyframe.find('\n') != scene.keyframe.npos)
    throw InputError("a name of the scene has a line break; rename it");
  PluginName plugin = parse_engine_file(scene.file);
  if (!engine_format(scene.file)->settles) {
    if (!scene.keyframe.empty()) throw InputError("--keyframe is one of a scene of MuJoCo; remove it");
    return plugin;
  }
  if (!scene.keyframe.empty() || !scene.settles) plugin.argument += "\n" + scene.keyframe;
  if (!scene.settles) plugin.argument += "\n";
  return plugin;
}

std::string in_words(const OwnStep& own, const ProbedLimit& found) {
  std::string text = fmt::format("timestep  {} s ", to_text(own.h));
  if (!own.stable)
    text += std::isinf(found.h_max) && own.h > found.rows.back().h
                ? "is not judged: nothing grows up to h1, which is shorter"
                : "is not judged: no limit was found that holds";
  else if (std::isinf(found.h_max))
    text += "is stable: nothing grows up to h1";
  else
    text +=
        fmt::format("is {} the limit {} s", *own.stable ? "below" : "above", rounded_text(found.h_max, 4));
  if (own.substeps && *own.substeps > 1)
    text += fmt::format("; {} substeps of {} s are stable", *own.substeps,
                        rounded_text(own.h / static_cast<double>(*own.substeps), 4));
  text += "\n";
  return own.owner ? text + in_words(*own.owner, own.h) : text;
}

}  // namespace hmax
