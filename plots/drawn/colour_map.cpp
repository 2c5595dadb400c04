#include "plots/drawn/colour_map.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace hmax {

namespace {

double linear_of(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}
double srgb_of(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

OkLab between(const OkLab& p, const OkLab& q, double share) {
  return {std::lerp(p.lightness, q.lightness, share), std::lerp(p.a, q.a, share), std::lerp(p.b, q.b, share)};
}

}  // namespace

OkLab oklab_of(const std::string& hex) {
  const auto channel = [&](std::size_t at) {
    return linear_of(std::stoi(hex.substr(at, 2), nullptr, 16) / 255.0);
  };
  const double r = channel(1), g = channel(3), b = channel(5);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

std::string hex_of(const OkLab& colour) {
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(colour.lightness + 0.3963377774 * colour.a + 0.2158037573 * colour.b);
  const double m = cube(colour.lightness - 0.1055613458 * colour.a - 0.0638541728 * colour.b);
  const double s = cube(colour.lightness - 0.0894841775 * colour.a - 1.2914855480 * colour.b);
  const auto channel = [](double linear) { return std::lround(255 * srgb_of(std::clamp(linear, 0.0, 1.0))); };
  return fmt::format("#{:02x}{:02x}{:02x}", channel(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
                     channel(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
                     channel(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s));
}

ColourMap::ColourMap(const std::vector<std::string>& anchors) {
  double way = 0;
  for (const std::string& anchor : anchors) {
    const OkLab here = oklab_of(anchor);
    if (!anchors_.empty()) {
      const OkLab& last = anchors_.back();
      way += std::hypot(here.lightness - last.lightness, here.a - last.a, here.b - last.b);
    }
    anchors_.push_back(here);
    lengths_.push_back(way);
  }
}

OkLab ColourMap::at(double share) const {
  const double way = std::clamp(share, 0.0, 1.0) * lengths_.back();
  std::size_t k = 1;
  while (k + 1 < lengths_.size() && lengths_[k] < way) ++k;
  return between(anchors_[k - 1], anchors_[k], (way - lengths_[k - 1]) / (lengths_[k] - lengths_[k - 1]));
}

const ColourMap& sequential_colours() {
  static const ColourMap map({"#fcf3e1", "#f3bd66", "#dd6210", "#a02468", "#43186b"});
  return map;
}

const ColourMap& diverging_colours() {
  static const ColourMap map({"#003a66", "#0072b2", "#8ec4e6", "#f4f0ea", "#f0b48c", "#d55e00", "#7a2c00"});
  return map;
}

}  // namespace hmax
