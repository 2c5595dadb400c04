/// A figure as one SVG text, for commands that write a single file.
#pragma once

#include <string>

#include "plots/figure.hpp"

namespace hmax {

struct DrawnSvg {
  std::string svg{};      ///< with the mark of files of hmax; empty where it could not be drawn
  std::string alt{};      ///< what is seen, in words
  std::string problem{};  ///< why not, one sentence with the remedy; else empty
};

/// By gnuplot, in a folder of its own that does not stay.
/// @param name  as of draw(): letters, digits, '_', '-'
DrawnSvg drawn_svg(const Figure& figure, const std::string& name);

}  // namespace hmax
