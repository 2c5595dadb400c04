/// A folder of figures with a page that shows them, as Markdown and as HTML.
#pragma once

#include <filesystem>
#include <string>

#include "plots/draw.hpp"
#include "plots/pages/markdown_text.hpp"

namespace hmax {

/// A figure in Markdown: its picture (PNG, a link to its SVG) with links to PDF, script and data, relative to
/// `folder`; where it was not drawn the reason, and the script.
std::string figure_markdown(const FigureFiles& figure, const std::filesystem::path& folder);

/// @throws InputError where a report in `folder` would replace files that hmax did not write, before anything
/// is computed
void check_report_place(const std::filesystem::path& folder);

/// Writes a text in Markdown to folder / README.md, and the same as `markdown_page` to folder / index.html.
/// @returns the index.html
/// @throws InputError when they cannot be written
std::filesystem::path write_report(const std::string& text, const std::filesystem::path& folder);

}  // namespace hmax
