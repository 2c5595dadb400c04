/// Text that a page shows as it is.
#pragma once

#include <string>
#include <string_view>

namespace hmax {

/// `text` on one line, with the characters of markup replaced; bytes that are not UTF-8 become '?'.
std::string html_text(std::string_view text);

}  // namespace hmax
