/// What a figure is made of, in the house style.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "plots/colours.hpp"

namespace hmax {

/// Points joined by a line and told by a label. Points that are not finite, or not positive on a logarithmic
/// axis, are left out; the line joins their neighbours.
struct Curve {
  std::string label = {};  ///< text in the key; curves of one label share one entry; empty: not in the key
  std::vector<double> x = {}, y = {};       ///< equal length
  std::vector<double> low = {}, high = {};  ///< empty, or the ends of a vertical bar per point
  std::vector<double> lost =
      {};  ///< x of runs that did not reach their end: marks in a strip at the top edge
  Style style = {};
  bool line = true;
  bool strokes = false;  ///< every two points are a line of their own
};

/// Arrows centred on (x, y), in the units of the axes.
struct Arrows {
  std::vector<double> x = {}, y = {}, dx = {}, dy = {};
};

/// Rectangles filled with a light tint of one colour, under everything else.
struct Area {
  std::string label = {};                              ///< text in the key; empty: not in the key
  std::vector<double> x = {}, y = {}, w = {}, h = {};  ///< centres and sizes, in the units of the axes
  int colour = 0;                                      ///< as Style::colour
};

/// A plane area with a rim of any shape, filled evenly under every curve; later ones cover earlier ones.
struct Fill {
  std::string label = {};  ///< text in the key; empty: not in the key
  /// Closed loops, each without its first point repeated. What lies inside of one that runs counter-clockwise
  /// is filled, what lies inside of a clockwise one is left out: a hole.
  std::vector<std::vector<std::array<double, 2>>> loops = {};
  int colour = 0;       ///< as Style::colour
  double shade = 0.28;  ///< of the colour: 0 white, 1 full
};

/// A point with a meaning of its own.
struct Mark {
  double x, y;
  Style style;
  std::string label = {};  ///< text in the key; marks of one label share one entry
  std::string name = {};   ///< text beside the mark
  bool ends = false;  ///< a line, whose name stands to the right; others' towards the middle of the panel
};

struct Range {
  double low, high;
};

struct Axis {
  std::string label = {};  ///< quantity and unit, "x [m]"
  bool logarithmic = false;
  std::optional<Range> range = {};  ///< computed from the points when absent
  /// Of a vertical axis: what stands at 1, 2, ... in the place of numbers, the panel being narrower for it.
  std::vector<std::string> names = {};
};

struct Panel {
  std::string title = {};
  Axis x = {}, y = {};
  std::vector<Curve> curves = {};
  std::vector<Mark> marks = {};
  Arrows arrows = {};
  std::vector<Area> areas = {};
  std::vector<Fill> fills = {};
  bool grid = true;                     ///< lines at the tics, which fills cover
  std::vector<std::string> notes = {};  ///< small lines under the title
  std::string lost_label = "diverged";  ///< what the strip of lost runs is called
};

/// Panels in rows, filled from the left, under one title, over one key.
struct Figure {
  std::string title = {};  ///< a short sentence: what is seen
  std::vector<Panel> panels = {};
  int columns = 1;
  std::string footer = {};  ///< method, tolerance, machine; small and grey, broken into lines
  int panel_height = 300;   ///< of the plotting area, in pixels
};

/// Where a figure is shown, which decides how large its text is beside it.
enum class FigureStyle {
  page,   ///< text of a page: a figure is 900 pixels wide
  slide,  ///< text half as large again: 600 pixels, at most two panels in a row
};

/// From now on. A program says so once, at its start or by an option.
void set_figure_style(FigureStyle style);
FigureStyle figure_style();

/// What a figure is laid out on, and what stands left and right of the plotting area of each panel [pixels].
double figure_width();
inline constexpr double left_margin = 74, right_margin = 20;

/// The columns that a figure gets which asks for so many.
int columns_of(int asked);

/// The width of the plotting area of each of `columns` panels, in the pixels that panel_height counts; of
/// a slide, that of the columns that it has.
double panel_width(int columns);

/// The id of a problem for a title: a mesh file without its folders.
std::string title_of(const std::string& problem);

}  // namespace hmax
