/// Colours for numbers: equal steps of the number are equal steps to the eye.
#pragma once

#include <array>
#include <string>

namespace hmax {

/// Red, green, blue, 0 to 255.
using Rgb = std::array<double, 3>;

/// From the colour of paper over orange and vermillion to dark violet, straight lines between: stops at even
/// steps along a path of OKLab.
/// @source  [ottosson2020oklab]
inline constexpr std::array<Rgb, 9> colour_stops{{{252, 243, 225},
                                                  {247, 211, 154},
                                                  {240, 175, 90},
                                                  {231, 132, 54},
                                                  {214, 92, 41},
                                                  {186, 67, 83},
                                                  {158, 36, 104},
                                                  {111, 35, 107},
                                                  {67, 24, 107}}};

/// @param share  0 at the first stop, 1 at the last; clamped
Rgb colour_at(double share);

/// "#0072b2". @param bright  darkens, from 1 for the colour itself to 0 for black
std::string hex_of(const Rgb& colour, double bright = 1);

}  // namespace hmax
