/// What the subcommands say of a body on a mesh before they answer: what it was taken to be.
#pragma once

#include <string>

#include "catalogue/methods/method.hpp"
#include "cli/shared/console.hpp"

namespace hmax {

/// "507 points, 1953 tetrahedra, ...; E 5500 Pa, ...", two lines without the last break; of matrices one
/// line; empty of all others.
std::string body_in_words(const Problem& problem);

/// Says on standard error which values are unusual for tissue, as slips in units make them, and what stands
/// out in matrices.
void remark_unusual(Console& console, const Problem& problem);

/// Says on standard error what a tool does not do that it should, if there is such a thing.
void warn_of_tool(Console& console, const Problem& problem, double t, const Eigen::VectorXd& y);

/// A damping ratio, of which less than a millionth is rounding; "-" of NaN.
std::string damping_in_words(double zeta);

}  // namespace hmax
