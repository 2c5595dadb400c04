/// The files of results/published as text; the definition is made at configuration by cmake/embed.cmake.
#pragma once

#include <span>

#include "core/embedded_text.hpp"

namespace hmax {

/// Sorted by name.
std::span<const EmbeddedText> published_texts();

}  // namespace hmax
