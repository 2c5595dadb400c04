/// Numbers of things in words.
#pragma once

#include <string>
#include <string_view>

#include <fmt/format.h>

namespace hmax {

/// "1 step", "2 steps"
template <class Count>
std::string counted(Count count, std::string_view one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

}  // namespace hmax
