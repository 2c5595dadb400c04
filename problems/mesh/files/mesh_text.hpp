/// A cursor over the bytes of a mesh file, for words and for raw values, which knows the line or byte it is
/// at.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace hmax {

/// A value from `bytes`, reversed if these have the other byte order.
template <class T>
T value_from(const char* bytes, bool swapped) {
  static_assert(std::is_arithmetic_v<T>);
  char buffer[sizeof(T)];
  std::memcpy(buffer, bytes, sizeof(T));
  if (swapped)
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(buffer[i], buffer[sizeof(T) - 1 - i]);
  return std::bit_cast<T>(buffer);
}

/// A character that ends a word.
inline bool is_blank(char c) {
  return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

/// Reads forward. Every error is one sentence that names file and place, as std::invalid_argument.
class MeshText {
 public:
  /// @param name     of the file, as messages tell it
  /// @param comment  the character after which a line says nothing, or 0
  MeshText(std::string name, std::string_view text, char comment = 0)
      : name_(std::move(name)), text_(text), comment_(comment) {}

  /// The part of a whole file from `begin` to `end`, read on its own.
  [[nodiscard]] MeshText part(std::size_t begin, std::size_t end) const;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::size_t position() const { return at_; }
  [[nodiscard]] std::size_t left() const { return text_.size() - at_; }
  /// The line, from 1, of the next word, or the byte, from 0, if values are raw.
  std::int64_t place();
  [[nodiscard]] bool counts_bytes() const { return raw_; }

  /// True when nothing but blanks is left.
  bool at_end();
  /// The next word between blanks, which must be there. @param what  what it should be, for the error
  std::string_view word(const char* what);
  /// The next word without going beyond it; empty at the end.
  std::string_view peek();
  /// A finite number.
  double number(const char* what);
  std::int64_t integer(const char* what);
  /// A label, which some programs write as a real number: "7" or "7.0".
  std::int64_t label(const char* what);
  /// A name between double quotes on one line.
  std::string quoted(const char* what);
  /// How many of something follow, each of at least `bytes` bytes: more than the rest can hold is an error,
  /// so that a header alone makes nobody reserve memory.
  std::size_t count(const char* what, std::size_t bytes);
  /// Refuses `count` of something that the rest cannot hold.
  void require_room(std::size_t count, const char* what, std::size_t bytes) const;
  /// From now on words come from the line of the next word alone, until end_line(). A word that is lost is
  /// then missed on its own line and not made up for by the next one.
  void begin_line();
  /// Refuses words that are left on the line. @param what  it holds, for the error
  void end_line(const char* what);
  /// Ends the line, whatever is left on it. @returns how many words that were
  std::size_t skip_rest_of_line();
  /// Refuses all that is left, and a last word that may have lost its end: of a file whose format marks none,
  /// that is all that tells that it was cut off.
  /// @param counted  whether counts tell that no word is missing, so that a blank ends the last one; where
  /// lists go on
  ///                 as long as they like, only the end of the line or a comment does
  void require_end(bool counted = true);
  /// The rest of this line, without its end; the cursor stands at the next line.
  std::string_view line();
  /// Goes behind the next occurrence of `word`, which must be there.
  void skip_behind(std::string_view word);

  /// Errors from now on are about this place, which was read before.
  void about(std::int64_t place) { about_ = place; }

  /// From now on places are bytes.
  void go_raw() { raw_ = true; }
  template <class T>
  T raw(const char* what, bool swapped) {
    return value_from<T>(bytes(sizeof(T), what).data(), swapped);
  }
  std::string_view bytes(std::size_t size, const char* what);
  /// Goes beyond the line break that must stand behind raw values: a byte that was lost among them would have
  /// drawn it in as the last one.
  void require_line_break();

  /// Throws "NAME, line N: `text`".
  [[noreturn]] void fail(const std::string& text) const;

 private:
  void skip_blanks();
  [[noreturn]] void fail_at_end(const char* what) const;

  std::string name_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t last_ = 0;      ///< where the last raw value began
  std::size_t word_end_ = 0;  ///< where the last word ended
  std::int64_t line_ = 1, about_ = -1;
  mutable std::size_t part_ =
      0;  ///< where the last part begins, from which lines are counted to the next one
  mutable std::int64_t part_line_ = 1;
  char comment_;
  bool raw_ = false, in_line_ = false;
};

/// "NAME, line N: " or "NAME, byte N: "
std::string place_in_words(const std::string& name, std::int64_t place, bool byte);

/// True when two keywords differ in the case of their letters at most.
bool same_keyword(std::string_view a, std::string_view b);

std::string lower(std::string_view text);
std::string upper(std::string_view text);

/// A piece of a file as messages can show it: short, and without what a terminal cannot print.
std::string in_quotes(std::string_view text);

}  // namespace hmax
