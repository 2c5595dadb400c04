#include "advice/advice.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hmax {

std::string error_scale(const Problem& problem) {
  return problem.body ? "largest displacement" : "range of each state";
}

std::string_view name_of(AdviceBound bound) {
  constexpr std::array<std::string_view, 5> names{"stability", "accuracy", "newton", "budget", "rate"};
  return names[static_cast<std::size_t>(bound)];
}

std::string_view name_of(AdviceVerdict verdict) {
  constexpr std::array<std::string_view, 7> names{"recommended", "tie",      "suitable", "unstable",
                                                  "inaccurate",  "too_slow", "predicted"};
  return names[static_cast<std::size_t>(verdict)];
}

std::string_view name_of(AdviceStage stage) {
  constexpr std::array<std::string_view, 7> names{"predicting", "searching", "timing", "proving",
                                                  "observing",  "remedies",  "done"};
  return names[static_cast<std::size_t>(stage)];
}

double time_to_meet(const AdviceRow& row, double tolerance) {
  const double order = std::max(1, row.candidate.method.order);
  const double more = std::isnan(row.error) ? 1 : std::pow(row.error / tolerance, 1 / order);
  return row.frame_time() * std::max(1.0, more);
}

}  // namespace hmax
