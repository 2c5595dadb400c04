/// Sentences: of a status, one after the other, and of errors, in one line.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace hmax {

/// "a; b", or the one of them that says something.
inline std::string joined(std::string_view a, std::string_view b) {
  return std::string(a).append(a.empty() || b.empty() ? "" : "; ").append(b);
}

/// text = joined(text, sentence).
inline void add_sentence(std::string& text, std::string_view sentence) { text = joined(text, sentence); }

/// `text` with '?' for each control character: pieces of a file that an error quotes may have line breaks.
inline std::string in_one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
  return text;
}

}  // namespace hmax
