/// A page of HTML that holds its pictures in itself and needs nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plots/pages/frame.hpp"

namespace hmax {

/// A picture of a page.
struct PagePicture {
  std::string svg = {};      ///< the text of an SVG file; empty when it was not drawn
  std::string caption = {};  ///< what is seen, also for those who cannot see it
  std::string problem = {};  ///< why it was not drawn
  std::string alt = {};      ///< more words for those who cannot see it; the caption where there are none
};

/// What there is of it stands in this order.
struct PageSection {
  std::string title = {};
  std::string lead = {};  ///< the sentence that matters
  std::string text = {};
  /// Names and words; what has no name goes on with the last.
  std::vector<std::pair<std::string, std::string>> facts = {};
  std::vector<std::string> list = {};
  std::vector<PagePicture> pictures = {};
  std::vector<std::vector<std::string>> table = {};  ///< rows of equal length, the first of them headings
};

/// The HTML of sections, with the ids s0, s1, ... at their headings, for the content of a page. Every text is
/// shown as it is; none of it becomes markup. Bytes that are not UTF-8 become '?'.
/// @param first  number of the first section
std::string sections_html(const std::vector<PageSection>& sections, std::size_t first = 0);

/// The navigation to these sections.
std::vector<PageLink> section_links(const std::vector<PageSection>& sections, std::size_t first = 0);

/// A table with its headings.
/// @param rows   of equal length, the first of them headings
/// @param label  for screen readers
std::string table_html(const std::vector<std::vector<std::string>>& rows, const std::string& label);

/// A picture as an `img` that holds it. An SVG stays text, which is smaller than base64.
/// @param alt  shown as it is
std::string embedded_svg(std::string_view svg, const std::string& alt);
std::string embedded_png(std::string_view png, const std::string& alt);

/// The same for the script packed_figures.js.
/// @param deflated  an SVG as plots/pages/encodings/deflate.hpp makes it
std::string packed_svg(std::string_view deflated, const std::string& alt);

/// A page of these sections. Every text is shown as it is; none of it becomes markup. Bytes that are not
/// UTF-8 become '?'.
std::string page_text(const std::string& title, const std::string& introduction,
                      const std::vector<PageSection>& sections);

/// Writes `page_text`; the folder is made when missing.
/// @throws InputError when it cannot be written
void write_page(const std::filesystem::path& file, const std::string& text);

}  // namespace hmax
