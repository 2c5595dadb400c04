/// FILE.so[:NAME[:ARGUMENT]]: which entry of which shared library; or the scene of another program that a
/// module opens.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hmax {

struct PluginName {
  std::filesystem::path file{};         ///< absolute
  std::string name{};                   ///< of the entry; empty: the first that is what the command takes
  std::string argument{};               ///< of create()
  std::string text{};                   ///< as it was typed
  std::filesystem::path engine_file{};  ///< what a module opens, absolute; empty for libraries of users
  std::string subject = "the plugin";   ///< of what it does, in errors
  bool is_model = false;                ///< what the command takes; else a stepper
};

/// What users choose beside such a file.
enum class EngineStart {
  own,       ///< nothing
  keyframe,  ///< where it begins
  base,      ///< whether the base of a robot is fixed
  body       ///< all that makes a body of a mesh
};

/// Files of other programs, which a module of hmax opens as a plugin.
struct EngineFormat {
  std::string_view endings;   ///< of the names of the files, as of is_listed()
  const char* module;         ///< "hmax_mujoco.so"
  std::string_view engine;    ///< the subject of what it does
  std::string_view packages;  ///< of Debian, that the module is built with
  bool settles;               ///< before it is probed
  EngineStart start = EngineStart::own;
};

/// By the ending of the name; null where no module opens such files.
const EngineFormat* engine_format(const std::filesystem::path& file);

/// A scene as a plugin, with its absolute path as the argument.
/// @throws InputError  where there is no such file, or no module for it
PluginName parse_engine_file(const std::string& file);

/// A name of a file that holds a colon is taken whole where such a file exists. A scene is that of a module.
/// @throws InputError  where there is no such file
PluginName parse_plugin(std::string_view text);

/// 8 hexadecimal digits of what is in the file, and of the argument: libraries that were built anew are told
/// apart. Libraries that this one loads are not looked at. Of a scene, of what is in it.
std::string plugin_digest(const PluginName& plugin);

}  // namespace hmax
