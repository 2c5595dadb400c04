/// Scripts and styles of pages as text; the definitions are made at configuration by cmake/embed.cmake.
#pragma once

#include <span>

#include "core/embedded_text.hpp"

namespace hmax {

/// plots/pages/web/*.js, sorted by name.
std::span<const EmbeddedText> page_scripts();

/// plots/pages/web/*.css, sorted by name.
std::span<const EmbeddedText> page_styles();

}  // namespace hmax
