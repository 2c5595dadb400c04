/// A method of the catalogue for programs.
#pragma once

#include <nlohmann/json.hpp>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// A row of `hmax list methods --json`, docs/reference/commands/list.md.
nlohmann::ordered_json method_json(const Method& method);

}  // namespace hmax
