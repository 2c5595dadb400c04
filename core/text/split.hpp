/// Lists with separators between their parts.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

namespace hmax {

/// The parts between any of the separators, also empty ones: one more than there are separators.
inline std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// Whether a word is one of a list like "a|b|c".
inline bool is_listed(std::string_view word, std::string_view list) {
  const std::vector<std::string_view> words = split(list, "|");
  return std::ranges::find(words, word) != words.end();
}

/// A text without blanks around it.
inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\f\v\n";
  const std::size_t begin = std::min(text.find_first_not_of(blanks), text.size());
  return text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

}  // namespace hmax
