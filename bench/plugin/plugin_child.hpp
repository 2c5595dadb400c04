/// The child process: it loads the plugin and does what it is asked to.
#pragma once

#include "bench/plugin/plugin_messages.hpp"
#include "bench/plugin/plugin_name.hpp"

namespace hmax {

/// Loads the plugin, answers requests of `socket` until it is closed, and ends the process.
/// @param stage  in shared memory
[[noreturn]] void serve_plugin(int socket, PluginStage& stage, const PluginName& plugin);

}  // namespace hmax
