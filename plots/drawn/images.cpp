#include "plots/drawn/images.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "core/own_files.hpp"
#include "core/text/base64.hpp"
#include "plots/colours.hpp"
#include "plots/gnuplot.hpp"
#include "plots/svg.hpp"

namespace hmax {

namespace {

void add_number(std::string& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
}

/// A chunk of a PNG with its CRC-32 [RFC 2083, sections 3.2 and 3.4].
void add_chunk(std::string& png, const std::string& type, const std::string& data) {
  add_number(png, static_cast<std::uint32_t>(data.size()));
  std::uint32_t crc = 0xffffffff;
  for (const char c : type + data) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
  }
  png += type + data;
  add_number(png, ~crc);
}

/// Bytes in the format of zlib, in stored blocks (RFC 1950, 1951).
std::string stored(const std::string& bytes) {
  constexpr std::size_t most = 65535;
  std::string packed = "\x78\x01";
  for (std::size_t i = 0; i == 0 || i < bytes.size(); i += most) {
    const std::size_t count = std::min(most, bytes.size() - i);
    packed += static_cast<char>(i + count == bytes.size());
    for (const std::size_t length : {count, ~count})
      for (const int shift : {0, 8}) packed += static_cast<char>(length >> shift & 255);
    packed.append(bytes, i, count);
  }
  std::uint32_t a = 1, b = 0;
  for (const char c : bytes) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  add_number(packed, b << 16 | a);
  return packed;
}

constexpr double sheet = 900, border = 16, between = 14, heading = 24;
constexpr double image_edge = (sheet - 2 * border - between) / 2;  // of an image

std::string line_svg(const ImageLine& line, double scale) {
  std::string points;
  for (const auto& [x, y] : line.points) points += fmt::format("{:.1f},{:.1f} ", scale * x, scale * y);
  return fmt::format(
      "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\" stroke-dasharray=\"5 3\" points=\"{}\"/>\n",
      colour_name(line.colour), points);
}

/// An image with its title and lines, at (x, y).
std::string image_svg(const PixelImage& image, double x, double y) {
  const auto pixels = static_cast<std::uint32_t>(std::lround(std::sqrt(image.grey.size())));
  std::string svg = svg_text(x, y - 8, image.title);
  svg += fmt::format(
      "<svg x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{2:.1f}\"><image width=\"100%\" "
      "height=\"100%\" href=\"data:image/png;base64,{3}\"/>\n",
      x, y, image_edge, encode_base64(png_of(image.grey, pixels)));
  for (const ImageLine& line : image.lines) svg += line_svg(line, image_edge / pixels);
  return svg + "</svg>\n";
}

/// The key of the lines, and the scale.
std::string below(const ImagePicture& picture, double y) {
  std::string svg;
  std::set<std::string> told;
  double x = border;
  for (const PixelImage& image : picture.images)
    for (const ImageLine& line : image.lines) {
      if (!told.insert(line.label).second) continue;
      svg += line_svg({{}, line.colour, {{x, y + 8}, {x + 26, y + 8}}}, 1) +
             svg_text(x + 32, y + 12, line.label, "class=\"small\"");
      x += 62 + 6.2 * static_cast<double>(length_of(line.label));
    }
  const double pixels = std::sqrt(picture.images.front().grey.size());
  const double bar = 0.02 / picture.pixel * image_edge / pixels, right = sheet - border;
  return svg +
         fmt::format(
             "<path fill=\"none\" stroke=\"#303030\" stroke-width=\"1.4\" d=\"M{:.1f} {:.1f}v6m0 "
             "-3h{:.1f}m0 -3v6\"/>\n",
             right - bar, y, bar) +
         svg_text(right - bar / 2, y + 20, "20 mm", "text-anchor=\"middle\" class=\"small\"");
}

}  // namespace

std::string png_of(std::span<const std::uint8_t> grey, std::uint32_t width) {
  if (width == 0 || grey.empty() || grey.size() % width != 0)
    throw std::invalid_argument(fmt::format("{} pixels make no rows of {}", grey.size(), width));
  std::string header, rows;
  add_number(header, width);
  add_number(header, static_cast<std::uint32_t>(grey.size() / width));
  header += std::string("\x08\0\0\0\0", 5);  // bits, grey, and the only methods there are
  for (std::size_t i = 0; i < grey.size(); ++i) {
    if (i % width == 0) rows += '\0';  // no filter
    rows += static_cast<char>(grey[i]);
  }
  std::string png = "\x89PNG\r\n\x1a\n";
  add_chunk(png, "IHDR", header);
  add_chunk(png, "tEXt", std::string("Comment\0", 8) + std::string(own_mark));
  add_chunk(png, "IDAT", stored(rows));
  add_chunk(png, "IEND", "");
  return png;
}

std::string images_svg(const ImagePicture& picture) {
  std::string body;
  double y = border + 10;
  for (const std::string& words : lines_of(picture.title, 90)) {
    body += svg_text(border, y, words, "font-size=\"16\"");
    y += 21;
  }
  for (std::size_t i = 0; i < picture.images.size(); ++i) {
    if (i % 2 == 0) y += heading;
    body += image_svg(picture.images[i], border + static_cast<double>(i % 2) * (image_edge + between), y - 8);
    if (i % 2 == 1 || i + 1 == picture.images.size()) y += image_edge + between;
  }
  body += below(picture, y - 8);
  y += 36;
  for (const std::string& words : lines_of(picture.caption, 142)) {
    body += svg_text(border, y, words, "class=\"small\"");
    y += 15;
  }
  return svg_opening(sheet, y, ".small{font-size:11px;fill:#606060}") + body + "</svg>\n";
}

}  // namespace hmax
