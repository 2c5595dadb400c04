/// Bytes as text of 64 characters and back (RFC 4648, section 4).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hmax {

inline constexpr std::string_view base64_letters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// With padding, without line breaks.
inline std::string encode_base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : base64_letters[three >> (18 - 6 * k) & 63];
  }
  return text;
}

/// What a text stands for, without blanks. Padding may stand in the middle, where two encodings were joined.
/// Empty when a character is none of base64 or is missing.
inline std::optional<std::string> decode_base64(std::string_view text) {
  static constexpr auto values = [] {
    std::array<std::int8_t, 256> table{};
    table.fill(-1);
    for (std::size_t i = 0; i < 64; ++i)
      table[static_cast<unsigned char>(base64_letters[i])] = static_cast<std::int8_t>(i);
    return table;
  }();
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int letters = 0, padding = 0;
  for (const char c : text) {
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    const std::int8_t value = c == '=' ? std::int8_t{0} : values[static_cast<unsigned char>(c)];
    // Padding stands for the last or the last two letters of four.
    if (value < 0 || (c == '=' ? letters < 2 : padding > 0)) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    padding += c == '=' ? 1 : 0;
    if (++letters < 4) continue;
    for (int k = 0; k < 3 - padding; ++k) bytes += static_cast<char>(bits >> (16 - 8 * k) & 255);
    bits = 0;
    letters = padding = 0;
  }
  if (letters > 0) return std::nullopt;
  return bytes;
}

}  // namespace hmax
