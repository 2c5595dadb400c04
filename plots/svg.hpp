/// What pictures that write their own SVG share.
#pragma once

#include <string>

#include "plots/figure.hpp"

namespace hmax {

/// Any text as content or attribute of an element, on one line.
std::string svg_escaped(const std::string& text);

/// A line of text at (x, y) in pixels. @param more  further attributes
std::string svg_text(double x, double y, const std::string& what, const std::string& more = "");

/// The distance of labelled ticks: 1, 2 or 5 times a power of ten, at most `most` of them.
double tick_of(Range range, int most);

}  // namespace hmax
