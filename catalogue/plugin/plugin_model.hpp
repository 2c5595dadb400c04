/// The model of a plugin as a problem.
#pragma once

#include "catalogue/methods/method.hpp"
#include "catalogue/plugin/plugin_process.hpp"

namespace hmax {

/// Its functions are called in the child process, by one thread at a time. Where it gives no
/// Jacobian, stiffness or damping, these are central differences.
/// @throws InputError  where the plugin is no model, does not work, or starts with numbers that are not
/// finite
Problem plugin_problem(PluginName plugin, PluginSettings settings = {});

/// The id of a model of a plugin for make_problem(). @param text  as parse_plugin()
std::string plugin_id(std::string_view text);
/// What such an id begins with.
inline constexpr std::string_view plugin_prefix = "plugin:";

/// The parameter of settings that is PluginSettings::patience.
inline constexpr std::string_view patience_parameter = "patience";

/// The model of this id with an initial state of the user's. Its own id is the name of the entry and a digest
/// of the library and the argument, as in pendulum#1a2b3c4d.
/// @throws InputError  as plugin_problem(), for an initial state of another length, and for a material or
/// parameters
Problem make_plugin_problem(std::string_view id, const ProblemSettings& settings);

}  // namespace hmax
