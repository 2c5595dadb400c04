#include "catalogue/plugin/plugin_name.hpp"

#include <array>
#include <fstream>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/text/digest.hpp"

namespace hmax {

PluginName parse_plugin(std::string_view text) {
  namespace fs = std::filesystem;
  PluginName plugin{.file = {}, .name = {}, .argument = {}, .text = std::string(text)};
  std::string file = plugin.text;
  std::error_code ignored;
  const std::size_t colon = text.find(':');
  if (colon != std::string_view::npos && !fs::exists(file, ignored)) {
    file = text.substr(0, colon);
    const std::string_view rest = text.substr(colon + 1);
    const std::size_t second = rest.find(':');
    plugin.name = rest.substr(0, second);
    if (second != std::string_view::npos) plugin.argument = rest.substr(second + 1);
  }
  if (file.empty()) throw InputError("--plugin names no file; write FILE.so[:NAME[:ARGUMENT]]");
  if (!fs::exists(file, ignored))
    throw InputError(fmt::format("there is no file '{}'; give the path of the shared library", file));
  if (!fs::is_regular_file(file, ignored))
    throw InputError(fmt::format("'{}' is no file; give the path of the shared library", file));
  plugin.file = fs::absolute(file);
  return plugin;
}

std::string plugin_digest(const PluginName& plugin) {
  Digest digest;
  digest.add(plugin.argument);
  std::ifstream file(plugin.file, std::ios::binary);
  std::array<char, 65536> bytes{};
  while (file.read(bytes.data(), bytes.size()), file.gcount() > 0)
    digest.add({bytes.data(), static_cast<std::size_t>(file.gcount())});
  return digest.text().substr(0, 8);
}

}  // namespace hmax
