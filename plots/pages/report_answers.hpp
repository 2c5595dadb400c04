/// Stored advice in words, as HTML.
#pragma once

#include <span>
#include <string>

#include "plots/pages/reported_store.hpp"

namespace hmax {

/// One element for each question of each store: what is recommended, why, and what it costs, or that nothing
/// meets the question. Empty where no store has advice.
std::string report_answers(std::span<const ReportedStore> stores);

}  // namespace hmax
