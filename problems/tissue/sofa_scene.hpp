/// The same body as a scene of the simulator SOFA, so that what hmax computes can be looked at there.
#pragma once

#include <string>
#include <vector>

#include "problems/tissue/tet_mesh.hpp"

namespace hmax {

/// How SOFA computes the elastic force; each is one of its force fields.
enum class SofaMaterial { cauchy, corotational, green, neo_hookean };

struct SofaScene {
  TetMesh mesh;
  SofaMaterial material = SofaMaterial::corotational;
  double young = 0, poisson = 0;           ///< [Pa], [1]
  double density = 0;                      ///< [kg/m^3]
  double alpha = 0, beta = 0;              ///< Rayleigh damping: alpha M [1/s], beta K [s]
  Eigen::Vector3d gravity{0, 0, 0};        ///< [m/s^2]
  double step = 0.01;                      ///< of SOFA's implicit Euler [s]
  std::vector<TetMesh::Index> fixed = {};  ///< points that do not move
};

/// The text of a .scn: linearly implicit Euler with conjugate gradients, mass lumped on the points. SOFA's
/// materials take mu and lambda (green) or mu and the bulk modulus (neo_hookean).
/// @throws std::invalid_argument for constants that are no material, steps that are not positive, points
///         that the mesh does not have
std::string sofa_text(const SofaScene& scene);

}  // namespace hmax
