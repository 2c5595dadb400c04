#include "plots/pages/embedded.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/text/base64.hpp"
#include "plots/svg.hpp"

namespace hmax {

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
  return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", html_text(alt), encode_base64(png));
}

}  // namespace hmax
