/// A body as the module of Bullet reads it.
#pragma once

#include <string>

#include "problems/tissue/body.hpp"

namespace hmax {

/// Of one material. Lines: the force of Bullet, E, nu, alpha, beta, gravity x, y, z, counts of points and
/// tetrahedra; of each point its place, its mass, and 1 where it is fixed; of each tetrahedron its points.
/// All in SI units. fem_neo_hookean becomes btDeformableNeoHookeanForce, fem_corotational
/// btDeformableLinearElasticityForce.
/// @throws std::invalid_argument  for what these do not have: other models, several materials, skins, fibres,
///         tools, forces, supports that move or give way, and mass damping of fem_neo_hookean
std::string bullet_text(const TissueBody& body);

}  // namespace hmax
