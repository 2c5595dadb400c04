/// What pictures that write their own SVG share.
#pragma once

#include <string>
#include <string_view>

#include "plots/figure.hpp"

namespace hmax {

/// `text` on one line, as pages and pictures show it: what markup would take for its own is escaped.
std::string html_text(std::string_view text);

/// How a picture of this size in pixels begins: its style, and white ground.
/// @param style  rules of CSS
std::string svg_opening(double width, double height, std::string_view style);

/// A line of text at (x, y) in pixels. @param more  further attributes
std::string svg_text(double x, double y, const std::string& what, const std::string& more = "");

/// The distance of labelled ticks: 1, 2 or 5 times a power of ten, at most `most` of them.
double tick_of(Range range, int most);

}  // namespace hmax
