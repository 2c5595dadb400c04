/// Sorted values, each once.
#pragma once

#include <algorithm>

namespace hmax {

/// @param values  a vector
template <class Values>
void sort_unique(Values& values) {
  std::ranges::sort(values);
  const auto doubled = std::ranges::unique(values);
  values.erase(doubled.begin(), doubled.end());
}

}  // namespace hmax
