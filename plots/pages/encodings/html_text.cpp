#include "plots/pages/encodings/html_text.hpp"

#include "plots/gnuplot.hpp"

namespace hmax {

std::string html_text(std::string_view text) {
  std::string safe;
  for (const char c : one_line(text))
    safe += c == '<'   ? "&lt;"
            : c == '>' ? "&gt;"
            : c == '&' ? "&amp;"
            : c == '"' ? "&quot;"
                       : std::string(1, c);
  return safe;
}

}  // namespace hmax
