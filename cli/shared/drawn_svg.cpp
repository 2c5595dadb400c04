#include "cli/shared/drawn_svg.hpp"

#include <fstream>
#include <iterator>
#include <utility>

#include "core/errors.hpp"
#include "core/own_files.hpp"
#include "core/process/temporary_folder.hpp"
#include "plots/draw.hpp"
#include "plots/gnuplot.hpp"

namespace hmax {

DrawnSvg drawn_svg(const Figure& figure, const std::string& name) {
  if (!gnuplot_available())
    return {.problem = "gnuplot is not installed; apt-get install gnuplot-nox, then ask again"};
  try {
    const TemporaryFolder folder;
    const FigureFiles made = draw(figure, folder.path(), name);
    if (!made.drawn()) return {.problem = made.problem};
    std::ifstream in(made.base.string() + ".svg", std::ios::binary);
    std::string svg{std::istreambuf_iterator<char>(in), {}};
    // Behind the line that says it is XML.
    svg.insert(svg.find('\n') + 1, "<!-- " + std::string(own_mark) + " -->\n");
    return {.svg = std::move(svg), .alt = made.alt};
  } catch (const InputError& error) {
    return {.problem = error.what()};
  }
}

}  // namespace hmax
