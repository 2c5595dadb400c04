#include "plots/pages/page.hpp"

#include <string_view>

#include <fmt/format.h>

#include "core/own_files.hpp"
#include "results/errors.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : text)
    safe += c == '<'   ? "&lt;"
            : c == '>' ? "&gt;"
            : c == '&' ? "&amp;"
            : c == '"' ? "&quot;"
                       : std::string(1, c);
  return safe;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? static_cast<unsigned>(static_cast<unsigned char>(bytes[i + k])) : 0U;
    };
    const unsigned group = byte(0) << 16U | byte(1) << 8U | byte(2);
    for (unsigned k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

constexpr std::string_view style =
    "body{font:16px/1.5 sans-serif;color:#202020;background:#fff;max-width:940px;margin:2rem auto;"
    "padding:0 1rem}"
    "h1{font-size:1.7rem}h2{font-size:1.3rem;margin-top:3rem;border-bottom:1px solid #d4d4d4}"
    "figure{margin:1.5rem 0}img{max-width:100%;height:auto}figcaption{color:#606060;font-size:.9rem}"
    "table{border-collapse:collapse;font-size:.85rem;display:block;overflow-x:auto}"
    "th,td{padding:.15rem .7rem;text-align:right;border-bottom:1px solid #e4e4e4;white-space:nowrap}"
    "th:first-child,td:first-child{text-align:left;padding-left:0}"
    "nav{columns:2}nav a{display:block;color:#0072b2}";

}  // namespace

std::string page_text(const std::string& title, const std::string& introduction,
                      const std::vector<PageSection>& sections) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<!-- {3} -->\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{0}</title>\n"
      "<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n<p>{2}</p>\n<nav>\n",
      escaped(title), style, escaped(introduction), own_mark);
  for (std::size_t i = 0; i < sections.size(); ++i)
    html += fmt::format("<a href=\"#s{}\">{}</a>\n", i, escaped(sections[i].title));
  html += "</nav>\n";
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const PageSection& section = sections[i];
    html += fmt::format("<h2 id=\"s{}\">{}</h2>\n", i, escaped(section.title));
    if (!section.text.empty()) html += fmt::format("<p>{}</p>\n", escaped(section.text));
    for (const PagePicture& picture : section.pictures) {
      if (picture.svg.empty()) {
        html += fmt::format("<p>{}: not drawn. {}</p>\n", escaped(picture.caption), escaped(picture.problem));
        continue;
      }
      html += fmt::format(
          "<figure><img alt=\"{0}\" src=\"data:image/svg+xml;base64,{1}\">"
          "<figcaption>{0}</figcaption></figure>\n",
          escaped(picture.caption), base64(picture.svg));
    }
    if (section.table.empty()) continue;
    html += "<table>\n";
    for (std::size_t row = 0; row < section.table.size(); ++row) {
      html += "<tr>";
      for (const std::string& cell : section.table[row])
        html += fmt::format("<{0}>{1}</{0}>", row == 0 ? "th" : "td", escaped(cell));
      html += "</tr>\n";
    }
    html += "</table>\n";
  }
  return html + "</body>\n</html>\n";
}

void write_page(const std::filesystem::path& file, const std::string& text) { write_file(file, text); }

}  // namespace hmax
