/// A folder of figures with a page that shows them, as Markdown and as HTML.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plots/draw.hpp"
#include "plots/pages/markdown_text.hpp"

namespace hmax {

/// One section of a report. Texts are Markdown; pass names from files through `markdown_text`.
struct ReportSection {
  std::string title;
  std::string text = {};
  std::vector<FigureFiles> figures =
      {};  ///< shown when drawn; otherwise the reason is told and the script linked
  std::vector<std::string> tables = {};  ///< Markdown, shown in full: keep them short
  std::string printed = {};              ///< what the study printed
  std::string differs = {};              ///< how this differs, and why
};

/// The README.md of `folder`: figures as pictures (PNG, each a link to its SVG) with links to PDF, script and
/// data, all relative to `folder`.
std::string report_text(const std::string& title, const std::string& introduction,
                        const std::vector<ReportSection>& sections, const std::filesystem::path& folder);

/// @throws InputError where a report in `folder` would replace files that hmax did not write, before anything
/// is computed
void check_report_place(const std::filesystem::path& folder);

/// Writes `report_text` to folder / README.md, and the same as `markdown_page` to folder / index.html.
/// @returns the index.html
/// @throws InputError when they cannot be written
std::filesystem::path write_report(const std::string& title, const std::string& introduction,
                                   const std::vector<ReportSection>& sections,
                                   const std::filesystem::path& folder);

}  // namespace hmax
