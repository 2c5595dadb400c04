/// The modes of matrices of a user, as text and JSON.
#pragma once

#include "catalogue/methods/method.hpp"
#include "cli/shared/console.hpp"
#include "limits/point/operating_point.hpp"

namespace hmax {

/// Prints the slowest or the fastest modes of a problem of matrices, and which unknowns move in them.
/// @param count  at least 1
/// @throws InputError  for a first-order model, a stiffness that is not symmetric, and iterations that do not
/// converge
void print_matrix_modes(const Problem& problem, const OperatingPoint& point, Eigen::Index count, bool fastest,
                        Console& console);

}  // namespace hmax
