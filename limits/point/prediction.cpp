#include "limits/point/prediction.hpp"

#include <array>

namespace hmax {

std::string_view name_of(Bound bound) {
  constexpr std::array<std::string_view, 7> names{"stability",  "accuracy",      "newton", "model",
                                                  "every_step", "error_control", "unknown"};
  return names[static_cast<std::size_t>(bound)];
}

}  // namespace hmax
