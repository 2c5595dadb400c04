/// A body as a scene of the simulator SOFA, so that what hmax computes can be looked at there.
#pragma once

#include <string>

#include "problems/tissue/body.hpp"

namespace hmax {

/// The text of a .scn with the mesh in the order of its file, materials, damping, gravity, dead loads,
/// supports and step: linearly implicit Euler with conjugate gradients, mass lumped on the points. fem_cauchy
/// and fem_corotational become SOFA's methods `small` and `polar`, fem_green its StVenantKirchhoff (mu,
/// lambda), fem_neo_hookean its NeoHookean (mu, bulk modulus), whose energy differs from ours away from rest.
/// SOFA's Rayleigh damping uses the tangent, ours the stiffness at rest. Regions may differ in material: one
/// force field takes E of each tetrahedron where that is all that differs in the elasticity of fem_cauchy and
/// fem_corotational; else each region is a child node with its tetrahedra and a force field of its own on the
/// points of the body. Linear springs become SOFA's, one by one, with dampers. Points in no tetrahedron are
/// held.
/// @param step  of SOFA's solver [s]
/// @throws std::invalid_argument for what SOFA's scenes are not written with here: a skin, tools,
///         forces that change with time, moving supports, springs that are not linear; and for materials and
///         steps that are not positive
std::string sofa_text(const TissueBody& body, double step);

}  // namespace hmax
