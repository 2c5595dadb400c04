/// Where the figures, tables, equations and statements of both sources are redone.
#pragma once

#include <functional>
#include <span>
#include <string>

namespace hmax {

/// A piece of a source.
struct SourceItem {
  const char* item;  ///< "Figure 1", "slides 16 to 18"
  const char* says;  ///< what it shows or states
  const char*
      part;  ///< of `hmax reproduce all`: oscillators, stability, tissue; empty where it is not redone
  const char* section;  ///< of the part's page: the whole heading, or its beginning
  const char* note;     ///< why it is not redone, or what is different; often empty
};

/// The study of the liver oscillator.
std::span<const SourceItem> study_items();
/// The thesis on deformable organs, by its slides.
std::span<const SourceItem> thesis_items();

/// The items as a table in Markdown.
/// @param page  the text of the page of a part, from which the heading is taken; a section that it does not
/// have is named
///              without a link, and the part said not to be made where the text is empty
std::string items_table(std::span<const SourceItem> items,
                        const std::function<std::string(const std::string& part)>& page);

}  // namespace hmax
