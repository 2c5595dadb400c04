#include "plots/pages/page.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "plots/pages/encodings/base64.hpp"
#include "plots/pages/html_text.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

/// Of each column, whether it has words, as one without a digit has. The first is flush left anyway.
std::vector<bool> columns_of_words(const std::vector<std::vector<std::string>>& table) {
  constexpr std::string_view digits = "0123456789";
  std::vector<bool> words(table.front().size(), table.size() > 1);
  words[0] = false;
  for (std::size_t row = 1; row < table.size(); ++row)
    for (std::size_t column = 0; column < words.size(); ++column)
      if (table[row][column].find_first_of(digits) != std::string::npos) words[column] = false;
  return words;
}

std::string html_of(const std::vector<std::pair<std::string, std::string>>& facts) {
  if (facts.empty()) return {};
  std::string html = "<table class=\"facts\">\n";
  for (const auto& [name, words] : facts)
    html += fmt::format("<tr><{0}>{1}</{2}><td>{3}</td></tr>\n", name.empty() ? "td" : "th scope=\"row\"",
                        html_text(name), name.empty() ? "td" : "th", html_text(words));
  return html + "</table>\n";
}

std::string html_of(const PagePicture& picture) {
  if (picture.svg.empty())
    return fmt::format("<p>{}: not drawn. {}</p>\n", html_text(picture.caption), html_text(picture.problem));
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                     embedded_svg(picture.svg, picture.alt.empty() ? picture.caption : picture.alt),
                     html_text(picture.caption));
}

std::string html_of(const PageSection& section) {
  std::string html;
  if (!section.lead.empty()) html += fmt::format("<p><strong>{}</strong></p>\n", html_text(section.lead));
  if (!section.text.empty()) html += fmt::format("<p>{}</p>\n", html_text(section.text));
  html += html_of(section.facts);
  if (!section.list.empty()) {
    html += "<ul>\n";
    for (const std::string& item : section.list) html += fmt::format("<li>{}</li>\n", html_text(item));
    html += "</ul>\n";
  }
  for (const PagePicture& picture : section.pictures) html += html_of(picture);
  return html + table_html(section.table, section.title);
}

}  // namespace

std::string table_html(const std::vector<std::vector<std::string>>& table, const std::string& label) {
  if (table.empty()) return {};
  const std::vector<bool> words = columns_of_words(table);
  std::string html = scrolling_box(label) + "<table>\n<thead>\n";
  for (std::size_t row = 0; row < table.size(); ++row) {
    if (row == 1) html += "</thead>\n<tbody>\n";
    html += "<tr>";
    for (std::size_t column = 0; column < table[row].size(); ++column)
      html += fmt::format("<{0}{1}{2}>{3}</{0}>", row == 0 ? "th" : "td", row == 0 ? " scope=\"col\"" : "",
                          words[column] ? " class=\"words\"" : "", html_text(table[row][column]));
    html += "</tr>\n";
  }
  return html + (table.size() > 1 ? "</tbody>\n" : "</thead>\n") + "</table></div>\n";
}

std::string embedded_svg(std::string_view svg, const std::string& alt) {
  // The quotes that the text has fewer of are those that have to be replaced.
  const char quote = std::ranges::count(svg, '"') < std::ranges::count(svg, '\'') ? '"' : '\'';
  std::string text;
  text.reserve(svg.size() + svg.size() / 8);
  for (const char c : svg) {
    if (c == quote)
      text += c == '"' ? "&quot;" : "&#39;";
    else if (c == '&')
      text += "&amp;";
    else if (c == '#')
      text += "%23";
    else if (c == '%')
      text += "%25";
    else
      text += c == '\n' || c == '\r' || c == '\t' ? ' ' : c;
  }
  return fmt::format("<img alt=\"{}\" src={}data:image/svg+xml,{}{}>", html_text(alt), quote, text, quote);
}

std::string embedded_png(std::string_view png, const std::string& alt) {
  return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", html_text(alt), base64(png));
}

std::string packed_svg(std::string_view deflated, const std::string& alt) {
  return fmt::format("<img alt=\"{}\" data-packed=\"{}\">", html_text(alt), base64(deflated));
}

std::string sections_html(const std::vector<PageSection>& sections, std::size_t first) {
  std::string html;
  for (std::size_t i = 0; i < sections.size(); ++i)
    html += fmt::format("<section>\n<h2 id=\"s{}\">{}</h2>\n{}</section>\n", first + i,
                        html_text(sections[i].title), html_of(sections[i]));
  return html;
}

std::vector<PageLink> section_links(const std::vector<PageSection>& sections, std::size_t first) {
  std::vector<PageLink> links;
  for (const PageSection& section : sections)
    links.push_back({fmt::format("#s{}", first + links.size()), section.title});
  return links;
}

std::string page_text(const std::string& title, const std::string& introduction,
                      const std::vector<PageSection>& sections) {
  return framed_page({.title = title,
                      .introduction = fmt::format("<p>{}</p>\n", html_text(introduction)),
                      .links = section_links(sections),
                      .main = sections_html(sections)});
}

void write_page(const std::filesystem::path& file, const std::string& text) { write_file(file, text); }

}  // namespace hmax
