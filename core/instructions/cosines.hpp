/// Cosines of many numbers at once, for forces of ensembles whose members stand at different times.
#pragma once

#include <span>

#include "core/instructions/instruction_set.hpp"

namespace hmax {

/// out_i = std::cos(x_i), with the bits that the program's std::cos has.
/// Where that is the one of cmake/elementary_functions.cmake its formulas run in vector lanes, four to six
/// times as fast; otherwise std::cos is called for each number.
/// @param x, out  of the same length, in different places
/// @param set     of the vector operations; it changes times, not results
void cosines(std::span<const double> x, std::span<double> out,
             InstructionSet set = instruction_sets().front());

/// Whether std::cos is that of cmake/elementary_functions.cmake, whose bits cosine() has.
bool cosines_are_those_of_musl();

}  // namespace hmax
