#include "catalogue/plugin/plugin_name.hpp"

#include <algorithm>
#include <array>
#include <fstream>

#include "core/input_error.hpp"
#include "core/ranks/module.hpp"
#include "core/text/digest.hpp"
#include "core/text/split.hpp"
#include "problems/mesh/files/mesh_text.hpp"

namespace hmax {
namespace {

namespace fs = std::filesystem;

constexpr std::array<EngineFormat, 4> engine_formats{
    {{".xml", "hmax_mujoco.so", "MuJoCo", "libmujoco-dev", true, EngineStart::keyframe},
     {".fmu", "hmax_fmi.so", "the unit", "libminizip-dev", false},
     {".urdf", "hmax_bullet.so", "Bullet", "libbullet-dev", true, EngineStart::base},
     {".vtk|.vtu|.msh", "hmax_bullet.so", "Bullet", "libbullet-dev", true, EngineStart::body}}};

/// Which catalogue/scenes reads.
constexpr std::string_view read_as_bodies = ".inp|.scn|.feb";

}  // namespace

const EngineFormat* engine_format(const fs::path& file) {
  const std::string ending = lower(file.extension().string());
  const auto* const kind = std::ranges::find_if(
      engine_formats, [&](const EngineFormat& each) { return is_listed(ending, each.endings); });
  return kind == engine_formats.end() ? nullptr : kind;
}

PluginName parse_engine_file(const std::string& file) {
  constexpr const char* known =
      "a scene of MuJoCo (.xml), a robot (.urdf) or a body (.vtk, .vtu, .msh) for Bullet, or a unit of FMI 2.0 "
      "(.fmu)";
  std::error_code ignored;
  if (!fs::exists(file, ignored)) throw input_error("there is no file '{}'; give {}", file, known);
  const EngineFormat* const kind = engine_format(file);
  if (is_listed(lower(fs::path(file).extension().string()), read_as_bodies))
    throw input_error("'{}' is no scene that is probed; `hmax stability predict --scene FILE` takes it",
                      file);
  if (!kind || !fs::is_regular_file(file, ignored))
    throw input_error("'{}' is no scene; give {}, or a stepper of your own with --plugin FILE.so", file,
                      known);
  const fs::path module = module_file(kind->module), whole = fs::absolute(file);
  if (!fs::exists(module, ignored))
    throw input_error(
        "this hmax has no module for {} files; install the package hmax-engines, or {} and build hmax again",
        fs::path(file).extension().string(), kind->packages);
  return {.file = module,
          .argument = whole.string(),
          .text = file,
          .engine_file = whole,
          .subject = std::string(kind->engine)};
}

PluginName parse_plugin(std::string_view text) {
  PluginName plugin{.text = std::string(text)};
  std::string file = plugin.text;
  std::error_code ignored;
  if (engine_format(file) && fs::exists(file, ignored)) return parse_engine_file(file);
  // A folder may have a colon in its name: the first one behind a file counts, and for what is said where
  // there is none the first of all.
  std::size_t colon = text.find(':');
  for (std::size_t next = colon; next != std::string_view::npos; next = text.find(':', next + 1))
    if (fs::is_regular_file(text.substr(0, next), ignored)) {
      colon = next;
      break;
    }
  if (colon != std::string_view::npos && !fs::exists(file, ignored)) {
    file = text.substr(0, colon);
    const std::string_view rest = text.substr(colon + 1);
    const std::size_t second = rest.find(':');
    plugin.name = rest.substr(0, second);
    if (second != std::string_view::npos) plugin.argument = rest.substr(second + 1);
  }
  if (file.empty()) throw InputError("--plugin names no file; write FILE.so[:NAME[:ARGUMENT]]");
  if (!fs::exists(file, ignored))
    throw input_error("there is no file '{}'; give the path of the shared library", file);
  if (!fs::is_regular_file(file, ignored))
    throw input_error("'{}' is no file; give the path of the shared library", file);
  plugin.file = fs::absolute(file);
  return plugin;
}

std::string plugin_digest(const PluginName& plugin) {
  Digest digest;
  const bool of_engine = !plugin.engine_file.empty();
  if (!of_engine) digest.add(plugin.argument);
  std::ifstream file(of_engine ? plugin.engine_file : plugin.file, std::ios::binary);
  std::array<char, 65536> bytes{};
  while (file.read(bytes.data(), bytes.size()), file.gcount() > 0)
    digest.add({bytes.data(), static_cast<std::size_t>(file.gcount())});
  return digest.text().substr(0, 8);
}

}  // namespace hmax
