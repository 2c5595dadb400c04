#include "limits/point/prediction.hpp"

#include <array>

namespace hmax {

std::string_view name_of(Bound bound) {
  constexpr std::array<std::string_view, 7> names{"stability",  "accuracy",      "newton", "model",
                                                  "every_step", "error_control", "unknown"};
  return names[static_cast<std::size_t>(bound)];
}

void scale_steps(Prediction& row, double factor) {
  if (row.h_max) *row.h_max *= factor;
  if (row.unstable_from) *row.unstable_from *= factor;
  for (ModeMargin& margin : row.modes) margin.h_max *= factor;
  if (row.coupled) row.coupled->h_max *= factor;
  if (row.newton_step) row.newton_step->h *= factor;
  if (row.observed) row.observed->h_max *= factor;
}

}  // namespace hmax
