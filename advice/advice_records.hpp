/// Advice as rows of a store.
#pragma once

#include <vector>

#include "advice/advise.hpp"
#include "results/advice_record.hpp"

namespace hmax {

/// What identifies a question about a problem. The motion is the one that was found for it.
AdviceKey advice_key(const Problem& problem, const AdviceQuestion& question, const Advice& advice);

/// Every row, best first; AdviceRecord::key is left.
std::vector<AdviceRecord> advice_records(const Advice& advice);

}  // namespace hmax
