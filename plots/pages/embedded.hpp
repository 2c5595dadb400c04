/// Pictures that a page holds in itself.
#pragma once

#include <string>
#include <string_view>

namespace hmax {

/// A picture as an `img` that holds it. An SVG stays text, which is smaller than base64.
/// @param alt  shown as it is
std::string embedded_svg(std::string_view svg, const std::string& alt);
std::string embedded_png(std::string_view png, const std::string& alt);

}  // namespace hmax
