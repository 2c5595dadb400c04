#include "plots/drawn/bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "core/own_files.hpp"
#include "plots/gnuplot.hpp"
#include "plots/svg.hpp"

namespace hmax {

namespace {

constexpr double width = 900, margin = 16, gap = 14;
constexpr double tallest = 470;               // pixels of the body alone in its row
constexpr double pieces_of_picture = 14'000;  // faces and parts of faces
constexpr double pieces_if_coarse = 1'400;    // the same
constexpr double finest = 6, coarsest = 14;   // pixels of the side of such a part
constexpr double coarsest_if_coarse = 20;     // the same
constexpr double shaft_length = 5;            // radii of the ball
constexpr std::size_t caption_line = 142;     // characters
constexpr std::size_t title_line = 90;        // characters, which are larger
constexpr double title_height = 21;           // pixels of a line

struct Box {
  double low_x = std::numeric_limits<double>::infinity(), low_y = low_x, high_x = -low_x, high_y = -low_x;

  void include(const SpacePoint& seen, double radius = 0) {
    low_x = std::min(low_x, seen[0] - radius);
    high_x = std::max(high_x, seen[0] + radius);
    low_y = std::min(low_y, seen[1] - radius);
    high_y = std::max(high_y, seen[1] + radius);
  }
};

SpacePoint scaled_to(const SpacePoint& direction, double length) {
  const double now = std::hypot(direction[0], direction[1], direction[2]);
  if (!(now > 0)) return {0, 0, length};
  return {direction[0] / now * length, direction[1] / now * length, direction[2] / now * length};
}

/// What a view needs of the plane of the camera.
Box box_of(const BodyView& view, const Camera& camera) {
  Box box;
  for (const auto* points : {&view.points, &view.rest})
    for (const SpacePoint& p : *points) box.include(camera.seen(p));
  for (const BodyTool& tool : view.tools) {
    const SpacePoint shaft = scaled_to(tool.shaft, shaft_length * tool.radius);
    box.include(camera.seen(tool.centre), tool.radius);
    box.include(
        camera.seen({tool.centre[0] + shaft[0], tool.centre[1] + shaft[1], tool.centre[2] + shaft[2]}),
        0.4 * tool.radius);
  }
  return box;
}

Range range_of(const BodyPicture& picture) {
  if (picture.colours.range) return *picture.colours.range;
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const BodyView& view : picture.views)
    for (const double value : view.values)
      if (std::isfinite(value)) range = {std::min(range.low, value), std::max(range.high, value)};
  if (!(range.low <= range.high)) return {0, 1};
  if (picture.colours.diverging) {
    const double far = std::max(std::abs(range.low), std::abs(range.high));
    range = {-far, far};
  }
  if (!(range.high > range.low)) range.high = range.low + std::max(1e-12, 0.1 * std::abs(range.low));
  return range;
}

const ColourMap& map_of(const BodyColours& colours) {
  return colours.diverging ? diverging_colours() : sequential_colours();
}

/// Place of a value in the map.
double share_of(double value, const Range& range, const BodyColours& colours) {
  const double share = (value - range.low) / (range.high - range.low);
  return colours.low_is_bad ? 1 - share : share;
}

SpacePoint normal_of(const BodyView& view, const TriangleCorners& t) {
  const SpacePoint &a = view.points[static_cast<std::size_t>(t[0])],
                   &b = view.points[static_cast<std::size_t>(t[1])],
                   &c = view.points[static_cast<std::size_t>(t[2])];
  const auto edge = [&](const SpacePoint& p, std::size_t k) { return p[k] - a[k]; };
  return {edge(b, 1) * edge(c, 2) - edge(b, 2) * edge(c, 1),
          edge(b, 2) * edge(c, 0) - edge(b, 0) * edge(c, 2),
          edge(b, 0) * edge(c, 1) - edge(b, 1) * edge(c, 0)};
}
bool alike(const SpacePoint& p, const SpacePoint& q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2] > 0; }

/// The same surface with all points of a cell of a grid as one, in their middle.
BodyView joined(const BodyView& view, double cell) {
  struct Hash {
    std::size_t operator()(const std::array<std::int64_t, 3>& k) const {
      return static_cast<std::size_t>(k[0] * 73856093 ^ k[1] * 19349663 ^ k[2] * 83492791);
    }
  };
  const std::vector<SpacePoint>& still = view.rest.empty() ? view.points : view.rest;
  const bool smooth = view.values.size() == view.points.size();
  std::unordered_map<std::array<std::int64_t, 3>, std::int32_t, Hash> cells;
  std::vector<std::int32_t> now(view.points.size());
  std::vector<bool> used(view.points.size(), false);
  for (const TriangleCorners& t : view.triangles)
    for (const std::int32_t corner : t) used[static_cast<std::size_t>(corner)] = true;
  BodyView fewer = view;
  fewer.points.clear();
  fewer.rest.clear();
  fewer.values.clear();
  fewer.triangles.clear();
  std::vector<double> members;
  const auto add = [](SpacePoint& sum, const SpacePoint& p) {
    for (std::size_t k = 0; k < 3; ++k) sum[k] += p[k];
  };
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    if (!used[i]) continue;
    std::array<std::int64_t, 3> key{};
    for (std::size_t k = 0; k < 3; ++k) key[k] = std::llround(still[i][k] / cell);
    const auto [found, fresh] = cells.try_emplace(key, static_cast<std::int32_t>(members.size()));
    const auto c = static_cast<std::size_t>(found->second);
    now[i] = found->second;
    if (fresh) {
      members.push_back(0);
      fewer.points.push_back({});
      if (!view.rest.empty()) fewer.rest.push_back({});
      if (smooth) fewer.values.push_back(0);
    }
    members[c] += 1;
    add(fewer.points[c], view.points[i]);
    if (!view.rest.empty()) add(fewer.rest[c], view.rest[i]);
    if (smooth) fewer.values[c] += view.values[i];
  }
  for (std::size_t c = 0; c < members.size(); ++c) {
    for (double& x : fewer.points[c]) x /= members[c];
    if (!view.rest.empty())
      for (double& x : fewer.rest[c]) x /= members[c];
    if (smooth) fewer.values[c] /= members[c];
  }
  for (std::size_t t = 0; t < view.triangles.size(); ++t) {
    const auto at = [&](std::size_t i) { return now[static_cast<std::size_t>(view.triangles[t][i])]; };
    if (at(0) == at(1) || at(1) == at(2) || at(2) == at(0)) continue;
    // What was turned over by joining lies under its neighbours.
    if (!alike(normal_of(view, view.triangles[t]), normal_of(fewer, {at(0), at(1), at(2)}))) continue;
    fewer.triangles.push_back({at(0), at(1), at(2)});
    if (!smooth && !view.values.empty()) fewer.values.push_back(view.values[t]);
  }
  for (std::int32_t& i : fewer.held) i = now[static_cast<std::size_t>(i)];
  return fewer;
}

std::string bar_number(double value) { return fmt::format("{:g}", std::round(value * 1e12) / 1e12 + 0.0); }

/// The scale of colours with its ticks; ends beyond which there are values are told.
std::string colour_bar(const BodyPicture& picture, const Range& range, double x, double y, double length) {
  constexpr int stops = 24;
  std::string svg = "<linearGradient id=\"scale\">";
  for (int k = 0; k <= stops; ++k) {
    const double share = double(k) / stops;
    svg += fmt::format("<stop offset=\"{:.3f}\" stop-color=\"{}\"/>", share,
                       hex_of(map_of(picture.colours).at(picture.colours.low_is_bad ? 1 - share : share)));
  }
  svg += fmt::format(
      "</linearGradient>\n<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"12\" fill=\"url(#scale)\" "
      "stroke=\"#808080\" stroke-width=\".6\"/>\n",
      x, y, length);
  double least = range.high, most = range.low;
  for (const BodyView& view : picture.views)
    for (const double value : view.values)
      if (std::isfinite(value)) {
        least = std::min(least, value);
        most = std::max(most, value);
      }
  const double step = tick_of(range, 5), tolerance = 1e-9 * (range.high - range.low);
  for (double k = std::ceil((range.low - tolerance) / step); k * step <= range.high + tolerance; ++k) {
    const double value = k * step, at = x + length * (value - range.low) / (range.high - range.low);
    const bool first = value - range.low < tolerance, last = range.high - value < tolerance;
    const std::string mark = first && least < range.low - tolerance  ? "≤ "
                             : last && most > range.high + tolerance ? "≥ "
                                                                     : "";
    svg += fmt::format("<path stroke=\"#606060\" stroke-width=\".8\" d=\"M{:.1f} {:.1f}v4\"/>\n", at, y + 12);
    svg += svg_text(at, y + 28, mark + bar_number(value), "text-anchor=\"middle\" class=\"small\"");
  }
  return svg + svg_text(x, y - 8, picture.colours.quantity);
}

/// A length in round numbers, of at most about a hundred pixels.
std::string scale_bar(double scale, double right, double y) {
  double length = std::pow(10, std::floor(std::log10(110 / scale)));
  for (const double factor : {5.0, 2.0})
    if (length * factor * scale <= 110) {
      length *= factor;
      break;
    }
  const double pixels = length * scale;
  return fmt::format(
             "<path fill=\"none\" stroke=\"#303030\" stroke-width=\"1.4\" d=\"M{:.1f} {:.1f}v6m0 -3h{:.1f}m0 "
             "-3v6\"/>\n",
             right - pixels, y, pixels) +
         svg_text(right - pixels / 2, y + 22, bar_number(1000 * length) + " mm",
                  "text-anchor=\"middle\" class=\"small\"");
}

std::string arrow(const BodyArrow& force, const Camera& camera, const Placement& place) {
  const SpacePoint seen = camera.seen(scaled_to(force.direction, 1));
  const double shown = std::hypot(seen[0], seen[1]);
  if (shown < 0.05) return "";
  const double dx = seen[0] / shown, dy = -seen[1] / shown, length = 44 * std::max(0.4, shown), head = 11;
  auto [x, y] = place.at(camera.seen(force.point));
  if (force.leaves) {
    x += length * dx;
    y += length * dy;
  }
  return fmt::format(
      "<path stroke=\"#ffffff\" stroke-width=\"5\" d=\"M{0:.1f} {1:.1f}L{2:.1f} {3:.1f}\"/><path "
      "stroke=\"#202020\" stroke-width=\"2.4\" d=\"M{0:.1f} {1:.1f}L{2:.1f} {3:.1f}\"/><path fill=\"#202020\" "
      "stroke=\"#ffffff\" stroke-width=\".8\" d=\"M{4:.1f} {5:.1f}L{6:.1f} {7:.1f} {8:.1f} {9:.1f}z\"/>\n",
      x - length * dx, y - length * dy, x - 0.8 * head * dx, y - 0.8 * head * dy, x, y,
      x - head * dx - 0.42 * head * dy, y - head * dy + 0.42 * head * dx, x - head * dx + 0.42 * head * dy,
      y - head * dy - 0.42 * head * dx);
}

/// The shape at rest: a pale area behind the body.
std::string ghost_behind(const std::string& id) {
  return fmt::format("<use href=\"#{}\" fill=\"#ededed\" stroke=\"#ededed\" stroke-width=\".7\"/>\n", id);
}
/// And its rim before it: the broad line round every triangle, without what is inside of any.
std::string ghost_rim(const std::string& id) {
  return fmt::format(
      "<mask id=\"{0}m\"><use href=\"#{0}\" fill=\"none\" stroke=\"#ffffff\" stroke-width=\"2.6\" "
      "stroke-linejoin=\"round\"/><use href=\"#{0}\" fill=\"#000000\" stroke=\"#000000\" "
      "stroke-width=\".5\"/></mask>\n<rect width=\"100%\" height=\"100%\" fill=\"#404040\" fill-opacity=\".6\" "
      "mask=\"url(#{0}m)\"/>\n",
      id);
}

void check(const BodyPicture& picture) {
  if (picture.views.empty()) throw InputError("a picture of bodies has no body; give it something to show");
  for (const BodyView& view : picture.views) {
    const bool of_points = view.values.size() == view.points.size();
    if (!view.values.empty() && !of_points && view.values.size() != view.triangles.size())
      throw InputError(fmt::format("{} values fit neither {} points nor {} triangles", view.values.size(),
                                   view.points.size(), view.triangles.size()));
    if (!view.rest.empty() && view.rest.size() != view.points.size())
      throw InputError(
          fmt::format("{} points at rest do not fit {} points", view.rest.size(), view.points.size()));
    for (const SpacePoint& p : view.points)
      for (const double x : p)
        if (!std::isfinite(x))
          throw InputError("a body with points that are not finite cannot be drawn; the motion has diverged");
  }
}

/// One picture being written.
class Page {
 public:
  explicit Page(const BodyPicture& picture)
      : picture_(picture),
        camera_(picture.towards),
        range_(range_of(picture)),
        most_(picture.coarse ? pieces_if_coarse : pieces_of_picture) {}

  std::string write() {
    layout();
    std::string body;
    for (std::size_t i = 0; i < picture_.views.size(); ++i) body += view(i);
    return opening() + body + below() + "</svg>\n";
  }

 private:
  void layout() {
    columns_ = std::clamp(picture_.columns, 1, static_cast<int>(picture_.views.size()));
    share_ = (width - 2 * margin + gap) / columns_;
    double across = 0, up = 0;
    for (const BodyView& v : picture_.views) {
      boxes_.push_back(box_of(v, camera_));
      across = std::max(across, boxes_.back().high_x - boxes_.back().low_x);
      up = std::max(up, boxes_.back().high_y - boxes_.back().low_y);
      notes_ = std::max(notes_, v.notes.size());
      titled_ = titled_ || !v.title.empty();
    }
    const double most = columns_ == 1 ? tallest : 0.95 * share_;
    scale_ = std::min((share_ - gap - 8) / std::max(across, 1e-300), most / std::max(up, 1e-300));
    height_of_view_ = up * scale_;
    top_ = picture_.title.empty() ? 10 : 19 + title_height * static_cast<double>(title().size());
    row_ = (titled_ ? 24 : 0) + 16 * static_cast<double>(notes_) + height_of_view_ + 26;
    const auto rows =
        (picture_.views.size() + static_cast<std::size_t>(columns_) - 1) / static_cast<std::size_t>(columns_);
    foot_ = top_ + row_ * static_cast<double>(rows) + 8;
    double area = 0;
    for (const BodyView& v : picture_.views) area += painted_area(v.points, v.triangles, camera_, scale_);
    size_ =
        std::clamp(std::sqrt(area / (0.43 * most_)), finest, picture_.coarse ? coarsest_if_coarse : coarsest);
  }

  /// A view with few enough triangles.
  BodyView drawn(const BodyView& view) {
    const double most = 2 * most_ / static_cast<double>(picture_.views.size());
    if (static_cast<double>(view.triangles.size()) <= most) return view;
    fewer_ = true;
    BodyView simple = view;
    for (double cell = 1.5; static_cast<double>(simple.triangles.size()) > most; cell *= 1.25)
      simple = joined(view, cell / scale_);
    return simple;
  }

  std::string view(std::size_t index) {
    const BodyView simple = drawn(picture_.views[index]);
    const auto columns = static_cast<std::size_t>(columns_);
    const std::size_t row = index / columns, column = index % columns;
    const double left = margin + share_ * static_cast<double>(column);
    double y = top_ + row_ * static_cast<double>(row);
    const Box& box = boxes_[index];
    std::string svg;
    if (titled_) svg += svg_text(left, y + 16, simple.title, "font-size=\"14\"");
    y += titled_ ? 24 : 0;
    for (std::size_t k = 0; k < simple.notes.size(); ++k)
      svg += svg_text(left, y + 11 + 16 * static_cast<double>(k), simple.notes[k], "class=\"small\"");
    y += 16 * static_cast<double>(notes_);
    const Placement place{.scale = scale_,
                          .seen_x = (box.low_x + box.high_x) / 2,
                          .seen_y = (box.low_y + box.high_y) / 2,
                          .middle_x = left + (share_ - gap) / 2,
                          .middle_y = y + 10 + height_of_view_ / 2};

    const std::string id = fmt::format("rest{}", index);
    if (!simple.rest.empty()) {
      svg += fmt::format("<defs><path id=\"{}\" d=\"{}\"/></defs>\n", id,
                         shape_path(simple.rest, simple.triangles, camera_, place));
      svg += ghost_behind(id);
    }
    std::vector<double> shares(simple.values.size());
    std::ranges::transform(simple.values, shares.begin(),
                           [&](double value) { return share_of(value, range_, picture_.colours); });
    Painter painter(camera_, place);
    for (const BodyTool& tool : simple.tools)
      painter.add_tool(tool.centre, tool.radius, scaled_to(tool.shaft, shaft_length * tool.radius));
    painter.add_surface({.points = simple.points,
                         .triangles = simple.triangles,
                         .shares = shares,
                         .map = map_of(picture_.colours),
                         .smooth = simple.values.size() == simple.points.size()},
                        size_);
    painter.add_dots(simple.points, simple.triangles, simple.held);
    svg += "<g class=\"body\">\n" + painter.svg() + "</g>\n";
    if (!simple.rest.empty()) svg += ghost_rim(id);
    for (const BodyArrow& force : simple.arrows) svg += arrow(force, camera_, place);
    return svg;
  }

  std::string opening() {
    const std::size_t lines = caption().size();
    const bool scaled = !picture_.colours.quantity.empty();
    const double height = foot_ + (scaled ? 58 : 40) + 15 * static_cast<double>(lines) + 8;
    std::string headline;
    double y = 26;
    for (const std::string& line : title()) {
      headline += svg_text(margin, y, line, "font-size=\"16\"");
      y += title_height;
    }
    return fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 "
               "{0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"13\">\n<!-- {3} -->\n"
               "<style>.small{{font-size:11px;fill:#606060}}{2}</style>\n"
               "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
               width, height, painter_style, own_mark) +
           headline;
  }

  /// Lines that fit; a word that does not is cut.
  std::vector<std::string> title() const {
    std::vector<std::string> lines = lines_of(picture_.title, title_line);
    for (std::string& line : lines) line = shortened(line, title_line);
    return lines;
  }

  std::vector<std::string> caption() const {
    std::string text = picture_.caption;
    if (fewer_) text += (text.empty() ? "" : " ") + std::string("Drawn with fewer triangles than it has.");
    return lines_of(text, caption_line);
  }

  /// Scales, key and caption.
  std::string below() const {
    std::string svg;
    const bool scaled = !picture_.colours.quantity.empty();
    if (scaled) svg += colour_bar(picture_, range_, margin, foot_ + 12, 300);
    svg += scale_bar(scale_, width - margin - 4, foot_ + 12);
    double x = scaled ? margin + 350 : margin;
    const double y = foot_ + 22;
    const auto any = [&](auto member) {
      return std::ranges::any_of(picture_.views, [&](const BodyView& v) { return !(v.*member).empty(); });
    };
    const auto entry = [&](const std::string& sample, const std::string& label) {
      svg += sample + svg_text(x + 22, y, label, "class=\"small\"");
      x += 44 + 6.2 * static_cast<double>(length_of(label));
    };
    if (any(&BodyView::held))
      entry(fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"#202020\"/>", x + 10, y - 4),
            "held");
    if (any(&BodyView::rest))
      entry(fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"16\" height=\"10\" fill=\"#ededed\" "
                        "stroke=\"#8c8c8c\" stroke-width=\"1.1\"/>",
                        x, y - 9),
            "at rest");
    if (any(&BodyView::arrows))
      entry(fmt::format("<path fill=\"#202020\" stroke=\"#202020\" stroke-width=\"2\" d=\"M{:.1f} {:.1f}h9l0 "
                        "-2.5l5 2.5l-5 2.5v-2.5\"/>",
                        x, y - 4),
            "force");
    double line = foot_ + (scaled ? 64 : 48);
    for (const std::string& words : caption()) {
      svg += svg_text(margin, line, words, "class=\"small\"");
      line += 15;
    }
    return svg;
  }

  const BodyPicture& picture_;
  Camera camera_;
  Range range_;
  double most_;  ///< pieces
  int columns_ = 1;
  double share_ = 0, scale_ = 1, height_of_view_ = 0, top_ = 0, row_ = 0, foot_ = 0, size_ = finest;
  std::size_t notes_ = 0;
  bool titled_ = false, fewer_ = false;
  std::vector<Box> boxes_;
};

}  // namespace

std::string bodies_svg(const BodyPicture& picture) {
  check(picture);
  return Page(picture).write();
}

}  // namespace hmax
