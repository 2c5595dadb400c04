/// Matrix Market [boisvert1996matrix]: coordinate and array; real and integer; general, symmetric and
/// skew-symmetric.
#include <string>

#include "problems/matrices/matrix_readers.hpp"
#include "problems/mesh/files/mesh_text.hpp"

namespace hmax {
namespace {

/// What the first line says.
struct Banner {
  bool dense = false;
  Storage storage = Storage::general;
};

[[noreturn]] void fail_banner(const std::string& name, const std::string& text) {
  throw std::invalid_argument(name + ", line 1: " + text);
}

Banner banner_of(const std::string& name, std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t begin = line.find_first_not_of(" \t\r", i);
    if (begin == std::string_view::npos) break;
    i = std::min(line.find_first_of(" \t\r", begin), line.size());
    words.push_back(lower(line.substr(begin, i - begin)));
  }
  if (words.size() != 5)
    fail_banner(
        name,
        "the header has " + std::to_string(words.size()) +
            " words but must have five; write for instance %%MatrixMarket matrix coordinate real general");
  if (words[1] != "matrix")
    fail_banner(
        name, "the file holds a " + in_quotes(words[1]) + "; write a matrix, a vector is one of one column");
  Banner banner;
  if (words[2] != "coordinate" && words[2] != "array")
    fail_banner(name, "unknown form " + in_quotes(words[2]) + "; write coordinate or array");
  banner.dense = words[2] == "array";
  if (words[3] == "complex")
    fail_banner(name, "the entries are complex, and models are real; export the real matrix");
  if (words[3] == "pattern")
    fail_banner(name, "the file holds a pattern without values; export the matrix with its values");
  if (words[3] != "real" && words[3] != "integer" && words[3] != "double")
    fail_banner(name, "unknown kind of entries " + in_quotes(words[3]) + "; write real or integer");
  if (words[4] == "hermitian")
    fail_banner(name, "the matrix is Hermitian, and models are real; export a symmetric matrix");
  if (words[4] == "symmetric")
    banner.storage = Storage::symmetric;
  else if (words[4] == "skew-symmetric")
    banner.storage = Storage::skew;
  else if (words[4] != "general")
    fail_banner(name,
                "unknown symmetry " + in_quotes(words[4]) + "; write general, symmetric or skew-symmetric");
  return banner;
}

void require_room(const MatrixLines& lines, std::int64_t count, std::size_t bytes) {
  if (static_cast<std::uint64_t>(count) > (lines.left() + 1) / bytes)
    lines.fail("the header announces " + std::to_string(count) + " entries, and the file has only " +
               std::to_string(lines.left()) + " more bytes; it is cut off, so export it again");
}

void require_words(const MatrixLines& lines, std::size_t count, const char* what) {
  if (lines.words() != count)
    lines.fail("the line has " + std::to_string(lines.words()) + " words but " + what +
               "; correct it or export the matrix again");
}

/// One of a triangle of (i, j).
void read_coordinates(MatrixLines& lines, MatrixFile& file, std::int64_t count) {
  file.entries.reserve(static_cast<std::size_t>(count));
  bool above = false, below = false;
  for (std::int64_t k = 0; k < count; ++k) {
    if (!lines.next())
      lines.fail_at_end("the file ends after " + std::to_string(k) + " of " + std::to_string(count) +
                        " entries; it is cut off, so export it again");
    require_words(lines, 3, "an entry is row, column and value");
    const std::int64_t i = lines.integer(0, "the row", 1, file.rows) - 1;
    const std::int64_t j = lines.integer(1, "the column", 1, file.columns) - 1;
    const double value = lines.number(2, "the value");
    file.entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
    if (file.storage == Storage::general) continue;
    above = above || i < j;
    below = below || i > j;
    if (above && below)
      lines.fail(
          "the header says that one triangle is stored, and entries stand on both sides of the diagonal; write "
          "general into the header if all entries are stored");
    if (file.storage == Storage::skew && i == j && value != 0)
      lines.fail("a skew-symmetric matrix has zeros on its diagonal; correct the entry or the header");
  }
}

/// Column by column; of symmetric matrices the part from the diagonal down.
void read_array(MatrixLines& lines, MatrixFile& file) {
  for (Eigen::Index j = 0; j < file.columns; ++j) {
    const Eigen::Index first = file.storage == Storage::general     ? 0
                               : file.storage == Storage::symmetric ? j
                                                                    : j + 1;
    for (Eigen::Index i = first; i < file.rows; ++i) {
      if (!lines.next())
        lines.fail_at_end("the file ends before row " + std::to_string(i + 1) + " of column " +
                          std::to_string(j + 1) + "; it is cut off, so export it again");
      require_words(lines, 1, "an entry of an array is one value");
      const double value = lines.number(0, "the value");
      if (value != 0) file.entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
    }
  }
}

}  // namespace

MatrixFile read_matrix_market(const std::string& name, std::string_view text) {
  const std::size_t first = std::min(text.find('\n'), text.size());
  const Banner banner = banner_of(name, text.substr(0, first));
  MatrixFile file{.name = name, .format = "Matrix Market", .storage = banner.storage};
  MatrixLines lines(name, text, '%');
  if (!lines.next()) lines.fail_at_end("the line with the size is missing; export the matrix again");
  require_words(lines, banner.dense ? 2 : 3,
                banner.dense ? "the size is rows and columns" : "the size is rows, columns and entries");
  file.rows = lines.integer(0, "the number of rows", 1, most_matrix_rows);
  file.columns = lines.integer(1, "the number of columns", 1, most_matrix_rows);
  if (banner.storage != Storage::general && file.rows != file.columns)
    lines.fail("a " + std::string(banner.storage == Storage::skew ? "skew-symmetric" : "symmetric") +
               " matrix is square; correct the size or the header");
  if (banner.dense) {
    const std::int64_t n = file.rows;
    // Both factors are below 2^31.
    const std::int64_t count = banner.storage == Storage::general     ? n * file.columns
                               : banner.storage == Storage::symmetric ? n * (n + 1) / 2
                                                                      : n * (n - 1) / 2;
    require_room(lines, count, 2);
    read_array(lines, file);
  } else {
    const std::int64_t count = lines.integer(2, "the number of entries", 0, most_matrix_rows);
    require_room(lines, count, 6);
    read_coordinates(lines, file, count);
  }
  if (lines.next())
    lines.fail(
        "the file goes on behind its last entry; correct the number of entries or export the matrix again");
  if (!lines.ends_with_a_break())
    lines.fail_at_end("the last line has no line break, so the file may be cut off; add one if it is whole");
  return file;
}

}  // namespace hmax
