#include "plots/drawn/images.hpp"

#include <stdexcept>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "plots/pages/embedded.hpp"

namespace hmax {
namespace {

std::string hex(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return text;
}

/// Bytes of Python's zlib.
TEST(Png, OfFourPixelsHasTheBytesOfAnotherWriter) {
  const std::array<std::uint8_t, 4> grey{10, 255, 0, 128};
  EXPECT_EQ(hex(png_of(grey, 2)),
            "89504e470d0a1a0a0000000d494844520000000200000002080000000057dd52f800000017744558"
            "74436f6d6d656e74007772697474656e20627920686d617871615b6b000000114944415478010106"
            "00f9ff000aff00008004b4018a849ebfd00000000049454e44ae426082");
}

/// More than a stored block holds: 256 rows of 257 bytes. The checksum is that of Python's zlib.
TEST(Png, OfALargeImageHasTwoBlocks) {
  std::vector<std::uint8_t> grey;
  for (int i = 0; i < 65536; ++i) grey.push_back(static_cast<std::uint8_t>(7 * i % 251));
  const std::string png = png_of(grey, 256);
  const std::size_t data = png.find("IDAT") + 4;
  EXPECT_EQ(hex(png.substr(data, 7)), "780100ffff0000");
  EXPECT_EQ(hex(png.substr(data + 7 + 65535, 5)), "010101fefe");
  EXPECT_EQ(hex(png.substr(data + 12 + 65792, 4)), "e43d0353");
  EXPECT_EQ(png.size(), 65792 + 2 + 10 + 4 + 8 + 4 * 12 + 13 + 23);
}

TEST(Png, RefusesPixelsThatMakeNoRows) {
  const std::array<std::uint8_t, 5> grey{};
  EXPECT_THROW(png_of(grey, 2), std::invalid_argument);
  EXPECT_THROW(png_of(grey, 0), std::invalid_argument);
  EXPECT_THROW(png_of({}, 2), std::invalid_argument);
}

TEST(Images, StandTwoInARowWithTheirLinesAndOneKey) {
  const PixelImage plain{.title = "at <rest>", .grey = std::vector<std::uint8_t>(16)};
  PixelImage lined = plain;
  lined.lines = {{.label = "bone", .colour = 5, .points = {{0, 1}, {4, 2}}}};
  const std::string svg =
      images_svg({.title = "Slices", .caption = "Synthetic", .pixel = 0.01, .images = {plain, lined, lined}});
  const auto count = [&](std::string_view what) {
    int found = 0;
    for (auto at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("data:image/png;base64,iVBORw0KGgo"), 3);
  EXPECT_EQ(count("at &lt;rest&gt;"), 3);
  EXPECT_EQ(count("points=\"0.0,106.8 427.0,213.5 \""), 2);  // four pixels are (900 - 46) / 2 wide
  EXPECT_EQ(count(">bone<"), 1);
  EXPECT_EQ(count("20 mm"), 1);
  EXPECT_EQ(count("h213.5m"), 1);  // two pixels of 10 mm
  EXPECT_NE(embedded_svg(svg, "Slices").find("<img"), std::string::npos);
}

}  // namespace
}  // namespace hmax
