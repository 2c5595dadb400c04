#include "plots/pages/page.hpp"

#include <string_view>

#include <fmt/format.h>

#include "core/own_files.hpp"
#include "plots/pages/base64.hpp"
#include "plots/pages/html_text.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

constexpr std::string_view style =
    "body{font:16px/1.5 sans-serif;color:#202020;background:#fff;max-width:940px;margin:2rem auto;"
    "padding:0 1rem}"
    "h1{font-size:1.7rem}h2{font-size:1.3rem;margin-top:3rem;border-bottom:1px solid #d4d4d4}"
    "figure{margin:1.5rem 0}img{max-width:100%;height:auto}figcaption{color:#606060;font-size:.9rem}"
    "table{border-collapse:collapse;font-size:.85rem;display:block;overflow-x:auto}"
    "th,td{padding:.15rem .4rem;text-align:right;vertical-align:top;border-bottom:1px solid #e4e4e4;white-space:nowrap}"
    "th:first-child,td:first-child{text-align:left;padding-left:0;white-space:normal}"
    ".words{text-align:left}"
    ".facts th,.facts td{font-size:1rem;text-align:left;white-space:normal}.facts th{min-width:6.5rem}"
    "nav{columns:2}nav a{display:block;color:#0072b2}"
    "@media print{body{margin:0;max-width:none;padding:0;font-size:11pt}nav{display:none}h2{margin-top:1.5rem}"
    "h1,h2{break-after:avoid}figure,tr{break-inside:avoid}table{display:table;font-size:.65rem}"
    "th,td{padding:.1rem .35rem}th{white-space:normal}.facts th,.facts td{font-size:.9rem}}";

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

std::string html_of(const std::vector<std::vector<std::string>>& table) {
  if (table.empty()) return {};
  const std::vector<bool> words = columns_of_words(table);
  std::string html = "<table>\n";
  for (std::size_t row = 0; row < table.size(); ++row) {
    html += "<tr>";
    for (std::size_t column = 0; column < table[row].size(); ++column)
      html += fmt::format("<{0}{1}{2}>{3}</{0}>", row == 0 ? "th" : "td", row == 0 ? " scope=\"col\"" : "",
                          words[column] ? " class=\"words\"" : "", html_text(table[row][column]));
    html += "</tr>\n";
  }
  return html + "</table>\n";
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
  return fmt::format(
      "<figure><img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\">"
      "<figcaption>{}</figcaption></figure>\n",
      html_text(picture.alt.empty() ? picture.caption : picture.alt), base64(picture.svg),
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
  return html + html_of(section.table);
}

}  // namespace

std::string page_text(const std::string& title, const std::string& introduction,
                      const std::vector<PageSection>& sections) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<!-- {3} -->\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{0}</title>\n"
      "<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n<p>{2}</p>\n<nav>\n",
      html_text(title), style, html_text(introduction), own_mark);
  for (std::size_t i = 0; i < sections.size(); ++i)
    html += fmt::format("<a href=\"#s{}\">{}</a>\n", i, html_text(sections[i].title));
  html += "</nav>\n";
  for (std::size_t i = 0; i < sections.size(); ++i)
    html += fmt::format("<h2 id=\"s{}\">{}</h2>\n", i, html_text(sections[i].title)) + html_of(sections[i]);
  return html + "</body>\n</html>\n";
}

void write_page(const std::filesystem::path& file, const std::string& text) { write_file(file, text); }

}  // namespace hmax
