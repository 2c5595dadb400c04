/// What the subcommands of `hmax stability` share.
#pragma once

#include "cli/console.hpp"

namespace hmax {

/// A number, "unbounded" for infinity, null for NaN.
nlohmann::ordered_json number_or_word(double value);

void add_stability_predict(CLI::App& stability, Console& console);

}  // namespace hmax
