#include "plots/drawn/colour_map.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace hmax {

Rgb colour_at(double share) {
  const double way = std::clamp(share, 0.0, 1.0) * (colour_stops.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(way), colour_stops.size() - 2);
  Rgb colour{};
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = std::lerp(colour_stops[k][c], colour_stops[k + 1][c], way - static_cast<double>(k));
  return colour;
}

std::string hex_of(const Rgb& colour, double bright) {
  return fmt::format("#{:02x}{:02x}{:02x}", std::lround(bright * colour[0]), std::lround(bright * colour[1]),
                     std::lround(bright * colour[2]));
}

}  // namespace hmax
