#include "plots/pages/report.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/own_files.hpp"
#include "plots/draw.hpp"
#include "plots/pages/markdown_page.hpp"
#include "results/table.hpp"

namespace hmax {
namespace {

std::string figure_text(const FigureFiles& figure, const std::string& title,
                        const std::filesystem::path& folder) {
  const std::string base = figure.base.lexically_proximate(folder).generic_string();
  const std::string sources = fmt::format("[script]({0}.gp) · [data]({0}.dat)", base);
  if (!figure.drawn()) return fmt::format("_Not drawn: {}_ · {}\n\n", markdown_text(figure.problem), sources);
  const bool scripted = figure.made.empty() || std::ranges::any_of(figure.made, [](const auto& file) {
                          return file.extension() == ".gp";
                        });
  const std::string alt = markdown_text(figure.alt.empty() ? title : figure.alt);
  if (!scripted) return fmt::format("![{0}]({1}.svg)\n\n", alt, base);
  return fmt::format("[![{0}]({1}.png)]({1}.svg)\n\n[SVG]({1}.svg) · [PDF]({1}.pdf) · {2}\n\n", alt, base,
                     sources);
}

}  // namespace

std::string report_text(const std::string& title, const std::string& introduction,
                        const std::vector<ReportSection>& sections, const std::filesystem::path& folder) {
  std::string text = fmt::format("<!-- {} -->\n\n# {}\n\n", own_mark, title);
  if (!introduction.empty()) text += introduction + "\n\n";
  for (const ReportSection& section : sections) {
    text += "## " + section.title + "\n\n";
    if (!section.text.empty()) text += section.text + "\n\n";
    for (const FigureFiles& figure : section.figures) text += figure_text(figure, section.title, folder);
    for (const std::string& table : section.tables) text += table + "\n";
    if (!section.printed.empty()) text += "**The study printed:** " + section.printed + "\n\n";
    if (!section.differs.empty()) text += "**What differs:** " + section.differs + "\n\n";
  }
  text.pop_back();  // sections end with a blank line, the file with one newline
  return text;
}

void check_report_place(const std::filesystem::path& folder) {
  for (const char* file : {"README.md", "index.html"}) check_writable(folder / file);
}

std::filesystem::path write_report(const std::string& title, const std::string& introduction,
                                   const std::vector<ReportSection>& sections,
                                   const std::filesystem::path& folder) {
  const std::string text = report_text(title, introduction, sections, folder);
  write_file(folder / "README.md", text);
  std::filesystem::path page = folder / "index.html";
  write_file(page, markdown_page(text, folder));
  return page;
}

}  // namespace hmax
