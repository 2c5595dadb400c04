/// Numbers in the messages and labels of problems.
#pragma once

#include <charconv>
#include <string>

namespace hmax {

/// Appends the shortest digits that read back equal: "1.45", "-1e-300", "inf".
template <class Number>
void append_digits(std::string& text, Number value) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

inline std::string shortest_digits(double value) {
  std::string digits;
  append_digits(digits, value);
  return digits;
}

}  // namespace hmax
