/// CalculiX .sti, .mas and .dam, as *FREQUENCY with SOLVER=MATRIXSTORAGE writes them.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "problems/matrices/matrix_readers.hpp"

namespace hmax {

namespace {

/// CalculiX stores a sum for each place, so that a second entry is none of its own.
/// @throws std::invalid_argument  where two entries have one place
void refuse_repeated(const MatrixFile& file, const MatrixLines& lines) {
  std::vector<std::pair<int, int>> places;
  places.reserve(file.entries.size());
  for (const MatrixEntry& entry : file.entries) places.emplace_back(entry.row(), entry.col());
  std::ranges::sort(places);
  const auto again = std::ranges::adjacent_find(places);
  if (again == places.end()) return;
  lines.fail_at_end(
      "row " + std::to_string(again->first + 1) + ", column " + std::to_string(again->second + 1) +
      " has two entries, and CalculiX writes each one once; the file is damaged or several in one, so "
      "export the matrix again");
}

}  // namespace

MatrixFile read_calculix(const std::string& name, std::string_view text) {
  MatrixFile file{.name = name, .format = "CalculiX", .open_shape = true};
  MatrixLines lines(name, text, 0);
  bool above = false, below = false;
  while (lines.next()) {
    if (lines.words() != 3)
      lines.fail("the line has " + std::to_string(lines.words()) +
                 " words but an entry is row, column and value; export the matrix again");
    const std::int64_t i = lines.integer(0, "the row", 1, most_matrix_rows);
    const std::int64_t j = lines.integer(1, "the column", 1, most_matrix_rows);
    file.entries.emplace_back(static_cast<int>(i - 1), static_cast<int>(j - 1), lines.number(2, "the value"));
    above = above || i < j;
    below = below || i > j;
    file.rows = file.columns = std::max<Eigen::Index>(file.rows, std::max(i, j));
  }
  if (file.entries.empty()) lines.fail_at_end("the file has no entries; export the matrix again");
  if (!lines.ends_with_a_break())
    lines.fail_at_end("the last line has no line break, so the file may be cut off; add one if it is whole");
  refuse_repeated(file, lines);
  if (above != below) file.storage = Storage::symmetric;
  return file;
}

}  // namespace hmax
