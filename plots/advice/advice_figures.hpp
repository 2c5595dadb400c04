/// Figures of an answer of `hmax advise`: what its rows cost and how far they are off, and their steps beside
/// the limits.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plots/figure.hpp"
#include "results/advice_record.hpp"

namespace hmax {

/// Error of each row over the median CPU time of a frame, with lines at tolerance and budget; what meets both
/// lies in the tinted corner. The recommended row has its name. Rows with an error above 1 are marks in the
/// strip at the top.
/// @param error_of  what errors are relative to: "largest displacement"
Figure advice_cost_figure(const AdviceKey& question, const std::vector<AdviceRecord>& rows,
                          const std::string& error_of);

/// Step, predicted and observed limit of each row that has a limit, the first row at the top; nothing where
/// none has.
std::optional<Figure> advice_step_figure(const std::vector<AdviceRecord>& rows);

}  // namespace hmax
