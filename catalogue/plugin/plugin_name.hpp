/// FILE.so[:NAME[:ARGUMENT]]: which entry of which shared library.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hmax {

struct PluginName {
  std::filesystem::path file;  ///< absolute
  std::string name;            ///< of the entry; empty: the first one
  std::string argument;        ///< of create()
  std::string text;            ///< as it was typed
};

/// A name of a file that holds a colon is taken whole where such a file exists.
/// @throws InputError  where there is no such file
PluginName parse_plugin(std::string_view text);

/// 8 hexadecimal digits of what is in the file, and of the argument: libraries that were built anew are told
/// apart. Libraries that this one loads are not looked at.
std::string plugin_digest(const PluginName& plugin);

}  // namespace hmax
