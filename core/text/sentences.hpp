/// Sentences of a status, one after the other.
#pragma once

#include <string>
#include <string_view>

namespace hmax {

/// "a; b", or the one of them that says something.
inline std::string joined(std::string_view a, std::string_view b) {
  return std::string(a).append(a.empty() || b.empty() ? "" : "; ").append(b);
}

/// text = joined(text, sentence).
inline void add_sentence(std::string& text, std::string_view sentence) { text = joined(text, sentence); }

}  // namespace hmax
