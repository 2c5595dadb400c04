/// The characters of UTF-8 (RFC 3629). File names are bytes: they need not be UTF-8.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hmax {

/// The bytes of the character at the start of `text`, which is not empty; 0 when there is none.
std::size_t utf8_character(std::string_view text);

/// `text` with \xE9 for each byte, here E9, that is part of no character. UTF-8 stays as it is.
std::string as_utf8(std::string_view text);

/// `text` without the mark by which Windows tells UTF-8, which stands before what other programs begin with.
constexpr std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.substr(text.starts_with(mark) ? mark.size() : 0);
}

}  // namespace hmax
