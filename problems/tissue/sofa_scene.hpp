/// A body as a scene of the simulator SOFA, so that what hmax computes can be looked at there.
#pragma once

#include <string>

#include "problems/tissue/body.hpp"

namespace hmax {

/// How a scene is stepped: the components EulerImplicitSolver, NewmarkImplicitSolver, EulerExplicitSolver
/// with and without `symplectic`, and RungeKutta4Solver. Implicit ones solve their linear equations by
/// conjugate gradients.
struct SofaStep {
  enum class Solver { implicit_euler, newmark, symplectic_euler, explicit_euler, runge_kutta_4 };
  double h = 0.01;  ///< [s]
  Solver solver = Solver::implicit_euler;
  double beta = 0.25, gamma = 0.5;  ///< of Newmark
};

/// @throws std::invalid_argument for what SOFA's scenes are not written with here: a skin, tools,
///         masses that mass_step adds, forces that change with time, moving supports, springs that are not
///         linear; damping by stiffness in explicit solvers; and for materials and steps that are not
///         positive
void check_sofa_scene(const TissueSettings& settings, const SofaStep& step);

/// The text of a .scn with the mesh in the order of its file, materials, damping, gravity, dead loads,
/// supports and step, mass lumped on the points. fem_cauchy and fem_corotational become SOFA's methods
/// `small` and `polar`, fem_green its StVenantKirchhoff (mu, lambda), fem_neo_hookean its NeoHookean (mu,
/// bulk modulus), whose energy differs from ours away from rest. SOFA's Rayleigh damping uses the tangent,
/// ours the stiffness at rest; its explicit solvers have none, so that alpha M becomes a
/// DiagonalVelocityDampingForceField. Regions may differ in material: one force field takes E of each
/// tetrahedron where that is all that differs in the elasticity of fem_cauchy and fem_corotational; else each
/// region is a child node with its tetrahedra and a force field of its own on the points of the body. Linear
/// springs become SOFA's, one by one, with dampers. Points in no tetrahedron are held.
/// @throws std::invalid_argument  as check_sofa_scene()
std::string sofa_text(const TissueBody& body, const SofaStep& step);

}  // namespace hmax
