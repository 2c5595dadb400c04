/// Errors that reach a user, with what they tell put in its place.
#pragma once

#include <utility>

#include <fmt/format.h>

#include "core/errors.hpp"

namespace hmax {

/// @param text  as of fmt::format()
template <class... T>
[[nodiscard]] InputError input_error(fmt::format_string<T...> text, T&&... values) {
  return InputError(fmt::format(text, std::forward<T>(values)...));
}

}  // namespace hmax
