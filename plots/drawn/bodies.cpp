#include "plots/drawn/bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "plots/drawn/colour_map.hpp"
#include "plots/gnuplot.hpp"
#include "plots/svg.hpp"

namespace hmax {

namespace {

constexpr double width = 900, margin = 16, gap = 14;
constexpr double tallest = 470;                                       // pixels of the body alone in its row
constexpr std::size_t most_triangles = 14'000, most_if_coarse = 700;  // that look this way, of a picture
constexpr double shaft_length = 5;                                    // radii of the tool's ball
constexpr std::size_t caption_line = 142;                             // characters
constexpr std::size_t characters_of_title = 90;                       // characters, which are larger
constexpr double title_height = 21;                                   // pixels of a line

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

/// The range of the values that are seen, unless one is given.
Range range_of(const BodyPicture& picture) {
  if (picture.colours.range) return *picture.colours.range;
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const auto include = [&](double value) {
    if (std::isfinite(value)) range = {std::min(range.low, value), std::max(range.high, value)};
  };
  const Camera camera(picture.towards);
  for (const BodyView& view : picture.views) {
    if (view.values.empty()) continue;
    if (view.values.size() != view.points.size()) {
      std::ranges::for_each(view.values, include);
      continue;
    }
    for (const TriangleCorners& t : seen_by(camera, {view.points, view.triangles}).triangles)
      for (const std::int32_t corner : t) include(view.values[static_cast<std::size_t>(corner)]);
  }
  if (!(range.low <= range.high)) return {0, 1};
  if (!(range.high > range.low)) range.high = range.low + std::max(1e-12, 0.1 * std::abs(range.low));
  return range;
}

/// Place of a value in the map.
double share_of(double value, const Range& range, const BodyColours& map) {
  const double share = (value - range.low) / (range.high - range.low);
  return map.low_is_bad ? 1 - share : share;
}

std::string bar_number(double value) { return fmt::format("{:g}", std::round(value * 1e12) / 1e12 + 0.0); }

/// The scale of colours with its ticks; ends beyond which there are values are told.
std::string colour_bar(const BodyPicture& picture, const Range& range, double x, double y, double length) {
  std::string svg = "<linearGradient id=\"scale\">";
  constexpr std::size_t last = colour_stops.size() - 1;
  for (std::size_t k = 0; k <= last; ++k)
    svg += fmt::format("<stop offset=\"{:.3f}\" stop-color=\"{}\"/>", static_cast<double>(k) / last,
                       hex_of(colour_stops[picture.colours.low_is_bad ? last - k : k]));
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
    const bool at_low = value - range.low < tolerance, at_high = range.high - value < tolerance;
    const std::string mark = at_low && least < range.low - tolerance    ? "≤ "
                             : at_high && most > range.high + tolerance ? "≥ "
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

const char* const style =
    ".small{font-size:11px;fill:#606060}.outline{fill:#808080;stroke:#303030;stroke-width:2;stroke-linejoin:round}"
    ".body{stroke-linejoin:round;stroke-width:.7}"
    ".edges{stroke:#000000;stroke-opacity:.2;stroke-width:.6}"
    ".held{fill:#202020;stroke:#ffffff;stroke-width:.8}";

/// The head of arrows, for `marker-end`: begins at the end of its line.
constexpr double head_length = 11;
constexpr const char* arrow_head =
    "<marker id=\"head\" orient=\"auto\" markerUnits=\"userSpaceOnUse\" markerWidth=\"13\" "
    "markerHeight=\"12\" refX=\"1\" refY=\"6\"><path fill=\"#202020\" stroke=\"#ffffff\" "
    "stroke-width=\".8\" d=\"M1 1.4L12 6L1 10.6z\"/></marker>\n";

std::string arrow(const BodyArrow& force, const Camera& camera) {
  const SpacePoint ahead = scaled_to(force.direction, 1 / camera.scale);
  const SpacePoint from = camera.seen({0, 0, 0}), to = camera.seen(ahead);
  const double dx = to[0] - from[0], dy = to[1] - from[1], shown = std::hypot(dx, dy);
  if (shown < 0.05) return "";
  const double ux = dx / shown, uy = dy / shown, length = 44 * std::max(0.4, shown);
  const SpacePoint at = camera.seen(force.point);
  const double x = at[0] + (force.leaves ? length * ux : 0), y = at[1] + (force.leaves ? length * uy : 0);
  const std::string line = fmt::format("d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"", x - length * ux, y - length * uy,
                                       x - head_length * ux, y - head_length * uy);
  return fmt::format(
      "<path stroke=\"#ffffff\" stroke-width=\"5\" {0}/><path stroke=\"#202020\" "
      "stroke-width=\"2.4\" marker-end=\"url(#head)\" {0}/>\n",
      line);
}

/// A ball on a shaft, in metal: a circle and a bar from whatever side.
std::string tool_svg(const BodyTool& tool, const Camera& camera) {
  const SpacePoint shaft = scaled_to(tool.shaft, 1);
  const auto along = [&](double radii) {
    SpacePoint p = tool.centre;
    for (std::size_t k = 0; k < 3; ++k) p[k] += radii * tool.radius * shaft[k];
    return camera.seen(p);
  };
  const SpacePoint at = along(0), from = along(0.9), to = along(shaft_length);
  const double radius = tool.radius * camera.scale;
  const std::string line = fmt::format("d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"", from[0], from[1], to[0], to[1]);
  const std::string ball = fmt::format(
      "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" "
      "fill=\"url(#metal)\"/>\n",
      at[0], at[1], radius);
  const std::string bar = fmt::format(
      "<path stroke=\"#80878e\" stroke-width=\"{:.1f}\" {}/><path "
      "stroke=\"#aab1b8\" stroke-width=\"{:.1f}\" {}/>\n",
      0.72 * radius, line, 0.4 * radius, line);
  return to[2] > at[2] ? ball + bar : bar + ball;
}
constexpr const char* metal =
    "<radialGradient id=\"metal\" cx=\".36\" cy=\".3\" r=\".75\"><stop offset=\"0\" "
    "stop-color=\"#f4f6f8\"/><stop offset=\".3\" stop-color=\"#b9c0c7\"/><stop offset=\"1\" "
    "stop-color=\"#5f676f\"/></radialGradient>\n";

/// The shape at rest: a pale area behind the body.
std::string rest_behind(const std::string& id, const Surface& rest) {
  return fmt::format(
      "<defs><path id=\"{0}\" d=\"{1}\"/></defs>\n<use href=\"#{0}\" fill=\"#ededed\" "
      "stroke=\"#ededed\" stroke-width=\".7\"/>\n",
      id, shape_path(rest));
}
/// And its rim before it: the broad line round every triangle, without what is inside of any.
std::string rest_rim(const std::string& id) {
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
        most_((picture.coarse ? most_if_coarse : most_triangles) /
              std::max<std::size_t>(1, picture.views.size())) {}

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
  }

  Surface few(const Surface& seen) {
    fewer_ = fewer_ || seen.triangles.size() > most_;
    return simplified(seen, most_);
  }

  Surface surface_of(const BodyView& view) const {
    std::vector<double> shares(view.values.size());
    std::ranges::transform(view.values, shares.begin(),
                           [&](double value) { return share_of(value, range_, picture_.colours); });
    return {view.points, view.triangles, std::move(shares), view.values.size() == view.points.size()};
  }

  std::string view(std::size_t index) {
    const BodyView& view = picture_.views[index];
    const auto columns = static_cast<std::size_t>(columns_);
    const std::size_t row = index / columns, column = index % columns;
    const double left = margin + share_ * static_cast<double>(column);
    double y = top_ + row_ * static_cast<double>(row);
    const Box& box = boxes_[index];
    std::string svg;
    if (titled_) svg += svg_text(left, y + 16, view.title, "font-size=\"14\"");
    y += titled_ ? 24 : 0;
    for (std::size_t k = 0; k < view.notes.size(); ++k)
      svg += svg_text(left, y + 11 + 16 * static_cast<double>(k), view.notes[k], "class=\"small\"");
    y += 16 * static_cast<double>(notes_);
    Camera camera = camera_;
    camera.scale = scale_;
    camera.x = left + (share_ - gap) / 2 - scale_ * (box.low_x + box.high_x) / 2;
    camera.y = y + 10 + height_of_view_ / 2 - scale_ * (box.low_y + box.high_y) / 2;
    return svg + body(view, camera, std::to_string(index));
  }

  std::string body(const BodyView& view, const Camera& camera, const std::string& id) {
    const Surface surface = surface_of(view), whole = seen_by(camera, surface), seen = few(whole);
    // Those of fewer triangles are none of the mesh.
    const bool edges = whole.triangles.size() <= most_ && edges_told_apart(whole);
    std::string svg, rim;
    if (!view.rest.empty()) {
      svg += rest_behind("rest" + id, few(seen_by(camera, {view.rest, view.triangles})));
      rim = rest_rim("rest" + id);
    }
    std::string before;
    for (const BodyTool& tool : view.tools)
      (stands_before(tool, view) ? before : svg) += tool_svg(tool, camera);
    svg += fmt::format("<path class=\"outline\" d=\"{}\"/>\n", shape_path(seen)) +
           painted(seen, "v" + id, edges) + before + rim;
    std::set<std::int32_t> visible;
    for (const TriangleCorners& t : whole.triangles) visible.insert(t.begin(), t.end());
    for (const std::int32_t i : view.held)
      if (visible.contains(i)) {
        const SpacePoint& p = whole.points[static_cast<std::size_t>(i)];
        svg += fmt::format("<circle class=\"held\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.4\"/>\n", p[0], p[1]);
      }
    for (const BodyArrow& force : view.arrows) svg += arrow(force, camera);
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
    return svg_opening(width, height, style) + definitions() + headline;
  }

  [[nodiscard]] std::string definitions() const {
    return (any(&BodyView::arrows) ? arrow_head : std::string()) + (any(&BodyView::tools) ? metal : "");
  }
  template <class Member>
  [[nodiscard]] bool any(Member member) const {
    return std::ranges::any_of(picture_.views, [&](const BodyView& v) { return !(v.*member).empty(); });
  }

  /// Lines that fit; a word that does not is cut.
  std::vector<std::string> title() const {
    std::vector<std::string> lines = lines_of(picture_.title, characters_of_title);
    for (std::string& line : lines) line = shortened(line, characters_of_title);
    return lines;
  }

  std::vector<std::string> caption() const {
    std::string text = picture_.caption;
    if (fewer_) text += (text.empty() ? "" : " ") + std::string("Drawn with fewer triangles than it has.");
    return lines_of(text, caption_line);
  }

  /// The surface around it looks this way, near pieces of it counting most; without one, its shaft does.
  [[nodiscard]] bool stands_before(const BodyTool& tool, const BodyView& view) const {
    if (view.triangles.empty()) return camera_.seen(tool.shaft)[2] >= 0;
    double towards = 0;
    for (const TriangleCorners& t : view.triangles) {
      std::array<SpacePoint, 3> seen{};
      double away = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const SpacePoint& p = view.points[static_cast<std::size_t>(t[k])];
        seen[k] = camera_.seen(p);
        away += std::hypot(p[0] - tool.centre[0], p[1] - tool.centre[1], p[2] - tool.centre[2]);
      }
      // Twice the area on the page, which has y downwards; positive where the triangle looks this way.
      const double area = (seen[2][0] - seen[0][0]) * (seen[1][1] - seen[0][1]) -
                          (seen[1][0] - seen[0][0]) * (seen[2][1] - seen[0][1]);
      towards += area / std::pow(away, 6);
    }
    return towards >= 0;
  }

  /// Scales, key and caption.
  std::string below() const {
    std::string svg;
    const bool scaled = !picture_.colours.quantity.empty();
    if (scaled) svg += colour_bar(picture_, range_, margin, foot_ + 12, 300);
    svg += scale_bar(scale_, width - margin - 4, foot_ + 12);
    double x = scaled ? margin + 350 : margin;
    const double y = foot_ + 22;
    const auto entry = [&](const std::string& sample, const std::string& label) {
      svg += sample + svg_text(x + 22, y, label, "class=\"small\"");
      x += 44 + 6.2 * static_cast<double>(length_of(label));
    };
    if (any(&BodyView::held))
      entry(fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"#202020\"/>", x + 10, y - 4),
            std::ranges::find_if(picture_.views, [](const BodyView& view) {
              return !view.held.empty();
            })->held_as);
    if (any(&BodyView::rest))
      entry(fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"16\" height=\"10\" fill=\"#ededed\" "
                        "stroke=\"#8c8c8c\" stroke-width=\"1.1\"/>",
                        x, y - 9),
            "at rest");
    if (any(&BodyView::arrows))
      entry(fmt::format("<path stroke=\"#202020\" stroke-width=\"2.4\" marker-end=\"url(#head)\" "
                        "d=\"M{:.1f} {:.1f}h7\"/>",
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
  std::size_t most_;  ///< triangles of a view
  int columns_ = 1;
  double share_ = 0, scale_ = 1, height_of_view_ = 0, top_ = 0, row_ = 0, foot_ = 0;
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
