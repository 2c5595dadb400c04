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
    if (at == At::head && line.ends_with('{')) {
      at = At::body;
      continue;
    }
    const bool is_function = at == At::body && line == "}";
    if (is_function) functions.push_back({here.head, here.line, number - here.line + 1});
    const bool is_short = at == At::head && (line.ends_with(';') || line.ends_with('}')),
               is_type_or_table = at == At::body && first_column && line.starts_with('}');
    if (is_function || is_short || is_type_or_table) at = At::outside;
  }
  return functions;
}

}  // namespace hmax::architecture
