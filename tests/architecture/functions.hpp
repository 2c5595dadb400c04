/// How long the functions of a source are, as its layout shows it.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace hmax::architecture {

/// A definition that begins in the first column and ends with a brace there.
struct FunctionLines {
  std::string head;  ///< its first line
  int line;          ///< of the file, from 1
  int lines;         ///< from the first to the last one
};

/// Those of a text in the format of the project: functions and tests, not types, nor what stands inside of
/// them.
inline std::vector<FunctionLines> functions_of(const std::string& text) {
  enum class At { outside, head, body };
  const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  std::vector<FunctionLines> functions;
  std::istringstream in(text);
  FunctionLines here{};
  At at = At::outside;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const bool first_column = !line.empty() && line.front() != ' ';
    if (at == At::outside) {
      if (line.empty() || !is_letter(line.front()) || line.starts_with("namespace ")) continue;
      here = {line, number, 0};
      at = At::head;
    }
    if (at == At::head && line.ends_with('{'))
      at = At::body;
    else if (at == At::head && (line.ends_with(';') || line.ends_with('}')))
      at = At::outside;  // a declaration, or all of it on few lines
    else if (at == At::body && line == "}") {
      functions.push_back({here.head, here.line, number - here.line + 1});
      at = At::outside;
    } else if (at == At::body && first_column && line.starts_with('}'))
      at = At::outside;  // a type, or a table
  }
  return functions;
}

}  // namespace hmax::architecture
