#include "cli/shared/named_stores.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "catalogue/input/suggest.hpp"
#include "core/errors.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view runs = "results/runs", ending = ".sqlite";

/// Appends the stores directly in `folder`; one that is not there has none.
void add_files(const fs::path& folder, std::vector<fs::path>& files) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (std::error_code none; entry->path().extension() == ending && !entry->is_directory(none))
      files.push_back(entry->path());
}

}  // namespace

Store open_store(const std::string& name) {
  std::error_code error;
  const fs::path named = fs::path(runs) / (name + std::string(ending));
  const bool plain = name.find('/') == std::string::npos && !fs::exists(name, error);
  if (!plain) return Store::open_existing(name);
  if (fs::exists(named, error)) return Store::open_existing(named);
  std::vector<fs::path> files;
  add_files(runs, files);
  std::vector<std::string> known;
  for (const fs::path& file : files) known.push_back(file.stem().string());
  throw InputError(fmt::format("there is no store '{}', neither as a file nor under results/runs; {}", name,
                               suggestion(name, known, "`hmax sweep --out NAME` makes one")));
}

std::vector<fs::path> stored_files() {
  std::vector<fs::path> files;
  add_files(runs, files);
  std::error_code error;
  for (fs::directory_iterator entry(runs, error), end; !error && entry != end; entry.increment(error))
    if (std::error_code none; entry->is_directory(none)) add_files(entry->path(), files);
  if (files.empty())
    throw InputError(
        "there is no store in results/runs nor in its folders; name the file of a store, or make one with `hmax sweep --out NAME`");
  std::ranges::sort(files);
  return files;
}

}  // namespace hmax
