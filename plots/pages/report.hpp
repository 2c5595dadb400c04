/// A folder of figures with a page that shows them, as Markdown and as HTML.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plots/draw.hpp"
#include "results/table.hpp"

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

/// `text` with the characters that Markdown and HTML would take for their own escaped, on one line.
std::string markdown_text(std::string_view text);

/// A table in Markdown, of rows of equal length, the first of them headings. Columns with digits are flush
/// right, but for the first.
std::string markdown_table(const std::vector<std::vector<std::string>>& rows);
/// Numbers with up to six significant digits, NaN as a dash.
std::string markdown_table(const Table& table);

std::string markdown_list(const std::vector<std::string>& items);
/// Names and words; what has no name goes on with the last.
std::string markdown_facts(const std::vector<std::pair<std::string, std::string>>& facts);

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
