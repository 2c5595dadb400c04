#include "results/table.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/own_files.hpp"
#include "core/part_file.hpp"
#include "core/process/whole_file.hpp"
#include "core/text/split.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

/// Splits a line at its commas; a cell in double quotes may hold commas, and quotes written twice
/// [shafranovich2005common].
std::vector<std::string> split_cells(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"') {
        cells.back() += line[++i];
      } else {
        quoted = !quoted;
      }
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

InputError cannot_write(const fs::path& file, const std::string& cause) {
  return InputError(
      fmt::format("Cannot write '{}' ({}): choose another place, or make room and allow writing there.",
                  file.string(), cause));
}

/// Makes the folder of `file` when it is missing and looks whether `file` may be replaced.
/// @returns false when it cannot be replaced, only written to
bool is_replaced(const fs::path& file, std::string_view opening) {
  std::error_code error;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), error);
  if (error) throw cannot_write(file, error.message());
  if (fs::is_directory(file, error)) throw cannot_write(file, "it is a folder");
  if (is_written_in_place(file)) return false;
  check_replaceable(file, is_own_file(file, opening));
  return true;
}

}  // namespace

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos && !text.starts_with('#'))
    return std::string(text);
  std::string cell = "\"";
  for (const char c : text) {
    if (c == '"') cell += '"';
    cell += c;
  }
  return cell + '"';
}

std::string to_csv(const Table& table) {
  if (table.columns.empty() || table.values.size() != table.columns.size()) {
    throw std::invalid_argument("A table needs a name for every column and at least one column.");
  }
  const std::size_t rows = table.values[0].size();
  for (const auto& column : table.values) {
    if (column.size() != rows) throw std::invalid_argument("The columns of a table must be of equal length.");
  }
  std::string text = fmt::format("# {}\n", own_mark);
  for (const auto& [key, value] : table.notes) {
    if (key.find_first_of(":\r\n") != std::string::npos) {
      throw std::invalid_argument("The key of a note holds no colon and no line break.");
    }
    text += fmt::format("# {}: {}\n", key, one_line(value));
  }
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (c > 0) text += ',';
    text += csv_cell(one_line(table.columns[c]));
  }
  text += '\n';
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      if (c > 0) text += ',';
      text += to_text(table.values[c][r]);
    }
    text += '\n';
  }
  return text;
}

void check_replaceable(const fs::path& file, bool own) {
  if (const std::string refusal = why_not_replaced(file, own); !refusal.empty()) throw InputError(refusal);
}

void write_file(const fs::path& file, std::string_view text, std::string_view opening) {
  const bool replaces = is_replaced(file, opening);
  try {
    if (!replaces) return write_in_place(file, text);
    PartFile part(file);
    part.write(text);
    part.replace();
  } catch (const std::system_error& error) {
    throw cannot_write(file, error.code().message());
  }
}

void check_writable(const fs::path& file, std::string_view opening) {
  const bool replaces = is_replaced(file, opening);
  try {
    if (!replaces) return check_in_place(file);
    const PartFile part(file);
  } catch (const std::system_error& error) {
    throw cannot_write(file, error.code().message());
  }
}

void write_csv(const fs::path& file, const Table& table) { write_file(file, to_csv(table)); }

Table parse_csv(std::string_view text, const std::string& name) {
  Table table;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (int line_number = 1; !text.empty(); ++line_number) {
    const auto end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (trimmed(line).empty()) continue;

    if (line.starts_with('#')) {
      const auto colon = line.find(':');
      if (colon == std::string_view::npos) continue;
      table.notes.emplace_back(trimmed(line.substr(1, colon - 1)), trimmed(line.substr(colon + 1)));
      continue;
    }
    const std::vector<std::string> cells = split_cells(line);
    if (table.columns.empty()) {
      for (const std::string& cell : cells) table.columns.emplace_back(trimmed(cell));
      table.values.resize(cells.size());
      continue;
    }
    if (cells.size() != table.columns.size()) {
      const bool semicolons = line.find(';') != std::string_view::npos;
      throw InputError(fmt::format("{}:{}: {} cells where the header has {}{}.", name, line_number,
                                   cells.size(), table.columns.size(),
                                   semicolons ? ": separate cells by commas, not semicolons"
                                   : cells.size() > table.columns.size()
                                       ? ": write decimals with a point, 1.5 and not 1,5"
                                       : ": fill in the missing cells, with nan where there is no number"));
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const auto number = to_number(cells[c]);
      if (!number) {
        const char* hint =
            cells[c].find(',') != std::string::npos   ? "write decimals with a point, 1.5 and not 1,5"
            : cells[c].find(';') != std::string::npos ? "separate cells by commas, not semicolons"
                                                      : "write a number, or nan where there is none";
        throw InputError(
            fmt::format("{}:{}: '{}' in column '{}' is not a number within the range of double: {}.", name,
                        line_number, cells[c], table.columns[c], hint));
      }
      table.values[c].push_back(*number);
    }
  }
  if (table.columns.empty()) {
    throw InputError(fmt::format("'{}' holds no table: its first line must name the columns.", name));
  }
  return table;
}

Table read_csv(const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error)) {
    throw InputError(fmt::format("'{}' is a folder: name a CSV file inside it.", file.string()));
  }
  note_input(file);
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw InputError(fmt::format("Cannot read '{}' ({}): check the path and its permissions.", file.string(),
                                 errno ? std::strerror(errno) : "read failed"));
  }
  try {
    return within_memory(file, [&] {
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      return parse_csv(text, file.string());
    });
  } catch (const std::invalid_argument& wrong) {
    throw InputError(wrong.what());
  }
}

}  // namespace hmax
