/// CalculiX .sti, .mas and .dam, as *FREQUENCY with SOLVER=MATRIXSTORAGE writes them.
#include <algorithm>
#include <string>

#include "problems/matrices/matrix_readers.hpp"

namespace hmax {

MatrixFile read_calculix(const std::string& name, std::string_view text) {
  MatrixFile file{.name = name, .format = "CalculiX", .open_shape = true, .entries = {}};
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
  if (above != below) file.storage = Storage::symmetric;
  return file;
}

}  // namespace hmax
