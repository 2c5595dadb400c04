/// The text files of the project, for tests that read the sources.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

namespace hmax::architecture {

inline std::filesystem::path source_dir() { return HMAX_SOURCE_DIR; }

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Files under `folder` with one of the extensions, relative to the project, sorted; stored runs are left
/// out.
inline std::vector<std::string> files_under(const std::string& folder,
                                            const std::set<std::string>& extensions) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  for (fs::recursive_directory_iterator it(source_dir() / folder), end; it != end; ++it) {
    const std::string file = fs::relative(it->path(), source_dir()).generic_string();
    if (it->is_directory() && file == "results/runs") it.disable_recursion_pending();
    if (it->is_regular_file() && extensions.contains(it->path().extension().string())) files.push_back(file);
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace hmax::architecture
