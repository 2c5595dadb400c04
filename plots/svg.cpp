#include "plots/svg.hpp"

#include <cmath>

#include <fmt/format.h>

#include "core/own_files.hpp"
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

std::string svg_opening(double width, double height, std::string_view style) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\" font-family=\"sans-serif\" font-size=\"13\">\n<!-- {2} -->\n<style>{3}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      width, height, own_mark, style);
}

std::string svg_text(double x, double y, const std::string& what, const std::string& more) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, more, html_text(what));
}

double tick_of(Range range, int most) {
  double step = std::pow(10, std::floor(std::log10((range.high - range.low) / most)));
  for (const double factor : {2.0, 2.5, 2.0})
    if ((range.high - range.low) / step > most) step *= factor;
  return step;
}

}  // namespace hmax
