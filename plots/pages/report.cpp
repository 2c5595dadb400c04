#include "plots/pages/report.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/own_files.hpp"
#include "plots/draw.hpp"
#include "plots/pages/markdown_page.hpp"

namespace hmax {
std::string figure_markdown(const FigureFiles& figure, const std::filesystem::path& folder) {
  const std::string base = figure.base.lexically_proximate(folder).generic_string();
  const std::string sources = fmt::format("[script]({0}.gp) · [data]({0}.dat)", base);
  if (!figure.drawn()) return fmt::format("_Not drawn: {}_ · {}", markdown_text(figure.problem), sources);
  const bool scripted = figure.made.empty() || std::ranges::any_of(figure.made, [](const auto& file) {
                          return file.extension() == ".gp";
                        });
  const std::string alt = markdown_text(figure.alt);
  if (!scripted) return fmt::format("![{0}]({1}.svg)", alt, base);
  return fmt::format("[![{0}]({1}.png)]({1}.svg)\n\n[SVG]({1}.svg) · [PDF]({1}.pdf) · {2}", alt, base,
                     sources);
}

void check_report_place(const std::filesystem::path& folder) {
  for (const char* file : {"README.md", "index.html"}) check_writable(folder / file);
}

std::filesystem::path write_report(const std::string& text, const std::filesystem::path& folder) {
  const std::string marked = fmt::format("<!-- {} -->\n\n{}", own_mark, text);
  write_file(folder / "README.md", marked);
  std::filesystem::path page = folder / "index.html";
  write_file(page, markdown_page(marked, folder));
  return page;
}

}  // namespace hmax
