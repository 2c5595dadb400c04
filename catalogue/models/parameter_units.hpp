/// The units of the parameters of models, for axes and tables.
#pragma once

#include <string>
#include <string_view>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// "E [Pa]", "nu [1]"; of one region "E:tumour [Pa]". The name alone where the unit is not known, as of
/// formulas.
std::string with_unit(const Problem& problem, std::string_view parameter);

}  // namespace hmax
