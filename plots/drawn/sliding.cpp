#include "plots/drawn/sliding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "plots/gnuplot.hpp"
#include "plots/svg.hpp"

namespace hmax {

namespace {

constexpr double sliding_width = 900;
constexpr const char* red = "#d00000";
// Of the house's colours, those that nobody takes for red; a second row repeats them with a square.
constexpr std::array palette{0, 2, 6, 3, 4, 5};
constexpr double round_seconds = 12, moving = 0.9;  // the rest of a round it stands still

std::string colour_at(std::size_t k) { return colour_name(palette[k % palette.size()]); }

/// A rectangle of the page that shows a rectangle of the plane, with equal scales.
struct View {
  double left, top, width, height;
  Range re, im;

  View(double from_left, double from_top, double wide, double high, Range real, Range imaginary)
      : left(from_left), top(from_top), width(wide), height(high), re(real), im(imaginary) {
    const double unit = std::max((re.high - re.low) / width, (im.high - im.low) / height);
    const double middle_re = (re.low + re.high) / 2, middle_im = (im.low + im.high) / 2;
    re = {middle_re - unit * width / 2, middle_re + unit * width / 2};
    im = {middle_im - unit * height / 2, middle_im + unit * height / 2};
  }
  [[nodiscard]] double x(double value) const { return left + (value - re.low) / (re.high - re.low) * width; }
  [[nodiscard]] double y(double value) const { return top + (im.high - value) / (im.high - im.low) * height; }
};

/// Region, axes, ticks and the rays that the eigenvalues go along, clipped to the view.
std::string plane(const SlidingPicture& picture, const View& view, const std::string& id, int ticks) {
  std::string svg = fmt::format(
      "<clipPath id=\"{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/></clipPath>\n"
      "<g clip-path=\"url(#{})\">\n<path fill=\"{}\" stroke=\"{}\" stroke-width=\"1.6\" d=\"",
      id, view.left, view.top, view.width, view.height, id, colour_name(7, 0.25), colour_name(7));
  for (const PlaneCurve& loop : picture.region) {
    double last_x = 0, last_y = 0;
    bool first = true;
    for (const auto& [re, im] : loop) {
      const double x = view.x(re), y = view.y(im);
      if (!first && std::hypot(x - last_x, y - last_y) < 1.5) continue;
      svg += fmt::format("{}{:.1f} {:.1f}", first ? "M" : "L", x, y);
      last_x = x;
      last_y = y;
      first = false;
    }
    svg += "Z";
  }
  svg += "\"/>\n";
  svg += fmt::format(
      "<path stroke=\"#808080\" stroke-width=\"0.8\" d=\"M{:.1f} {:.1f}H{:.1f}M{:.1f} {:.1f}V{:.1f}\"/>\n",
      view.left, view.y(0), view.left + view.width, view.x(0), view.top, view.top + view.height);
  for (std::size_t k = 0; k < picture.spectra.size(); ++k)
    for (const SlidingPoint& p : picture.spectra[k].points)
      svg += fmt::format(
          "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
          "stroke-width=\"0.8\" stroke-dasharray=\"2 3\"/>\n",
          view.x(0), view.y(0), view.x(picture.end * p.re), view.y(picture.end * p.im), colour_at(k));
  svg += "</g>\n";
  const double step_re = tick_of(view.re, ticks), step_im = tick_of(view.im, ticks);
  for (double at = std::ceil(view.re.low / step_re); at * step_re <= view.re.high; ++at)
    svg += svg_text(view.x(at * step_re), view.top + view.height + 16,
                    fmt::format("{:g}", at * step_re + 0.0), "text-anchor=\"middle\" class=\"tick\"");
  for (double at = std::ceil(view.im.low / step_im); at * step_im <= view.im.high; ++at)
    svg += svg_text(view.left - 6, view.y(at * step_im) + 4, fmt::format("{:g}", at * step_im + 0.0),
                    "text-anchor=\"end\" class=\"tick\"");
  return svg + fmt::format(
                   "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
                   "stroke=\"#b0b0b0\"/>\n",
                   view.left, view.top, view.width, view.height);
}

std::string opening(double height, const std::string& title) {
  return svg_opening(sliding_width, height, ".tick{font-size:11px;fill:#606060}.head{font-size:16px}") +
         svg_text(16, 26, title, "class=\"head\"");
}

/// The share of a round at which the step is h.
double time_of(const SlidingPicture& picture, double h) {
  return moving * std::clamp(h / picture.end, 0.0, 1.0);
}

std::string animation(const std::string& attribute, const std::string& values, const std::string& times,
                      bool jumps) {
  return fmt::format(
      "<animate attributeName=\"{}\" values=\"{}\" keyTimes=\"{}\" dur=\"{:g}s\" "
      "repeatCount=\"indefinite\"{}/>",
      attribute, values, times, round_seconds, jumps ? " calcMode=\"discrete\"" : "");
}

/// From one value to another when the step passes `exit`; nothing when it never does.
std::string change(const SlidingPicture& picture, const std::string& attribute, const std::string& before,
                   const std::string& after, double exit) {
  if (!(exit < picture.end)) return "";
  return animation(attribute, before + ";" + after, fmt::format("0;{:.4f}", time_of(picture, exit)), true);
}

std::string circle(double x, double y, double radius, const std::string& colour, bool outside,
                   const std::string& inside = "") {
  return fmt::format(
      "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" fill=\"{}\" stroke=\"{}\" "
      "stroke-width=\"1.5\">{}</circle>\n",
      x, y, radius, outside ? red : colour, outside ? "#000000" : "#ffffff", inside);
}

std::string seconds_text(double h) { return fmt::format("{:.3g} s", h); }

}  // namespace

double SlidingSpectrum::largest_step() const {
  double least = std::numeric_limits<double>::infinity();
  for (const SlidingPoint& point : points) least = std::min(least, point.exit);
  return least;
}

namespace {

constexpr double plane_top = 48, plane_height = 420, bar_top = plane_top + plane_height + 64;
constexpr double still = 0.4;  // of the largest step, which a viewer without animations shows

/// The eigenvalues, which go along their rays and turn red where the step is no longer stable.
std::string moving_eigenvalues(const SlidingPicture& picture, const View& view) {
  const double still_h = still * picture.end;
  const std::string times = fmt::format("0;{:g};1", moving);
  std::string svg = "<g clip-path=\"url(#plane)\">\n";
  for (std::size_t k = 0; k < picture.spectra.size(); ++k)
    for (const SlidingPoint& p : picture.spectra[k].points) {
      const double x = view.x(picture.end * p.re), y = view.y(picture.end * p.im);
      svg += circle(view.x(still_h * p.re), view.y(still_h * p.im), 6, colour_at(k), still_h > p.exit,
                    animation("cx", fmt::format("{:.1f};{:.1f};{:.1f}", view.x(0), x, x), times, false) +
                        animation("cy", fmt::format("{:.1f};{:.1f};{:.1f}", view.y(0), y, y), times, false) +
                        change(picture, "fill", colour_at(k), red, p.exit) +
                        change(picture, "stroke", "#ffffff", "#000000", p.exit));
    }
  return svg + "</g>\n";
}

/// The models and their largest stable steps, red from there on.
std::string largest_steps(const SlidingPicture& picture, double left) {
  const double still_h = still * picture.end;
  std::string svg = svg_text(left, plane_top + 12, "largest stable step", "fill=\"#606060\"");
  for (std::size_t k = 0; k < picture.spectra.size(); ++k) {
    const SlidingSpectrum& spectrum = picture.spectra[k];
    const double y = plane_top + 40 + 26 * static_cast<double>(k), exit = spectrum.largest_step();
    svg += circle(left + 7, y - 4, 6, colour_at(k), still_h > exit,
                  change(picture, "fill", colour_at(k), red, exit) +
                      change(picture, "stroke", "#ffffff", "#000000", exit));
    svg += svg_text(left + 22, y, spectrum.label);
    svg += svg_text(sliding_width - 20, y, std::isfinite(exit) ? seconds_text(exit) : "unbounded",
                    "text-anchor=\"end\"");
  }
  const double below = plane_top + 40 + 26 * static_cast<double>(picture.spectra.size()) + 10;
  return svg + circle(left + 7, below - 4, 6, red, true) +
         svg_text(left + 22, below, "outside: the step amplifies it", "fill=\"#606060\"");
}

/// The step as a bar that fills, with the largest stable steps of the models on it.
std::string step_bar(const SlidingPicture& picture, const View& view) {
  const double length = view.width;
  std::string svg =
      fmt::format("<rect x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"6\" fill=\"{3}\"/>\n",
                  view.left, bar_top, length, colour_name(7, 0.3));
  svg += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"6\" fill=\"#404040\">{}</rect>\n", view.left,
      bar_top, still * length,
      animation("width", fmt::format("0;{0:.1f};{0:.1f}", length), fmt::format("0;{:g};1", moving), false));
  for (std::size_t k = 0; k < picture.spectra.size(); ++k) {
    const double exit = picture.spectra[k].largest_step();
    if (exit < picture.end)
      svg += fmt::format("<path stroke=\"{}\" stroke-width=\"3\" d=\"M{:.1f} {:.1f}v14\"/>\n", colour_at(k),
                         view.left + length * exit / picture.end, bar_top - 4);
  }
  const double step = tick_of({0, picture.end}, 8);
  for (double at = 0; at * step <= picture.end; ++at)
    svg += svg_text(view.left + length * at * step / picture.end, bar_top + 26,
                    fmt::format("{:g}", at * step), "text-anchor=\"middle\" class=\"tick\"");
  return svg;
}

/// The step as a number: one text for each of many steps, of which one is visible at a time.
std::string step_number(const SlidingPicture& picture, double left) {
  constexpr int shown = 48;
  std::string svg;
  for (int i = 0; i <= shown; ++i) {
    const double h = picture.end * i / shown;
    const double from = moving * i / shown, to = i == shown ? 1 : moving * (i + 1) / shown;
    const std::string values = i == 0       ? "visible;hidden"
                               : i == shown ? "hidden;visible"
                                            : "hidden;visible;hidden";
    const std::string when = i == 0       ? fmt::format("0;{:.4f}", to)
                             : i == shown ? fmt::format("0;{:.4f}", from)
                                          : fmt::format("0;{:.4f};{:.4f}", from, to);
    const bool is_still = i == static_cast<int>(std::lround(still * shown));
    svg += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"20\" visibility=\"{}\">h = {:.2f} s{}</text>\n", left,
        bar_top + 10, is_still ? "visible" : "hidden", h, animation("visibility", values, when, true));
  }
  return svg;
}

}  // namespace

std::string sliding_svg(const SlidingPicture& picture) {
  const View view(50, plane_top, 590, plane_height, picture.re, picture.im);
  const double right = view.left + view.width + 24;
  return opening(bar_top + 44, picture.title) + plane(picture, view, "plane", 9) +
         svg_text(view.left + view.width / 2, plane_top + plane_height + 34, "Re hλ",
                  "text-anchor=\"middle\"") +
         fmt::format(
             "<text transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\">Im hλ</text>\n",
             plane_top + plane_height / 2) +
         moving_eigenvalues(picture, view) + largest_steps(picture, right) + step_bar(picture, view) +
         step_number(picture, right) + "</svg>\n";
}

std::string sliding_frames_svg(const SlidingPicture& picture, const std::vector<double>& steps) {
  const double count = static_cast<double>(std::max<std::size_t>(1, steps.size()));
  const double share = (sliding_width - 20) / count, size = share - 34;
  const double shape = (picture.im.high - picture.im.low) / (picture.re.high - picture.re.low);
  const double height = std::clamp(size * shape, 90.0, 1.4 * size);
  constexpr double top = 68;
  std::string svg = opening(top + height + 62, picture.title);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const View view(20 + share * static_cast<double>(i) + 20, top, size, height, picture.re, picture.im);
    const std::string id = fmt::format("frame{}", i);
    svg += svg_text(view.left, top - 10, fmt::format("h = {:.2f} s", steps[i])) + plane(picture, view, id, 4);
    svg += fmt::format("<g clip-path=\"url(#{})\">\n", id);
    for (std::size_t k = 0; k < picture.spectra.size(); ++k)
      for (const SlidingPoint& p : picture.spectra[k].points)
        svg += circle(view.x(steps[i] * p.re), view.y(steps[i] * p.im), 4.5, colour_at(k), steps[i] > p.exit);
    svg += "</g>\n";
  }
  double x = 40;
  for (std::size_t k = 0; k < picture.spectra.size(); ++k) {
    svg += circle(x, top + height + 42, 5, colour_at(k), false) +
           svg_text(x + 11, top + height + 46, picture.spectra[k].label, "font-size=\"12\"");
    x += 34 + 7 * static_cast<double>(length_of(picture.spectra[k].label));
  }
  svg += circle(x, top + height + 42, 5, red, true) +
         svg_text(x + 11, top + height + 46, "outside", "font-size=\"12\"");
  return svg + "</svg>\n";
}

}  // namespace hmax
