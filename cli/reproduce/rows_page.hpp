/// A page over the stores of a reproduced study, beside its report.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace hmax {

struct RowsPage {
  std::filesystem::path file;
  std::size_t left_out = 0;  ///< rows for which 5 MB are too little; the page says so
};

/// Writes the page of `hmax report` over stores of `folder`: its rows.html.
/// @param stores  names of files in `folder`
/// @throws InputError when the page cannot be written
RowsPage write_rows_page(const std::filesystem::path& folder, const std::vector<std::string>& stores);

}  // namespace hmax
