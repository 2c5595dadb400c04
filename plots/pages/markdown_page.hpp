/// A page of Markdown as a page of HTML that holds its pictures.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "plots/pages/frame.hpp"

namespace hmax {

/// The id that GitHub gives a heading: lower case, blanks as hyphens; of other ASCII signs only - and _ stay.
/// Other characters stay as they are.
/// @param heading  its text, with or without Markdown's signs
std::string heading_anchor(std::string_view heading);

/// Markdown as parts of a page.
struct MarkdownParts {
  std::string title = {};            ///< of the first heading of level 1, which the HTML is without
  std::vector<PageLink> links = {};  ///< to the headings of level 2
  std::string html = {};
};

/// Without pictures, which stay links; otherwise as `markdown_page` does it.
MarkdownParts markdown_parts(const std::string& markdown);

/// `markdown` (GitHub's flavour with tables) as HTML. Markup in it is shown as text; comments are left out.
/// - The first heading of level 1 becomes the title, headings of level 2 the navigation; every heading has
/// the id
///   `heading_anchor`, with -1, -2, ... behind it where it occurs again.
/// - Pictures are embedded as SVG where a file of the same name with the ending .svg is there, otherwise as
/// PNG, and are links to their files. Where the page would be larger than `most_bytes`, the largest are
/// embedded as PNG, or linked. A sentence says so.
/// - A link to the README.md of another folder leads to the index.html beside it, where there is one.
/// @param folder      that relative links and pictures start from
std::string markdown_page(const std::string& markdown, const std::filesystem::path& folder,
                          std::size_t most_bytes = 5'000'000);

}  // namespace hmax
