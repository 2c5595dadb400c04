#include "problems/matrices/read_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/process/whole_file.hpp"
#include "core/text/utf8.hpp"
#include "problems/matrices/matrix_readers.hpp"
#include "problems/mesh/files/mesh_text.hpp"

namespace hmax {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view a_matrix_file = "a matrix file";

bool starts_as_matrix_market(std::string_view bytes) {
  const std::size_t begin = bytes.find_first_not_of('%');
  if (begin == std::string_view::npos || begin == 0) return false;
  constexpr std::string_view word = "matrixmarket";
  return lower(bytes.substr(begin, word.size())) == word;
}

/// A sentence for formats that are met and not read; empty for all others.
std::string known_and_not_read(std::string_view bytes) {
  constexpr const char* remedy = "; write Matrix Market, for instance with scipy.io.mmwrite";
  if (bytes.starts_with("\x1f\x8b")) return "the file is compressed; unpack it with gunzip";
  if (bytes.starts_with("PK")) return std::string("the file is an archive, such as .npz") + remedy;
  if (bytes.starts_with("\x93NUMPY")) return std::string("the file is an array of NumPy") + remedy;
  if (bytes.starts_with("MATLAB")) return std::string("the file is one of MATLAB") + remedy;
  if (bytes.starts_with("\x89HDF")) return std::string("the file is HDF5") + remedy;
  if (bytes.starts_with("Mat Object") || bytes.starts_with("%Mat Object") || bytes.starts_with("Vec Object"))
    return "the file is the text of a PETSc object; view the object with a binary viewer";
  if (bytes.starts_with("*"))
    return "the file is a deck or a substructure of Abaqus or CalculiX; write .sti and .mas with *FREQUENCY, "
           "SOLVER=MATRIXSTORAGE, or Matrix Market";
  return {};
}

}  // namespace

MatrixFile matrix_from(const std::string& name, std::string_view bytes) {
  const auto fail = [&](const std::string& text) { throw std::invalid_argument(name + ": " + text); };
  bytes = without_byte_order_mark(bytes);
  if (bytes.empty()) fail("the file is empty; export the matrix again");
  if (starts_as_matrix_market(bytes)) return read_matrix_market(name, bytes);
  if (is_petsc(bytes)) return read_petsc(name, bytes);
  if (const std::string sentence = known_and_not_read(bytes); !sentence.empty()) fail(sentence);
  const std::string extension = lower(fs::path(name).extension().string());
  if (extension == ".sti" || extension == ".mas" || extension == ".dam") return read_calculix(name, bytes);
  fail(
      "the file starts with " + in_quotes(bytes.substr(0, std::min(bytes.find('\n'), bytes.size()))) +
      " and is neither Matrix Market, whose first line is like %%MatrixMarket matrix coordinate real general, nor "
      "PETSc binary, nor CalculiX .sti or .mas; export it as one of these");
  return {};
}

MatrixFile read_matrix(const fs::path& file) {
  return within_memory(file, [&] { return matrix_from(file.string(), read_whole(file, a_matrix_file)); });
}

std::vector<SeriesEntry> read_series(const fs::path& file) {
  const std::string text = read_whole(file, a_matrix_file);
  MatrixLines lines(file.string(), text, '#');
  std::vector<SeriesEntry> series;
  while (lines.next()) {
    if (lines.words() != 2)
      lines.fail(
          "the line has " + std::to_string(lines.words()) +
          " words but should be a time in seconds and the name of a matrix file, such as 0.5 K_1.mtx; correct it");
    const double t = lines.number(0, "the time");
    if (!series.empty() && !(t > series.back().t))
      lines.fail("the time is " + std::string(lines.word()[0]) +
                 " s but must be later than that of the line before; sort "
                 "the lines by their times");
    const fs::path name(lines.word()[1]);
    series.push_back({t, name.is_absolute() ? name : file.parent_path() / name});
  }
  if (series.size() < 2)
    lines.fail_at_end("the series names " + std::to_string(series.size()) +
                      (series.size() == 1 ? " matrix" : " matrices") +
                      " but needs two or more; a matrix that does not change is named without series:");
  return series;
}

std::vector<std::string> read_unknown_names(const fs::path& file) {
  const std::string text = read_whole(file, a_matrix_file);
  MatrixLines lines(file.string(), text, '#');
  std::vector<std::string> names;
  while (lines.next()) {
    if (lines.words() != 1 || !std::isfinite(number_in(lines.word()[0])))
      lines.fail("the line should be node.direction, such as 12.3, and is " + in_quotes(lines.line()) +
                 "; export the matrices again");
    names.emplace_back(lines.word()[0]);
  }
  return names;
}

}  // namespace hmax
