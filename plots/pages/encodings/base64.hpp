/// Bytes as text of 64 characters and back (RFC 4648, section 4).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace hmax {

/// With padding, without line breaks.
std::string base64(std::string_view bytes);

/// What `base64` has written; nullopt for any other text, also without its padding.
std::optional<std::string> base64_bytes(std::string_view text);

}  // namespace hmax
