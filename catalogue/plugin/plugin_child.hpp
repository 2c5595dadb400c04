/// The child process: it loads the plugin and does what it is asked to.
#pragma once

#include <sys/types.h>

#include "catalogue/plugin/plugin_memory.hpp"
#include "catalogue/plugin/plugin_name.hpp"

namespace hmax {

/// Loads the plugin, answers requests until it is told to quit, and waits to be ended.
/// @param page  in memory that both processes see
/// @param parent  ends the child when it ends
[[noreturn]] void serve_plugin(PluginPage& page, const PluginName& plugin, pid_t parent);

}  // namespace hmax
