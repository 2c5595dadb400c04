/// The matrices of a model as files.
#pragma once

#include <string>

#include "catalogue/methods/method.hpp"
#include "cli/shared/console.hpp"
#include "limits/point/operating_point.hpp"

namespace hmax {

/// Writes stiffness.mtx, mass.mtx and damping.mtx, or jacobian.mtx of a first-order model, into a folder, and
/// says so; the folder is made if needed. Of a body stiffness.dof names the unknowns, whose order is that of
/// hmax: 12.3 is direction 3 of point 12 of the mesh file, or of the mesh by name.
/// @throws InputError  where the folder cannot be made
void write_matrices(const Problem& problem, const OperatingPoint& point, const std::string& folder,
                    Console& console);

}  // namespace hmax
