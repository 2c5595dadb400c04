#include "cli/scene.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "problems/tissue/bullet_body.hpp"

namespace hmax {
namespace {

std::string share_in_words(double share) { return rounded_text(100 * share, 3) + " %"; }

std::string largest_in_words(double largest, double value) {
  if (std::isinf(largest)) return "any";
  if (largest == 0) return "none";
  return fmt::format("{}, {} times its own", rounded_text(largest, 4), rounded_text(largest / value, 3));
}

std::string in_words(const LimitOwner& owner, double h) {
  const std::string name = owner.part.kind + " " + owner.part.name;
  std::string text = fmt::format("owner     {} has {} of the limit", name, share_in_words(owner.share));
  if (owner.alike > 1)
    text += fmt::format("; the {} of its stiffness and damping have {}", owner.alike,
                        share_in_words(owner.share_of_alike));
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

void refuse_options(const SceneName& scene, EngineStart start) {
  const MeshOptions& mesh = scene.body.body;
  const auto refuse = [](bool given, const char* option, const char* whose) {
    if (given) throw InputError(fmt::format("{} is one of {}; remove it", option, whose));
  };
  refuse(start != EngineStart::keyframe && !scene.keyframe.empty(), "--keyframe", "a scene of MuJoCo");
  if (start == EngineStart::body) return;
  refuse(start != EngineStart::base && !mesh.supports.empty(), "--support",
         "a robot or a soft body of Bullet");
  for (const auto& [given, option] : {std::pair(!mesh.unit.empty(), "--unit"),
                                      {!mesh.model.empty(), "--model"},
                                      {!scene.body.material.empty(), "--material"},
                                      {!scene.body.set.empty(), "--set"}})
    refuse(given, option, "a soft body of Bullet (body.vtk)");
}

/// The body as Bullet's own loadSoftBody makes it, unless the user says otherwise: nothing is fixed and
/// nothing pulls, every point has the same mass, and its force is the neo-Hookean one.
std::string text_of_body(const SceneName& scene) {
  ProblemChoice choice = scene.body;
  choice.body.mesh = scene.file;
  if (choice.body.model.empty()) choice.body.model = "fem_neo_hookean";
  ProblemSettings settings = choice.settings();
  settings.parameters.insert(settings.parameters.begin(), {{"support", 0}, {"g", 0}, {"equal_masses", 1}});
  const Problem made = make_problem(choice.id(), settings);
  try {
    return bullet_text(*made.body);
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
}

}  // namespace

PluginName plugin_of(const SceneName& scene) {
  if (scene.file.find('\n') != scene.file.npos || scene.keyframe.find('\n') != scene.keyframe.npos)
    throw InputError("a name of the scene has a line break; rename it");
  PluginName plugin = parse_engine_file(scene.file);
  const EngineStart start = engine_format(scene.file)->start;
  refuse_options(scene, start);
  if (start == EngineStart::keyframe) {
    if (!scene.keyframe.empty() || !scene.settles) plugin.argument += "\n" + scene.keyframe;
    if (!scene.settles) plugin.argument += "\n";
  } else if (start != EngineStart::own) {
    const std::vector<std::string>& supports = scene.body.body.supports;
    if (start == EngineStart::base && supports.size() > 1)
      throw InputError("--support is given twice, and a robot has one base; remove one");
    plugin.argument += fmt::format("\n{}\n{}", scene.settles ? "rest" : "start",
                                   start == EngineStart::body ? text_of_body(scene)
                                   : supports.empty()         ? std::string()
                                                              : supports.front());
  }
  return plugin;
}

std::string limit_beside(double limit, double h) {
  constexpr int most = 17;  // tell every double
  for (int digits = 4; digits < most; ++digits) {
    std::string text = rounded_text(limit, digits);
    const double told = to_number(text).value_or(limit);
    if (h == limit || (h < limit ? h < told : h > told)) return text;
  }
  return rounded_text(limit, most);
}

std::string in_words(const OwnStep& own, const ProbedLimit& found) {
  std::string text = fmt::format("timestep  {} s ", to_text(own.h));
  if (own.stable && found.smoothness == StepSmoothness::jump)
    text += std::isinf(found.observed)
                ? "does not grow in runs, nor does any step size up to h1"
                : fmt::format("is {} where runs begin to grow, {} s", *own.stable ? "below" : "above",
                              rounded_text(found.observed, 2));
  else if (!own.stable)
    text += std::isinf(found.h_max) && own.h > found.h1
                ? "is not judged: nothing grows up to h1, which is shorter"
                : "is not judged: no limit was found that holds";
  else if (std::isinf(found.limit()))
    text += "is stable: nothing grows up to h1";
  else if (!*own.stable && own.h <= found.limit())
    text += "grows, in a window of step sizes below h_max";
  else
    text += fmt::format("is {} the limit {} s", *own.stable ? "below" : "above",
                        limit_beside(found.limit(), own.h));
  if (own.substeps && *own.substeps > 1)
    text += fmt::format("; {} substeps of {} s are stable", *own.substeps,
                        rounded_text(own.h / static_cast<double>(*own.substeps), 4));
  text += "\n";
  return own.owner ? text + in_words(*own.owner, own.h) : text;
}

}  // namespace hmax
