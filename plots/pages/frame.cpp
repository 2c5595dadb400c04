#include "plots/pages/frame.hpp"

#include <fmt/format.h>

#include "core/own_files.hpp"
#include "plots/pages/page_texts.hpp"
#include "plots/svg.hpp"

namespace hmax {

namespace {

std::string navigation(const std::vector<PageLink>& links) {
  if (links.size() < 2) return {};
  std::string html = "<nav aria-label=\"Sections\">\n";
  for (const auto& [target, text] : links)
    html += fmt::format("<a href=\"{}\">{}</a>\n", html_text(target), html_text(text));
  return html + "</nav>\n";
}

}  // namespace

std::string_view page_style(std::string_view name) { return text_of(page_styles(), name); }
std::string_view page_script(std::string_view name) { return text_of(page_scripts(), name); }

std::string framed_page(const PageFrame& frame) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<!-- {} -->\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>{}</title>\n<style>\n{}{}</style>\n</head>\n<body>\n",
      own_mark, html_text(frame.title), page_style("page"), frame.style);
  html +=
      fmt::format("<header>\n<h1>{}</h1>\n<button type=\"button\" id=\"theme\" hidden></button>\n</header>\n",
                  html_text(frame.title));
  html += frame.introduction + navigation(frame.links);
  html += "<main>\n" + frame.main + "</main>\n";
  if (!frame.footer.empty()) html += fmt::format("<footer>{}</footer>\n", frame.footer);
  html += fmt::format("{}<script>\n{}{}{}</script>\n", frame.data, page_script("theme"),
                      page_script("sort_tables"), frame.script);
  return html + "</body>\n</html>\n";
}

}  // namespace hmax
