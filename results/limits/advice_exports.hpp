/// Stored advice in the forms that other programs read.
#pragma once

#include <span>
#include <string>

#include "results/advice_record.hpp"

namespace hmax {

/// One header line, one line for each method of each question. A number that does not apply is an empty cell,
/// a limit that no step reaches is "unbounded"; steps, limits and times in s.
std::string advice_to_csv(std::span<const AdviceRecord> records);

/// The same as one JSON object per line; a number that does not apply is null.
std::string advice_to_jsonl(std::span<const AdviceRecord> records);

}  // namespace hmax
