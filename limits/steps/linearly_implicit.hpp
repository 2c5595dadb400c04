/// The linearly implicit methods of the catalogue by the coefficients that they step with.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "analysis/step_limits/frozen_jacobian.hpp"

namespace hmax {

/// Their ids.
std::vector<std::string_view> linearly_implicit_ids();

/// Nothing for methods that are none.
std::optional<LinearlyImplicitMethod> linearly_implicit_method(std::string_view id);

}  // namespace hmax
