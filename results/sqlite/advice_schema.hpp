/// The table of stored advice, made of its columns.
#pragma once

#include <string>

namespace hmax {

/// Numbers carry no type, as in schema.hpp, but for those of the key.
std::string advice_schema();

}  // namespace hmax
