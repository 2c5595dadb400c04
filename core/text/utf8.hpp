/// The characters of UTF-8 (RFC 3629). File names are bytes: they need not be UTF-8.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hmax {

/// The bytes of the character at the start of `text`, which is not empty; 0 when there is none.
std::size_t utf8_character(std::string_view text);

/// `text` with \xE9 for each byte, here E9, that is part of no character. UTF-8 stays as it is.
std::string as_utf8(std::string_view text);

}  // namespace hmax
