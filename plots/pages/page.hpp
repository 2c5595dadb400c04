/// A page of HTML that holds its pictures in itself and needs nothing else.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

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

/// Every text is shown as it is; none of it becomes markup. Bytes that are not UTF-8 become '?'.
std::string page_text(const std::string& title, const std::string& introduction,
                      const std::vector<PageSection>& sections);

/// Writes `page_text`; the folder is made when missing.
/// @throws InputError when it cannot be written
void write_page(const std::filesystem::path& file, const std::string& text);

}  // namespace hmax
