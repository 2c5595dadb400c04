/// The fastest mode of a body at rest: the element that owns it, bounds of it, and what changes would gain.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "limits/predict.hpp"

namespace hmax {

/// With the ratios by which bounds of it make steps too small.
nlohmann::ordered_json fastest_mode_json(const Problem& problem, const Linearised& near);

/// The same in lines of words.
std::string fastest_mode_in_words(const Problem& problem, const Linearised& near);

}  // namespace hmax
