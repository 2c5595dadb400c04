/// Result stores as users name them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "results/store.hpp"

namespace hmax {

/// A store by the path of its file, or by its name under results/runs.
/// @throws InputError  with a suggestion where there is none, and what Store throws
Store open_store(const std::string& name);

/// The files that end in .sqlite in results/runs and in its folders, sorted by their paths.
/// @throws InputError  where there is none
std::vector<std::filesystem::path> stored_files();

}  // namespace hmax
