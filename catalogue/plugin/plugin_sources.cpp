#include "catalogue/plugin/plugin_sources.hpp"

#include <fstream>
#include <iterator>

#include "core/input_error.hpp"

namespace hmax {

std::vector<std::filesystem::path> write_plugin_examples(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const std::vector<std::pair<fs::path, std::string_view>> files{
      {folder / "hmax" / "plugin.h", plugin_headers().front().text},
      {folder / "plugin_stepper.cpp", plugin_step_examples().front().text},
      {folder / "plugin_model.c", plugin_model_examples().front().text}};
  std::error_code failed;
  fs::create_directories(folder / "hmax", failed);
  std::vector<fs::path> written;
  for (const auto& [file, text] : files) {
    if (std::ifstream before(file); before) {
      const std::string there{std::istreambuf_iterator<char>(before), {}};
      if (there != text)
        throw input_error("{} is there already and differs; name another folder", file.string());
    }
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush()) throw input_error("cannot write {}; name another folder", file.string());
    written.push_back(file);
  }
  return written;
}

}  // namespace hmax
