/// Scripts and styles of pages as text; the definitions are made at configuration by cmake/embed.cmake.
#pragma once

#include <span>
#include <string_view>

namespace hmax {

struct PageText {
  std::string_view name;  ///< of the file, without its ending
  std::string_view text;
};

/// plots/pages/web/*.js, sorted by name.
std::span<const PageText> page_scripts();

/// plots/pages/web/*.css, sorted by name.
std::span<const PageText> page_styles();

}  // namespace hmax
