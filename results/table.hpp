/// Named columns with the words that explain them: the form in which a curve is stored and reaches a figure.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace hmax {

/// Columns of equal length. Written as CSV with `# key: value` lines above the header; numbers are written with the
/// shortest digits that read back equal, non-finite ones as nan, inf, -inf.
struct Table {
  std::vector<std::pair<std::string, std::string>> notes;  ///< key, value; order kept
  std::vector<std::string> columns;                        ///< names with units, "x [m]"
  std::vector<std::vector<double>> values;                 ///< values[column][row]
};

/// @throws InputError when the file cannot be written (path and remedy named)
void write_csv(const std::filesystem::path& file, const Table& table);

/// @throws InputError naming file and line when a row has the wrong number of cells or a cell is not a number
Table read_csv(const std::filesystem::path& file);

}  // namespace hmax
