#include "cli/shared/shown_text.hpp"

#include <algorithm>
#include <array>

namespace hmax {

namespace {

constexpr std::string_view reset = "\x1b[0m";
constexpr std::array<std::string_view, 4> sequences{"\x1b[1m", "\x1b[2m", "\x1b[1;31m", reset};

unsigned char byte_at(std::string_view text, std::size_t i) noexcept {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
}

/// Bytes of the sequence of our own at the start of `text`, 0 where there is none.
std::size_t painted_bytes(std::string_view text) {
  for (const std::string_view sequence : sequences)
    if (text.starts_with(sequence)) return sequence.size();
  return 0;
}

}  // namespace

std::size_t control_bytes(std::string_view text, std::size_t i) noexcept {
  const unsigned char c = byte_at(text, i), next = byte_at(text, i + 1), last = byte_at(text, i + 2);
  if (c < 0x20 || c == 0x7f) return 1;
  if (c == 0xc2) return next >= 0x80 && next < 0xa0 ? 2 : 0;
  if (c == 0xe2)
    return (next == 0x80 && last >= 0xaa && last <= 0xae) || (next == 0x81 && last >= 0xa6 && last <= 0xa9)
               ? 3
               : 0;
  return c >= 0x80 && c < 0xa0 && (i == 0 || byte_at(text, i - 1) < 0x80) ? 1 : 0;
}

std::string shown_text(std::string_view text, ShownAs as) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t ours = as.colours ? painted_bytes(text.substr(i)) : 0;
    const bool is_break = text[i] == '\n' || (text[i] == '\r' && !as.line_breaks);
    const std::size_t control = ours > 0 || is_break || text[i] == '\t' ? 0 : control_bytes(text, i);
    const std::size_t taken = std::max<std::size_t>({ours, control, 1});
    if (is_break && !as.line_breaks)
      shown += ' ';
    else if (control == 0)
      shown += text.substr(i, taken);
    else
      for (const char c : text.substr(i, taken)) {
        const auto byte = static_cast<unsigned char>(c);
        shown += {'\\', 'x', digits[byte / 16], digits[byte % 16]};
      }
    i += taken;
  }
  return shown;
}

std::string shell_word(std::string_view text) {
  constexpr std::string_view plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+:,=@%";
  if (!text.empty() && text.find_first_not_of(plain) == std::string_view::npos) return std::string(text);
  std::string word = "'";
  for (const char letter : text) word += letter == '\'' ? "'\\''" : std::string(1, letter);
  return word + "'";
}

std::string painted_text(std::string_view code, std::string_view text) {
  std::string painted = "\x1b[";
  return painted.append(code).append("m").append(text).append(reset);
}

}  // namespace hmax
