/// Named columns with the words that explain them: the form in which a curve is stored and reaches a figure.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hmax {

/// Columns of equal length. Written as CSV with `# key: value` lines above the header; numbers are written
/// with the shortest digits that read back equal, non-finite ones as nan, inf, -inf.
struct Table {
  std::vector<std::pair<std::string, std::string>> notes{};  ///< key, value; order kept
  std::vector<std::string> columns;                          ///< names with units, "x [m]"
  std::vector<std::vector<double>> values{};                 ///< values[column][row]
};

/// Replaces the file in one move, so that a failure leaves the old one; makes the folder when it is missing.
/// @throws InputError             when the file cannot be written (path and remedy named)
/// @throws std::invalid_argument  when the columns are none or of unequal length, or a note's key has a colon
void write_csv(const std::filesystem::path& file, const Table& table);

/// The text that write_csv puts into a file.
std::string to_csv(const Table& table);

/// Accepts CRLF, a byte-order mark, blank lines and a missing final newline. Notes may stand anywhere; a `#`
/// line without colon is passed over.
/// @throws InputError naming file and line when a row has the wrong number of cells or a cell is not a number
Table read_csv(const std::filesystem::path& file);

/// read_csv on text that is in memory; `name` stands for the file in errors.
Table parse_csv(std::string_view text, const std::string& name);

/// Replaces `file` by `text` in one move; a folder that is missing is made. All outputs are opened here.
/// @param opening  with which every file of this form begins, where it holds no own_mark (core/own_files.hpp)
/// @throws InputError when the file cannot be written or must not be replaced (path and remedy named)
void write_file(const std::filesystem::path& file, std::string_view text, std::string_view opening = {});

/// Throws what write_file would throw now for this place, and leaves nothing behind but a missing folder
/// made.
void check_writable(const std::filesystem::path& file, std::string_view opening = {});

/// @throws InputError when an output must not replace `file` @param own  whether hmax has written it
void check_replaceable(const std::filesystem::path& file, bool own);

/// A cell as CSV wants it: in quotes when it holds a comma, a quote, a line break or begins with `#`.
std::string csv_cell(std::string_view text);

}  // namespace hmax
