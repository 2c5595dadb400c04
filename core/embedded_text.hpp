/// Files that cmake/embed.cmake has compiled into the program.
#pragma once

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hmax {

struct EmbeddedText {
  std::string_view name;  ///< of the file, without its ending
  std::string_view text;
};

/// The text of that name. @throws std::logic_error  when there is none
inline std::string_view text_of(std::span<const EmbeddedText> texts, std::string_view name) {
  const auto found = std::ranges::find(texts, name, &EmbeddedText::name);
  if (found == texts.end()) throw std::logic_error("there is no text " + std::string(name));
  return found->text;
}

}  // namespace hmax
