#include "plots/colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace hmax {
namespace {

constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                             "#e69f00", "#56b4e9", "#000000", "#808080"};
constexpr std::array tints{"#b8d6e8", "#f4d0b8", "#b8e3d9", "#f1dbe7",
                           "#f9e4b8", "#d0e9f8", "#b8b8b8", "#dcdcdc"};

}  // namespace

const char* colour_of(const Style& style) { return wrapped(style.light ? tints : colours, style.colour); }

std::string colour_name(int colour, double shade) {
  const std::string full = wrapped(colours, colour);
  std::string mixed = "#";
  for (const std::size_t at : {1U, 3U, 5U}) {
    const double part = std::stoi(full.substr(at, 2), nullptr, 16);
    mixed += fmt::format("{:02x}", std::lround(255 - std::clamp(shade, 0.0, 1.0) * (255 - part)));
  }
  return mixed;
}

Style family_style(int k, bool markers) {
  constexpr std::array shapes{7, 5, 9, 13, 6, 4, 8, 12};
  return {.colour = k, .dash = k, .marker = markers ? wrapped(shapes, k) : 0};
}

}  // namespace hmax
