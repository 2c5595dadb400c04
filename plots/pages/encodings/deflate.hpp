/// Text made small for a page whose script unpacks it.
#pragma once

#include <string>
#include <string_view>

namespace hmax {

/// `text` in the zlib format of RFC 1950; empty where hmax was built without zlib.
std::string deflated(std::string_view text);

}  // namespace hmax
