/// The files of results/published as text; the definition is made at configuration by cmake/embed.cmake.
#pragma once

#include <span>
#include <string_view>

namespace hmax {

struct PublishedText {
  std::string_view name;  ///< of the file, without .csv
  std::string_view csv;
};

/// Sorted by name.
std::span<const PublishedText> published_texts();

}  // namespace hmax
