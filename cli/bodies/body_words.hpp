/// What the subcommands say of a body on a mesh before they answer: what it was taken to be.
#pragma once

#include <string>

#include "catalogue/methods/method.hpp"
#include "catalogue/models/body_summary.hpp"
#include "cli/shared/console.hpp"

namespace hmax {

/// "507 points, 1953 tetrahedra, ...; E 5500 Pa, ...", two lines without the last break; of matrices one
/// line; empty of all others.
std::string body_in_words(const Problem& problem);

/// The same for programs: `{E, nu, rho, regions, mass, size, points, held, gravity, unusual}`; null of what
/// is no body.
nlohmann::ordered_json body_json(const Problem& problem);
nlohmann::ordered_json body_json(const BodySummary& body);

/// What is known of matrices, for programs: `{files, unknowns, rows, mass_sum, ..}`; null of what is none.
nlohmann::ordered_json matrices_json(const Problem& problem);

/// Says on standard error which values are unusual for tissue, as slips in units make them, and what stands
/// out in matrices.
void remark_unusual(Console& console, const Problem& problem);

}  // namespace hmax
