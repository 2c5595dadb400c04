/// Images of grey pixels: as PNG, and side by side in an SVG that holds them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hmax {

/// A PNG of 8 bits of grey, row by row from the top. Its data are stored, not packed: speckle would hardly
/// shrink, and no library is needed.
/// @throws std::invalid_argument  where the pixels make no whole rows
std::string png_of(std::span<const std::uint8_t> grey, std::uint32_t width);

/// A line over an image, in its pixels from the upper left corner.
struct ImageLine {
  std::string label;  ///< in the key, once for lines of one label
  int colour = 0;     ///< as of curves (plots/colours.hpp)
  std::vector<std::array<double, 2>> points;
};

struct PixelImage {
  std::string title;
  std::vector<std::uint8_t> grey;  ///< of a square
  std::vector<ImageLine> lines = {};
};

/// Images side by side, on one scale of lengths.
struct ImagePicture {
  std::string title, caption;
  double pixel;  ///< [m]
  std::vector<PixelImage> images{};
};

/// The text of the SVG, 900 pixels wide, with two images in a row. The same picture gives the same bytes.
std::string images_svg(const ImagePicture& picture);

}  // namespace hmax
