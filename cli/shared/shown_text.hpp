/// Text of others as a terminal may get it: names in files may hold control sequences.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hmax {

/// The bytes of the control character at text[i], 0 where there is none: C0 and DEL, C1 in UTF-8 or as a byte
/// of its own, and U+202A to U+202E and U+2066 to U+2069, which reverse what follows them.
std::size_t control_bytes(std::string_view text, std::size_t i) noexcept;

/// What stays as it is.
struct ShownAs {
  bool line_breaks = true;  ///< otherwise they become blanks
  bool colours = false;     ///< the sequences that painted_text() writes
};

/// The text with its control characters as \x1b and so on; tabs stay.
std::string shown_text(std::string_view text, ShownAs as = {});

/// One word of a shell: in quotes where it has more than letters, digits and what names of files often have.
std::string shell_word(std::string_view text);

/// Between the sequences of a terminal for `code`, such as "1" for bold, and for the end of it.
/// @param code  one of "1", "2" and "1;31", which shown_text() knows
std::string painted_text(std::string_view code, std::string_view text);

}  // namespace hmax
