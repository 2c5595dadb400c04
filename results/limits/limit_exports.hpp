/// Stored limits in the forms that other programs read.
#pragma once

#include <span>
#include <string>

#include "results/limit_row.hpp"

namespace hmax {

/// One header line, one line per limit: every column of a limit but its details. A number that does not apply
/// is an empty cell, a limit that no step reaches is "unbounded"; steps and limits in s.
std::string limits_to_csv(std::span<const LimitRow> rows);

/// The same as one JSON object per line; a number that does not apply is null.
std::string limits_to_jsonl(std::span<const LimitRow> rows);

/// The name of a limit where stores are compared: problem, material, parameters, state, path and method.
std::string limit_name(const LimitRow& row);

}  // namespace hmax
