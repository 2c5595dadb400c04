/// What the readers of matrices share.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "problems/matrices/matrix_file.hpp"

namespace hmax {

/// Most rows, columns and entries: indices are 32-bit numbers.
inline constexpr std::int64_t most_matrix_rows = 2'147'483'646;

/// The lines of a text file with what is blank, and what follows a comment character, left out.
class MatrixLines {
 public:
  /// @param comment  a line that starts with it says nothing; 0: no such lines
  MatrixLines(std::string name, std::string_view text, char comment)
      : name_(std::move(name)), text_(text), comment_(comment) {}

  /// Goes to the next line that says something. False at the end of the file.
  bool next();
  /// The words of the line; at most four are kept, `words` counts all of them.
  [[nodiscard]] const std::array<std::string_view, 4>& word() const { return word_; }
  [[nodiscard]] std::size_t words() const { return words_; }
  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] std::size_t left() const { return text_.size() - at_; }
  /// False where the last line of the file has no line break.
  [[nodiscard]] bool ends_with_a_break() const { return text_.ends_with('\n'); }

  /// A whole number from `least` to `most`. @param what  it is, for the error
  std::int64_t integer(std::size_t i, const char* what, std::int64_t least, std::int64_t most) const;
  /// A finite number.
  double number(std::size_t i, const char* what) const;
  /// Throws "NAME, line N: `text`".
  [[noreturn]] void fail(const std::string& text) const;
  /// The same without a line.
  [[noreturn]] void fail_at_end(const std::string& text) const;

 private:
  std::string name_;
  std::string_view text_, line_;
  std::size_t at_ = 0;
  std::int64_t number_ = 0;
  char comment_;
  std::array<std::string_view, 4> word_;
  std::size_t words_ = 0;
};

/// A number in the notations of C and Fortran: 1.5, +1.5E3, 1.0D+00, 1.0-101. NaN where it is none.
/// Numbers below the smallest double are zero.
double number_in(std::string_view word);

MatrixFile read_matrix_market(const std::string& name, std::string_view text);
/// CalculiX `.sti`, `.mas`, `.dam`: a line "row column value" for each entry of one triangle, or of both
/// where the matrix is not symmetric; no header.
MatrixFile read_calculix(const std::string& name, std::string_view text);
/// Big endian, with indices of 32 or 64 bits, which the first bytes tell apart.
MatrixFile read_petsc(const std::string& name, std::string_view bytes);
/// Whether bytes start as a matrix or vector of PETSc does.
bool is_petsc(std::string_view bytes);

}  // namespace hmax
