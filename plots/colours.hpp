/// The colours, dashes and markers of every figure.
#pragma once

#include <cstddef>
#include <string>

namespace hmax {

/// Colours of [okabe2008color] (without yellow, unreadable on white) by index; a curve is also told by dash
/// and marker, so the figure reads in grey. Indices wrap around.
struct Style {
  int colour = 0;  ///< 0 blue, 1 vermillion, 2 green, 3 purple, 4 orange, 5 sky blue, 6 black, 7 grey
  int dash = 0;    ///< 0 solid, 1 dashed, 2 dash-dot, 3 dotted, 4 long dashed
  int marker = 0;  ///< gnuplot's point type, 0 for none: 4/5 square, 6/7 circle, 8/9 triangle, 12/13 diamond
                   ///< (open/filled)
  double width = 1.8;
  double size = 1;     ///< of the marker
  bool light = false;  ///< a tint of the colour, as areas have it
};

/// An element of a palette; indices wrap around.
template <class Array>
auto wrapped(const Array& values, int index) {
  const int size = static_cast<int>(values.size());
  return values[static_cast<std::size_t>(((index % size) + size) % size)];
}

/// The full colour of a style, or its tint, "#0072b2".
const char* colour_of(const Style& style);

/// A colour by its index, mixed with white, "#b8d6e8": shade 0 is white, 1 the full colour.
std::string colour_name(int colour, double shade = 1);

/// The style of the k-th member of a family of curves: another colour and another dash each.
Style family_style(int k, bool markers = false);

}  // namespace hmax
