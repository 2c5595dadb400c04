/// A body as a scene of the simulator SOFA, so that what hmax computes can be looked at there.
#pragma once

#include <string>

#include "problems/tissue/tet_mesh.hpp"
#include "problems/tissue/tissue_settings.hpp"

namespace hmax {

/// The text of a .scn with the mesh, material, damping, gravity, supports and step: linearly implicit Euler
/// with conjugate gradients, mass lumped on the points. fem_cauchy and fem_corotational become SOFA's methods
/// `small` and `polar`, fem_green its StVenantKirchhoff (mu, lambda), fem_neo_hookean its NeoHookean (mu,
/// bulk modulus), whose energy differs from ours away from rest. SOFA's Rayleigh damping uses the tangent,
/// ours the stiffness at rest.
/// @param step  of SOFA's solver [s]
/// @throws std::invalid_argument for what SOFA's scenes are not written with here: springs, several
/// materials, a
///         skin, tools, forces, moving supports; for constants that are no material, and steps that are not
///         positive
std::string sofa_text(const TetMesh& mesh, const TissueSettings& settings, double step);

}  // namespace hmax
