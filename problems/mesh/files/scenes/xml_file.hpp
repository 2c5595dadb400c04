/// Scenes in XML: parts in parts, with attributes and values.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "problems/mesh/files/mesh_text.hpp"
#include "problems/mesh/files/xml_tags.hpp"

namespace hmax {

/// A tag with what is in it.
struct XmlPart {
  std::string_view type;  ///< its name, or that of <Object type="NAME">
  XmlTag tag;
  std::int64_t place = 0;             ///< its line
  std::optional<std::size_t> node{};  ///< the part that it is in; none of the root
  std::string text{};                 ///< up to the next tag, without comments
  [[nodiscard]] std::string_view name() const { return tag.attribute("name"); }
  [[nodiscard]] bool has(std::string_view attribute) const;
};

/// A whole file, which must live as long as this.
class XmlFile {
 public:
  /// @param root  the name of the tag that all others are in
  /// @throws std::invalid_argument  where tags are damaged or do not match, and for another root
  XmlFile(const std::string& name, std::string_view bytes, std::string_view root);

  [[nodiscard]] const std::string& name() const { return text_.name(); }
  /// In the order of the file; the root first.
  [[nodiscard]] const std::vector<XmlPart>& parts() const { return parts_; }
  [[nodiscard]] const XmlPart* parent(const XmlPart& part) const {
    return part.node ? &parts_[*part.node] : nullptr;
  }
  /// The parts in a part, but not those in them.
  [[nodiscard]] std::vector<const XmlPart*> within(const XmlPart& part) const;
  /// Those of a type.
  [[nodiscard]] std::vector<const XmlPart*> all(const XmlPart& part, std::string_view type) const;
  /// Null where there is none.
  [[nodiscard]] const XmlPart* first(const XmlPart& part, std::string_view type) const;
  /// A text of a part, to be read word by word.
  [[nodiscard]] MeshText values(const XmlPart& part, std::string_view text) const;
  /// Finite numbers of an attribute. @throws std::invalid_argument  naming the line
  [[nodiscard]] std::vector<double> numbers(const XmlPart& part, std::string_view attribute) const;
  /// `count` of them.
  [[nodiscard]] std::vector<double> numbers(const XmlPart& part, std::string_view attribute,
                                            std::size_t count) const;
  /// Those of its text, with blanks or commas between them.
  [[nodiscard]] std::vector<double> numbers(const XmlPart& part) const;
  /// Throws "NAME, line N: `text`".
  /// "NAME, line N: " of the first part of a kind; empty without one.
  template <class Is>
  [[nodiscard]] std::string place_of_first(const Is& is) const {
    const auto found = std::ranges::find_if(parts_, is);
    return found == parts_.end() ? "" : place_in_words(name(), found->place, false);
  }
  [[noreturn]] void fail(const XmlPart& part, const std::string& text) const { at(part).fail(text); }
  /// The file, for errors at a part.
  [[nodiscard]] MeshText at(const XmlPart& part) const { return values(part, {}); }

 private:
  MeshText text_;
  std::vector<XmlPart> parts_;
};

}  // namespace hmax
