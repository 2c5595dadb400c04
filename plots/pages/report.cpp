#include "plots/pages/report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/own_files.hpp"
#include "plots/draw.hpp"
#include "plots/gnuplot.hpp"
#include "plots/pages/markdown_page.hpp"
#include "results/table.hpp"

namespace hmax {
namespace {

std::string cell(double value) {
  if (std::isnan(value)) return "–";
  return fmt::format("{:.6g}", value);
}

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

std::string markdown_text(std::string_view text) {
  std::string escaped;
  for (const char c : one_line(text)) {
    if (c == '<')
      escaped += "&lt;";
    else if (c == '&')
      escaped += "&amp;";
    else {
      if (std::string_view("\\`*_[]|>#!").find(c) != std::string_view::npos) escaped += '\\';
      escaped += c;
    }
  }
  return escaped;
}

std::string markdown_table(const std::vector<std::vector<std::string>>& rows) {
  const auto has_digit = [](const std::string& text) {
    return std::ranges::any_of(text, [](char c) { return c >= '0' && c <= '9'; });
  };
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::string& each : rows[i]) text += fmt::format("| {} ", markdown_text(each));
    text += "|\n";
    for (std::size_t k = 0; i == 0 && k < rows[0].size(); ++k) {
      const bool numbers =
          std::any_of(rows.begin() + 1, rows.end(),
                      [&](const std::vector<std::string>& row) { return has_digit(row[k]); });
      text += k > 0 && numbers ? "| ---: " : "| --- ";
    }
    if (i == 0) text += "|\n";
  }
  return text;
}

std::string markdown_table(const Table& table) {
  std::vector<std::vector<std::string>> rows{table.columns};
  for (std::size_t i = 0; !table.values.empty() && i < table.values[0].size(); ++i) {
    rows.emplace_back();
    for (const auto& column : table.values) rows.back().push_back(cell(column.at(i)));
  }
  return markdown_table(rows);
}

std::string markdown_list(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += fmt::format("- {}\n", markdown_text(item));
  return text + "\n";
}

std::string markdown_facts(const std::vector<std::pair<std::string, std::string>>& facts) {
  std::string text;
  for (const auto& [name, words] : facts)
    text += name.empty() ? fmt::format("  - {}\n", markdown_text(words))
                         : fmt::format("- **{}**: {}\n", markdown_text(name), markdown_text(words));
  return text + "\n";
}

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
