/// Numbers in the messages and labels of problems.
#pragma once

#include <charconv>
#include <string>

namespace hmax {

/// The shortest digits that read back equal: "1.45", "-1e-300", "inf".
inline std::string shortest_digits(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

}  // namespace hmax
