/// Standard error when nothing else can be relied on: no memory, no room, no terminal.
#pragma once

#include <initializer_list>
#include <string_view>

namespace hmax {

/// Writes to standard error as it is. What cannot be written is dropped.
void write_error(std::string_view text) noexcept;

/// Writes "hmax: " and the parts as one line. Control characters, as names that were typed may have them, are
/// shown and not sent to the terminal. Allocates nothing.
void tell(std::initializer_list<std::string_view> parts) noexcept;

/// Opens the null device in place of standard streams that are closed, so that no file gets their numbers.
void open_closed_streams() noexcept;

}  // namespace hmax
