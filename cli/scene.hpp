/// Scenes of other engines, which modules of hmax open, and what `hmax probe` says of their own step size.
#pragma once

#include <string>

#include "analysis/foreign_steps/own_step.hpp"
#include "catalogue/plugin/plugin_name.hpp"
#include "cli/shared/choices.hpp"

namespace hmax {

struct SceneName {
  std::string file;      ///< as it was typed
  std::string keyframe;  ///< its name or number; empty: the start of the scene
  bool settles = true;   ///< begins at rest; otherwise at that start
  /// Of a mesh, its --unit, --model, --material, --set and --support; of a robot the base as --support.
  ProblemChoice body{};
};

/// The module that opens the file, by its ending, with its argument.
/// @throws InputError  where there is no such file or no such module, for options that its scenes do not
/// have, and
///                     for a body that cannot be made or that Bullet does not have
PluginName plugin_of(const SceneName& scene);

/// A limit in four digits, or in as many as tell on which side of it the step h is: "0.0099998" beside 0.01.
std::string limit_beside(double limit, double h);

/// Lines of people, each with its end; @param h1  [s]
std::string in_words(const OwnStep& own, const ProbedLimit& found);

}  // namespace hmax
