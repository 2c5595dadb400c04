/// The model of a plugin as a problem.
#pragma once

#include "bench/catalogue/method.hpp"
#include "bench/plugin/plugin_process.hpp"

namespace hmax {

/// Its functions are called in the child process, by one thread at a time: some ten microseconds a call. Where it gives no
/// Jacobian, stiffness or damping, these are central differences.
/// @throws InputError  where the plugin is no model, does not work, or starts with numbers that are not finite
Problem plugin_problem(PluginName plugin, PluginSettings settings = {});

}  // namespace hmax
