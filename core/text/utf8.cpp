#include "core/text/utf8.hpp"

#include <cstdint>

namespace hmax {

std::size_t utf8_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t size = first >= 0xC2 && first < 0xE0   ? 2
                           : first >= 0xE0 && first < 0xF0 ? 3
                           : first >= 0xF0 && first < 0xF5 ? 4
                                                           : 0;
  if (size == 0 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  // Overlong forms, surrogates and what lies beyond U+10FFFF are not characters.
  if ((first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) >= 0xA0) ||
      (first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) >= 0x90))
    return 0;
  return size;
}

std::string as_utf8(std::string_view text) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string valid;
  valid.reserve(text.size());
  while (!text.empty()) {
    const std::size_t size = utf8_character(text);
    if (size > 0) {
      valid += text.substr(0, size);
    } else {
      const auto byte = static_cast<std::uint8_t>(text[0]);
      valid += "\\x";
      valid += digits[byte >> 4];
      valid += digits[byte & 15];
    }
    text.remove_prefix(size > 0 ? size : 1);
  }
  return valid;
}

}  // namespace hmax
