#include "plots/draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <mutex>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/own_files.hpp"
#include "plots/alt_text.hpp"
#include "plots/gnuplot.hpp"
#include "plots/tics.hpp"
#include "results/table.hpp"

namespace hmax {
namespace {

// Lengths are pixels; y counts from the top.
constexpr double tallest_slide_panel = 325;
constexpr double png_width = 1800;
constexpr double below_panel = 56;
constexpr double title_line = 22, below_title = 18, panel_title_height = 26, note_height = 15, key_row = 19,
                 footer_height = 24, footer_line = 13;
constexpr double title_character = 8.8, footer_character = 6.2, label_character = 7;  // mean widths
constexpr double label_line = 16;
constexpr double key_sample = 34;  // length of the line sample in the key
constexpr double character = 7.1;  // mean width of a character of the key's font
constexpr double lost_cell = 10;   // width and height given to a mark in the strip of lost runs
constexpr std::size_t longest_label = 44;

constexpr std::array dashes{"1", "(9,4)", "(12,4,2,4)", "(2,4)", "(18,5)"};

std::string line_of(const Style& style) {
  return fmt::format("lc rgb '{}' lw {} dt {}", colour_of(style), style.width, wrapped(dashes, style.dash));
}
std::string point_of(const Style& style, double size = 0.75) {
  return fmt::format("pt {} ps {} lc rgb '{}'", style.marker, size * style.size, colour_of(style));
}

bool drawable(double value, const Axis& axis) {
  return std::isfinite(value) && (!axis.logarithmic || value > 0);
}

/// A range in the coordinate in which the axis is even: log10 of a logarithmic axis.
struct Even {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void include(double value, const Axis& axis) {
    if (!drawable(value, axis)) return;
    const double even = axis.logarithmic ? std::log10(value) : value;
    low = std::min(low, even);
    high = std::max(high, even);
  }
};

/// The range of an axis over `points`, with a margin on both sides; [0, 1] or [1, 10] when nothing can be
/// drawn.
Range range_of(const Axis& axis, Even points, double margin) {
  if (axis.range) return *axis.range;
  if (!(points.low <= points.high)) points = {0, 1};
  double widen = margin * (points.high - points.low);
  if (!(points.high > points.low))
    widen = axis.logarithmic ? 0.5 : std::max(1e-12, 0.1 * std::abs(points.high));
  const double low = points.low - widen, high = points.high + widen;
  return axis.logarithmic ? Range{std::pow(10, low), std::pow(10, high)} : Range{low, high};
}

/// One entry of the key.
struct Entry {
  std::string label;
  Style style;
  bool line;
  std::string fill = {};  ///< the colour of a filled sample, where it is one
};

std::vector<Entry> key_of(const Figure& figure) {
  std::vector<Entry> entries;
  const auto add = [&](const std::string& label, const Style& style, bool line,
                       const std::string& fill = {}) {
    const bool known =
        std::any_of(entries.begin(), entries.end(), [&](const Entry& e) { return e.label == label; });
    if (!label.empty() && !known) entries.push_back({label, style, line, fill});
  };
  for (const Panel& panel : figure.panels)
    for (const Curve& curve : panel.curves) add(curve.label, curve.style, curve.line);
  for (const Panel& panel : figure.panels)
    for (const Mark& mark : panel.marks) add(mark.label, mark.style, false);
  for (const Panel& panel : figure.panels)
    for (const Area& area : panel.areas)
      add(area.label, {.colour = area.colour, .marker = 5, .size = 1.4, .light = true}, false);
  for (const Panel& panel : figure.panels)
    for (const Fill& fill : panel.fills)
      add(fill.label, {.marker = 5, .size = 1.4}, false, colour_name(fill.colour, fill.shade));
  return entries;
}

/// Where a value lies on its axis: 0 at the low end, 1 at the high end.
double fraction(double value, const Axis& axis, const Range& range) {
  return axis.logarithmic ? std::log(value / range.low) / std::log(range.high / range.low)
                          : (value - range.low) / (range.high - range.low);
}

/// A mark in the strip of lost runs, in fractions of the panel.
struct Lost {
  double x, y;
  Style style;
};

/// Everything about a panel that follows from its content.
struct Extent {
  Range x, y;
  double strip = 0;    ///< share of the height taken by the strip of lost runs
  double end_of_tics;  ///< y under the strip
  std::vector<Lost> lost;
};

/// Lays the lost runs of one x out as rows of marks centred on it, as many a row as fit before the next x.
void lay_out_lost(const Panel& panel, double panel_width, double panel_height, Extent& extent) {
  std::map<double, std::vector<Style>> at;  // keyed by the fraction of the width
  for (const Curve& curve : panel.curves)
    for (const double lost : curve.lost)
      if (drawable(lost, panel.x)) at[fraction(lost, panel.x, extent.x)].push_back(curve.style);
  double nearest = 4 * lost_cell / panel_width;
  for (auto here = at.begin(); here != at.end() && std::next(here) != at.end(); ++here)
    nearest = std::min(nearest, std::next(here)->first - here->first);
  const auto per_row =
      static_cast<std::size_t>(std::max(1.0, std::floor(nearest * panel_width / lost_cell + 1e-9)));
  std::size_t rows = 0;
  for (const auto& [x, styles] : at) rows = std::max(rows, (styles.size() + per_row - 1) / per_row);
  if (rows == 0) return;
  extent.strip = std::min(0.5, (lost_cell * static_cast<double>(rows) + 10) / panel_height);
  for (const auto& [x, styles] : at)
    for (std::size_t i = 0; i < styles.size(); ++i) {
      const std::size_t row = i / per_row, in_row = std::min(per_row, styles.size() - row * per_row);
      const double offset = static_cast<double>(i % per_row) - (static_cast<double>(in_row) - 1) / 2;
      const double down = (lost_cell * (static_cast<double>(row) + 0.5) + 5) / panel_height;
      extent.lost.push_back({x + offset * lost_cell / panel_width, 1 - down, styles[i]});
    }
}

Extent extent_of(const Panel& panel, double panel_width, double panel_height) {
  Even x, y;
  bool markers = false;
  std::size_t most_lost = 0;
  for (const Curve& curve : panel.curves) {
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (!drawable(curve.x[i], panel.x) || !drawable(curve.y[i], panel.y)) continue;
      x.include(curve.x[i], panel.x);
      y.include(curve.y[i], panel.y);
      if (curve.low.empty()) continue;
      y.include(curve.low[i], panel.y);
      y.include(curve.high[i], panel.y);
    }
    for (const double lost : curve.lost) x.include(lost, panel.x);
    markers = markers || curve.style.marker != 0;
    most_lost += curve.lost.size();
  }
  for (const Area& area : panel.areas)
    for (std::size_t i = 0; i < area.x.size(); ++i)
      for (const double side : {-0.5, 0.5}) {
        x.include(area.x[i] + side * area.w[i], panel.x);
        y.include(area.y[i] + side * area.h[i], panel.y);
      }
  for (const Fill& fill : panel.fills)
    for (const auto& loop : fill.loops)
      for (const auto& [at_x, at_y] : loop) {
        x.include(at_x, panel.x);
        y.include(at_y, panel.y);
      }
  for (const Mark& mark : panel.marks) {
    x.include(mark.x, panel.x);
    y.include(mark.y, panel.y);
  }
  Extent extent;
  // Room for half a row of marks beside an outermost lost run.
  extent.x = range_of(panel.x, x,
                      most_lost > 1                     ? 2 * lost_cell / panel_width
                      : markers || !panel.marks.empty() ? 0.04
                                                        : 0);
  extent.y = range_of(panel.y, y, 0.06);
  extent.end_of_tics = extent.y.high;
  lay_out_lost(panel, panel_width, panel_height, extent);
  // Lift the upper end so that every curve ends below the strip.
  const double stretch = 1 / (1 - extent.strip);
  auto& [low, high] = extent.y;
  high = panel.y.logarithmic ? low * std::pow(high / low, stretch) : low + (high - low) * stretch;
  return extent;
}

/// What the names of an axis take beside the room that its numbers have [pixels].
double room_for_names(const Axis& axis) {
  constexpr double label_and_gaps = 46;
  std::size_t longest = 0;
  for (const std::string& name : axis.names) longest = std::max(longest, length_of(name));
  if (longest == 0) return 0;
  const auto shown = static_cast<double>(std::min(longest, longest_label));
  return std::max(0.0, character * shown + label_and_gaps - left_margin);
}

std::size_t characters(double pixels, double each) { return static_cast<std::size_t>(pixels / each); }

/// The text being written: script and data grow together, a block of data has the number by which the script
/// asks for it.
class Writer {
 public:
  Writer(const Figure& figure, const std::string& name) : figure_(figure), name_(name) {}

  FigureSource write() {
    layout();
    header();
    for (std::size_t i = 0; i < figure_.panels.size(); ++i) panel(figure_.panels[i], i);
    footer();
    return {script_, data_};
  }

 private:
  /// Heights of rows and of the whole, the rows of the key.
  void layout() {
    const auto columns = static_cast<std::size_t>(columns_);
    title_ = lines_of(one_line(figure_.title), characters(width_ - 32, title_character));
    double y = title_.empty() ? 8 : below_title + title_line * static_cast<double>(title_.size());
    for (std::size_t first = 0; first < figure_.panels.size(); first += columns) {
      std::size_t notes = 0;
      bool titled = false;
      std::size_t label_lines = 1;
      for (std::size_t i = first; i < std::min(first + columns, figure_.panels.size()); ++i) {
        notes = std::max(notes, figure_.panels[i].notes.size());
        titled = titled || !figure_.panels[i].title.empty();
        label_lines = std::max(label_lines, x_label(figure_.panels[i]).size());
      }
      y += (titled ? panel_title_height : 8) + note_height * static_cast<double>(notes);
      tops_.push_back(y);
      y += panel_height_ + below_panel + label_line * static_cast<double>(label_lines - 1);
    }
    key_ = key_of(figure_);
    std::size_t longest = 1;
    for (Entry& entry : key_) {
      entry.label = shortened(one_line(entry.label), longest_label);
      longest = std::max(longest, length_of(entry.label));
    }
    key_width_ = key_sample + 26 + character * static_cast<double>(longest);
    const auto most = std::clamp<std::size_t>(characters(width_ - 40, key_width_), 1, 6);
    key_rows_ = (key_.size() + most - 1) / most;
    key_top_ = y + 4;
    height_ = std::ceil(key_top_ + key_row * static_cast<double>(key_rows_) + footer_height);
    footer_ = lines_of(figure_.footer, characters(width_, footer_character));
    if (footer_.size() > 1) height_ += footer_line * static_cast<double>(footer_.size() - 1);
  }

  /// The label of the x axis in lines that no neighbour's label meets.
  std::vector<std::string> x_label(const Panel& panel) const {
    return lines_of(one_line(panel.x.label), characters(width_ / columns_ - 12, label_character));
  }

  double across(double x) const { return x / width_; }
  double up(double y) const { return 1 - y / height_; }

  void header() {
    const double scale = png_width / width_;
    script_ = fmt::format(
        "# Draws {0}.svg, {0}.png and {0}.pdf from {0}.dat: run `gnuplot {0}.gp` in this folder.\n"
        "reset\n"
        "if (!exists('pass')) pass = 1\n"
        "if (pass == 1) set terminal svg size {1},{2} font 'sans-serif,12' background '#ffffff' enhanced\n"
        "if (pass == 2) set terminal pngcairo size {3},{4} font 'sans-serif,12' fontscale {8} linewidth {9} "
        "pointscale {9} background '#ffffff' enhanced\n"
        "if (pass == 3) set terminal pdfcairo size {5}in,{6}in font 'sans-serif,12' fontscale 0.54 linewidth "
        "1 "
        "pointscale 0.72 background '#ffffff' enhanced\n"
        "set output {7}.word('svg png pdf', pass)\n"
        "# The svg terminal takes a font's weight only from enhanced text, which labels with underscores "
        "cannot be.\n"
        "bold = pass == 1 ? 'sans-serif' : 'sans-serif:Bold'\n"
        "set encoding utf8\n"
        "set style fill solid 1 noborder\n"
        "unset key\n"
        "set bars 0.4\n"
        "set border 3 lc rgb '#606060' lw 0.8\n"
        "set style line 100 lc rgb '#d4d4d4' lw 0.6 dt 1\n"
        "set multiplot\n",
        name_, width_, height_, png_width, std::ceil(scale * height_), width_ / 100, height_ / 100,
        gnuplot_string(name_ + "."), 0.75 * scale, scale);
  }

  void label(std::string_view text, double x, double y, std::string_view font, std::string_view more = "") {
    script_ += fmt::format("set label {} at screen {:.5f},{:.5f} font {} noenhanced {}\n",
                           gnuplot_string(text), across(x), up(y), font, more);
  }

  /// The plotting area of a panel [pixels].
  struct Place {
    double left, right, top, bottom;
  };

  std::string source(int number) const { return fmt::format("'{}.dat' index {}", name_, number); }

  void panel(const Panel& panel, std::size_t index);
  void headings(const Panel& panel, const Place& place);
  void axes(const Panel& panel, const Place& place, const Extent& extent);
  void strip_of_lost(const Panel& panel, const Extent& extent);
  void plot(const Area& area);
  void plot(const Fill& fill, const Panel& panel);
  void plot(const Arrows& arrows);
  void plot(const Curve& curve, const Panel& panel, const Place& place, const Extent& extent);
  void plot(const Mark& mark, const Panel& panel);
  void name(const std::vector<Mark>& marks, const Panel& panel, const Place& place, const Extent& extent);
  std::vector<std::array<double, 4>> rows_of(const Curve& curve, const Panel& panel, const Place& place,
                                             const Extent& extent) const;
  void key();
  void footer();
  int block(const std::string& comment, const std::vector<std::array<double, 4>>& rows, int columns);

  const Figure& figure_;
  const std::string& name_;
  double width_ = figure_width();
  double panel_height_ = figure_style() == FigureStyle::slide
                             ? std::min<double>(figure_.panel_height, tallest_slide_panel)
                             : figure_.panel_height;
  int columns_ = columns_of(figure_.columns);
  std::string script_, data_;
  std::vector<std::string> plots_;  // of the panel at hand
  int blocks_ = 0;
  double height_ = 0, key_top_ = 0, key_width_ = 0;
  std::vector<std::string> title_, footer_;
  std::size_t key_rows_ = 0;
  std::vector<Entry> key_;
  std::vector<double> tops_;
};

/// Appends a block of `columns` columns and returns its number. A row of NaN is an empty line, which ends a
/// line of the drawing.
int Writer::block(const std::string& comment, const std::vector<std::array<double, 4>>& rows, int columns) {
  if (blocks_ > 0) data_ += "\n\n";
  data_ += "# " + one_line(comment) + "\n";
  for (const auto& row : rows) {
    for (int i = 0; i < columns && !std::isnan(row[0]); ++i)
      data_ += fmt::format("{}{}", i == 0 ? "" : " ", row[static_cast<std::size_t>(i)]);
    data_ += "\n";
  }
  return blocks_++;
}

void Writer::panel(const Panel& panel, std::size_t index) {
  const auto column = static_cast<double>(index % static_cast<std::size_t>(columns_));
  const double left = width_ / columns_ * column + left_margin;
  const double top = tops_[index / static_cast<std::size_t>(columns_)];
  Place place{left + room_for_names(panel.y), left + panel_width(columns_), top, top + panel_height_};
  const Extent extent = extent_of(panel, place.right - place.left, panel_height_);
  place.right -= std::max(0.0, overhang(panel.x, extent.x, place.right - place.left) - right_margin);
  script_ += "\nunset label\nunset object\n";
  for (std::size_t i = 0; index == 0 && i < title_.size(); ++i)
    label(title_[i], 16, 20 + title_line * static_cast<double>(i), "bold.',16'");
  headings(panel, place);
  axes(panel, place, extent);
  if (extent.strip > 0) strip_of_lost(panel, extent);
  plots_.clear();
  for (const Area& area : panel.areas) plot(area);
  for (const Fill& fill : panel.fills) plot(fill, panel);
  if (!panel.arrows.x.empty()) plot(panel.arrows);
  for (const Curve& curve : panel.curves) plot(curve, panel, place, extent);
  for (const Mark& mark : panel.marks) plot(mark, panel);
  name(panel.marks, panel, place, extent);
  if (index + 1 == figure_.panels.size()) key();
  script_ += "plot ";
  if (plots_.empty()) plots_.emplace_back("NaN");
  for (std::size_t i = 0; i < plots_.size(); ++i)
    script_ += (i == 0 ? "" : ", \\\n     ") + plots_[i] + " notitle";
  script_ += "\n";
}

/// Title and notes of a panel, above it.
void Writer::headings(const Panel& panel, const Place& place) {
  const double wide = place.right - place.left;
  const double notes = note_height * static_cast<double>(panel.notes.size());
  if (!panel.title.empty())
    label(shortened(one_line(panel.title), characters(wide, 8.4)), place.left, place.top - notes - 13,
          "bold.',13'");
  for (std::size_t i = 0; i < panel.notes.size(); ++i)
    label(shortened(one_line(panel.notes[i]), characters(wide, 6.2)), place.left,
          place.top - notes + note_height * static_cast<double>(i) + 4, "'sans-serif,11'",
          "tc rgb '#404040'");
}

void Writer::axes(const Panel& panel, const Place& place, const Extent& extent) {
  const auto& [left, right, top, bottom] = place;
  script_ += fmt::format("set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n", across(left),
                         across(right));
  script_ += fmt::format("set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n", up(top), up(bottom));
  const std::vector<std::string> x_lines = x_label(panel);
  script_ += fmt::format("set xlabel {} noenhanced offset 0,0.3\n",
                         gnuplot_string(x_lines.empty() ? "" : x_lines[0]));
  for (std::size_t i = 1; i < x_lines.size(); ++i)
    label(x_lines[i], (left + right) / 2, bottom + 45 + label_line * static_cast<double>(i),
          "'sans-serif,12'", "center");
  script_ += "unset ylabel\n";
  script_ += panel.grid ? "set grid ls 100\n" : "unset grid\n";
  label(panel.y.label, left - room_for_names(panel.y) - left_margin + 14, (top + bottom) / 2,
        "'sans-serif,12'", "center rotate by 90");
  for (std::size_t i = 0; i < panel.y.names.size(); ++i) {
    const double at = fraction(static_cast<double>(i + 1), panel.y, extent.y);
    label(shortened(one_line(panel.y.names[i]), longest_label), left - 10, bottom - at * (bottom - top),
          "'sans-serif,12'", "right");
  }
  script_ += panel.x.logarithmic ? "set logscale x\n" : "unset logscale x\n";
  script_ += panel.y.logarithmic ? "set logscale y\n" : "unset logscale y\n";
  script_ += drawn_range('x', panel.x, extent.x) + drawn_range('y', panel.y, extent.y);
  script_ += tics('x', panel.x, extent.x, right - left);
  script_ += tics('y', panel.y, {extent.y.low, extent.end_of_tics}, panel_height_);
}

void Writer::strip_of_lost(const Panel& panel, const Extent& extent) {
  script_ += fmt::format(
      "set object rectangle from graph 0,{:.5f} to graph 1,1 fc rgb '#f1f1f1' fs solid 1 noborder behind\n",
      1 - extent.strip);
  script_ +=
      fmt::format("set label {} at graph 0.01,{:.5f} font 'sans-serif,11' tc rgb '#606060' noenhanced\n",
                  gnuplot_string(panel.lost_label), 1 - extent.strip / 2);
  for (const Lost& lost : extent.lost) {
    Style style = lost.style;
    if (style.marker == 0) style.marker = 2;
    script_ +=
        fmt::format("set label '' at graph {:.5f},{:.5f} point {}\n", lost.x, lost.y, point_of(style, 0.7));
  }
}

void Writer::plot(const Area& area) {
  std::vector<std::array<double, 4>> rows;
  for (std::size_t i = 0; i < area.x.size(); ++i)
    rows.push_back({area.x[i], area.y[i], area.w[i] / 2, area.h[i] / 2});
  if (rows.empty()) return;
  plots_.push_back(source(block(fmt::format("{}: x, y, half width, half height", area.label), rows, 4)) +
                   fmt::format(" using 1:2:3:4 with boxxyerror fs solid 1 noborder lc rgb '{}'",
                               colour_of({.colour = area.colour, .light = true})));
}

void Writer::plot(const Fill& fill, const Panel& panel) {
  // One path for all loops: every later one is reached from the start of the first and left to it again,
  // and what is gone along twice encloses nothing.
  std::vector<std::array<double, 4>> rows;
  for (const auto& loop : fill.loops) {
    if (loop.size() < 3) continue;
    for (const auto& [x, y] : loop) rows.push_back({x, y, 0, 0});
    rows.push_back({loop.front()[0], loop.front()[1], 0, 0});
    if (rows.size() > loop.size() + 1) rows.push_back(rows.front());
  }
  if (rows.empty()) return;
  plots_.push_back(source(block(fmt::format("{} | {}: area, x, y", panel.title, fill.label), rows, 2)) +
                   fmt::format(" using 1:2 with filledcurves closed fs solid 1 noborder fc rgb '{}'",
                               colour_name(fill.colour, fill.shade)));
}

void Writer::plot(const Arrows& arrows) {
  std::vector<std::array<double, 4>> rows;
  for (std::size_t i = 0; i < arrows.x.size(); ++i)
    rows.push_back({arrows.x[i], arrows.y[i], arrows.dx[i], arrows.dy[i]});
  plots_.push_back(source(block("direction field: x, y, dx, dy", rows, 4)) +
                   " using ($1-$3/2):($2-$4/2):3:4 with vectors head filled size screen 0.006,18 lc rgb "
                   "'#b4b4b4' lw 0.8");
}

/// What is drawn of a curve: x, y and the ends of its bars. A row of NaN ends a line.
std::vector<std::array<double, 4>> Writer::rows_of(const Curve& curve, const Panel& panel, const Place& place,
                                                   const Extent& extent) const {
  std::vector<std::array<double, 4>> rows;
  const bool bars = !curve.low.empty();
  // A line without markers needs no two points nearer than a quarter of a pixel.
  const auto pixel = [&](const std::array<double, 4>& row) {
    return std::pair(fraction(row[0], panel.x, extent.x) * (place.right - place.left),
                     fraction(row[1], panel.y, extent.y) * panel_height_);
  };
  std::pair last(0.0, 0.0);
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!drawable(curve.x[i], panel.x) || !drawable(curve.y[i], panel.y)) continue;
    const double low = bars && drawable(curve.low[i], panel.y) ? curve.low[i] : curve.y[i];
    const double high = bars && drawable(curve.high[i], panel.y) ? curve.high[i] : curve.y[i];
    const std::array<double, 4> row{curve.x[i], curve.y[i], low, high};
    const auto here = pixel(row);
    if (curve.strokes && i % 2 == 0 && !rows.empty()) rows.push_back({NAN, NAN, NAN, NAN});
    const bool hidden = !curve.strokes && curve.style.marker == 0 && !rows.empty() &&
                        i + 1 < curve.x.size() &&
                        std::hypot(here.first - last.first, here.second - last.second) < 0.25;
    if (hidden) continue;
    // A line across a lost run would show a result that is not there.
    const bool lost_between = !rows.empty() && std::ranges::any_of(curve.lost, [&](double lost) {
      return std::min(rows.back()[0], row[0]) < lost && lost < std::max(rows.back()[0], row[0]);
    });
    if (lost_between) rows.push_back({NAN, NAN, NAN, NAN});
    rows.push_back(row);
    last = here;
  }
  return rows;
}

void Writer::plot(const Curve& curve, const Panel& panel, const Place& place, const Extent& extent) {
  const std::vector<std::array<double, 4>> rows = rows_of(curve, panel, place, extent);
  if (rows.empty()) return;
  const bool bars = !curve.low.empty();
  const std::string from = source(block(fmt::format("{} | {} | {}: {}, {}", panel.title, curve.label,
                                                    panel.x.label, panel.y.label, bars ? "low, high" : ""),
                                        rows, bars ? 4 : 2));
  if (bars)
    plots_.push_back(
        fmt::format("{} using 1:2:3:4 with yerrorbars pt 0 lw 1 lc rgb '{}'", from, colour_of(curve.style)));
  if (curve.line) plots_.push_back(from + " using 1:2 with lines " + line_of(curve.style));
  if (curve.style.marker != 0) plots_.push_back(from + " using 1:2 with points " + point_of(curve.style));
}

void Writer::plot(const Mark& mark, const Panel& panel) {
  if (!drawable(mark.x, panel.x) || !drawable(mark.y, panel.y)) return;
  const std::string from = source(block(mark.label, {{mark.x, mark.y, 0, 0}}, 2));
  // A white rim keeps the mark apart from the curves under it.
  plots_.push_back(from + " using 1:2 with points pt 7 ps 1.7 lc rgb '#ffffff'");
  plots_.push_back(from + " using 1:2 with points lw 1.6 " + point_of(mark.style, 1.15));
}

/// Names beside their marks: towards the middle of the panel, where there is room, or in another corner of
/// the mark where they would cover a name or a mark there.
void Writer::name(const std::vector<Mark>& marks, const Panel& panel, const Place& place,
                  const Extent& extent) {
  constexpr double half_mark = 4, half_line = 6, beside = 7, line = 16;  // [pixels]
  struct Box {
    double left, right, low, high;
    [[nodiscard]] bool meets(const Box& other) const {
      return left < other.right && other.left < right && low < other.high && other.low < high;
    }
  };
  const auto at = [&](const Mark& mark) {
    return std::pair(fraction(mark.x, panel.x, extent.x), fraction(mark.y, panel.y, extent.y));
  };
  const double width = place.right - place.left, height = place.bottom - place.top;
  std::vector<Box> taken;
  std::vector<const Mark*> named;
  for (const Mark& mark : marks) {
    if (!drawable(mark.x, panel.x) || !drawable(mark.y, panel.y)) continue;
    const double x = at(mark).first * width, y = at(mark).second * height;
    if (x < 0 || x > width || y < 0 || y > height) continue;  // not in the range of the axes
    taken.push_back({x - half_mark, x + half_mark, y - half_mark, y + half_mark});
    if (!mark.name.empty()) named.push_back(&mark);
  }
  for (const Mark* mark : named) {
    const std::string text = shortened(one_line(mark->name), longest_label);
    const auto [x, y] = at(*mark);
    const bool left = x > 0.5 && !mark->ends, below = y > 0.5;
    const auto box_of = [&, x = x, y = y](bool to_left, bool to_below) {
      const double length = character * static_cast<double>(length_of(text));
      const double from = x * width + (to_left ? -beside - length : beside),
                   middle = y * height + (mark->ends ? 0 : (to_below ? -0.8 : 0.8) * line);
      return Box{from, from + length, middle - half_line, middle + half_line};
    };
    std::pair corner{left, below};
    for (const auto& other : {std::pair{left, below}, std::pair{left, !below}, std::pair{!left, below},
                              std::pair{!left, !below}}) {
      const Box box = box_of(other.first, other.second);
      if (mark->ends || std::ranges::any_of(taken, [&](const Box& each) { return each.meets(box); }))
        continue;
      corner = other;
      break;
    }
    taken.push_back(box_of(corner.first, corner.second));
    script_ += fmt::format(
        "set label {} at graph {:.5f},{:.5f} {} offset {},{} font 'sans-serif,12' noenhanced front\n",
        gnuplot_string(text), x, y, corner.first ? "right" : "left", corner.first ? -1 : 1,
        mark->ends      ? 0
        : corner.second ? -0.8
                        : 0.8);
  }
}

/// The key under the panels: every entry a sample of the line with its marker, filled down the columns.
void Writer::key() {
  for (std::size_t i = 0; i < key_.size(); ++i) {
    const Entry& entry = key_[i];
    const std::size_t column = i / key_rows_, row = i % key_rows_;
    const double x = left_margin - 30 + key_width_ * static_cast<double>(column);
    const double y = key_top_ + key_row * (static_cast<double>(row) + 0.5);
    // The svg terminal joins neighbours of one colour and width into one path, with the dash of the first.
    Style style = entry.style;
    style.width += i % 2 == 0 ? 0 : 0.01;
    if (entry.line)
      script_ += fmt::format("set arrow from screen {:.5f},{:.5f} to screen {:.5f},{:.5f} nohead {}\n",
                             across(x), up(y), across(x + key_sample), up(y), line_of(style));
    if (entry.style.marker != 0)
      script_ +=
          fmt::format("set label '' at screen {:.5f},{:.5f} point {}\n", across(x + key_sample / 2), up(y),
                      entry.fill.empty() ? point_of(entry.style, entry.line ? 0.75 : 1.15)
                                         : fmt::format("pt 5 ps 1.61 lc rgb '{}'", entry.fill));
    label(entry.label, x + key_sample + 8, y, "'sans-serif,12'");
  }
  for (std::size_t i = 0; i < footer_.size(); ++i)
    label(footer_[i], 16, height_ - 11 - footer_line * static_cast<double>(footer_.size() - 1 - i),
          "'sans-serif,10'", "tc rgb '#808080'");
}

void Writer::footer() {
  script_ += fmt::format(
      "\nunset multiplot\n"
      "unset output\n"
      "pass = pass + 1\n"
      "if (pass <= 3) load '{}.gp'\n",
      name_);
}

constexpr std::array pictures{".svg", ".png", ".pdf"};

/// With what the script of a figure begins, which tells that the files beside it are ours too.
std::string opening_of(const std::string& name) { return fmt::format("# Draws {}.svg,", name); }

/// cairo writes the time of day into a PDF; digits of equal number keep the file's offsets valid.
void remove_creation_date(const std::filesystem::path& pdf) {
  std::ifstream in(pdf, std::ios::binary);
  if (!in) return;
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const std::string key = "/CreationDate (D:", epoch = "19700101000000";
  const std::size_t found = bytes.rfind(key);
  if (found == std::string::npos || found + key.size() + epoch.size() > bytes.size()) return;
  bytes.replace(found + key.size(), epoch.size(), epoch);
  write_file(pdf, bytes, "%PDF");
}

}  // namespace

FigureSource source_of(const Figure& figure, const std::string& name) { return Writer(figure, name).write(); }

void check_figure_files(const std::filesystem::path& directory, const std::string& name) {
  const std::string base = (directory / name).string();
  const bool own = is_own_file(base + ".gp", opening_of(name));
  for (const char* extension : {".gp", ".dat", ".svg", ".png", ".pdf"})
    check_replaceable(base + extension, own);
}

FigureFiles draw(const Figure& figure, const std::filesystem::path& directory, const std::string& name) {
  const bool plain = !name.empty() && name[0] != '-' && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (!plain)
    throw InputError("a figure cannot be called '" + one_line(name) + "'; use letters, digits, '_' and '-'");
  if (figure.panels.empty())
    throw InputError("the figure " + name + " has no panel; give it something to show");
  // Files are written one at a time (PartFile); gnuplot may draw several figures at once.
  static std::mutex writing;
  std::unique_lock hold(writing);
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  if (failed)
    throw InputError("cannot make the folder " + directory.string() + ": " + failed.message() +
                     "; choose another");

  const FigureSource source = source_of(figure, name);
  FigureFiles files{.base = directory / name, .alt = alt_text(figure)};
  const auto file = [&](const char* extension) { return directory / (name + extension); };
  check_figure_files(directory, name);
  write_file(file(".gp"), source.script, opening_of(name));
  write_file(file(".dat"), source.data, "#");
  files.made = {file(".gp"), file(".dat")};
  // A picture of an earlier run must not pass for this one.
  for (const char* extension : pictures) std::filesystem::remove(file(extension), failed);
  hold.unlock();
  files.problem = run_gnuplot(directory, name + ".gp");
  hold.lock();
  remove_creation_date(file(".pdf"));
  describe_svg(file(".svg"), figure.title, files.alt);
  for (const char* extension : pictures)
    if (std::filesystem::exists(file(extension))) files.made.push_back(file(extension));
  return files;
}

}  // namespace hmax
