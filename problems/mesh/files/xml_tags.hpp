/// The tags of an XML file as far as VTK's files need them; for the sources of the readers only.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "problems/mesh/files/mesh_text.hpp"

namespace hmax {

/// A tag and where it stands in the whole text.
struct XmlTag {
  std::string_view name;  ///< "/Piece" for an end
  std::vector<std::pair<std::string_view, std::string_view>> attributes;
  std::size_t begin, end;  ///< of "<" and behind ">"
  bool empty;              ///< ends with "/>"

  /// The value of an attribute, or `otherwise`.
  [[nodiscard]] std::string_view attribute(std::string_view name, std::string_view otherwise = "") const;
};

/// A text with &amp;, &#123; and the like as the characters that they stand for, in UTF-8.
std::string unescaped(std::string_view text);

/// Where the text goes on behind blanks, comments and declarations at `from`.
std::size_t behind_comments(std::string_view whole, std::size_t from);

/// The first tag at or behind `from`, without comments and declarations; nothing at the end of the text.
/// @param text  for the name of the file in errors
/// @throws std::invalid_argument when a tag has no end, or an attribute twice
std::optional<XmlTag> next_tag(const MeshText& text, std::string_view whole, std::size_t from);

}  // namespace hmax
