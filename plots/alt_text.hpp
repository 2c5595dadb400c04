/// What a figure shows in words, for those who cannot see it.
#pragma once

#include <filesystem>
#include <string>

#include "plots/figure.hpp"

namespace hmax {

/// Title, axes of each panel, and what the key lists: "Title. Error [m] (logarithmic) over h [s]. Shown: rk4,
/// ode45." On one line; of many panels and of a long key the first are named and the others counted.
std::string alt_text(const Figure& figure);

/// Puts title and description of a figure in the place of gnuplot's own into an SVG that it has drawn.
void describe_svg(const std::filesystem::path& svg, const std::string& title, const std::string& description);

}  // namespace hmax
