/// Scenes of other programs as bodies of hmax (catalogue/models/tissue_problem.hpp): a subset of each
/// format, and what is not in it is refused by name.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/sofa_scene.hpp"

namespace hmax {

/// A body, and how the program that the scene is of steps it.
struct Scene {
  std::string model;           ///< part of tissue_id(); its load is gravity, with forces on points beside it
  ProblemSettings settings;    ///< SI, with the unit of the mesh
  std::string integrator;      ///< as the file calls it; empty: none
  std::string method;          ///< of hmax, with its parameters: "hht_alpha:alpha=-0.05"
  std::optional<double> step;  ///< of the file [s]
  std::string gradients;  ///< the most conjugate gradients of a solve; empty: that program has other solvers
  std::vector<std::string> notes;  ///< sentences: what was left out, and what differs from that program
  /// Where the numbers of materials stand: "bar.inp, line 7" of "nu:TIP".
  std::map<std::string, std::string> places;
  std::map<TetMesh::Index, std::string> regions;  ///< by the numbers of the file: names
};

/// Reads CalculiX and Abaqus .inp: *NODE, *ELEMENT of C3D4, *NSET, *ELSET, *SOLID SECTION, *INCLUDE, one
/// *PART and *INSTANCE; *MATERIAL with *ELASTIC, *DENSITY and *DAMPING; *BOUNDARY that fixes directions 1 to
/// 3; *CLOAD, *DLOAD of GRAV, *AMPLITUDE of one value; one *STEP with *DYNAMIC, *STATIC or *FREQUENCY. SOFA
/// .scn: one body of tetrahedra, in the file or from one that a loader names; TetrahedronFEMForceField and
/// the like, also of nodes below, springs on all edges, masses, FixedProjectiveConstraint, BoxROI,
/// ConstantForceField; implicit and explicit Euler, Newmark and Runge-Kutta solvers. FEBio .feb of format
/// 4.0: tet4 of isotropic elastic and neo-Hookean solids, zero displacements, nodal and constant body loads,
/// static and dynamic analyses. MuJoCo .xml: one flexcomp of dim 3 with elasticity and pins, of type grid,
/// direct or gmsh, that only gravity acts on; its option.
/// @param units    of length, mass and time, which files do not say: "m,kg,s", "mm,t,s", or numbers of
///                 metres, kilograms and seconds
/// @param ignored  parts that are left out where they are not understood: "CLOAD,BOUNDARY"
/// @throws InputError  one sentence with file, line and remedy
Scene read_scene(const std::string& file, std::string_view units, std::string_view ignored);

/// The solver of SOFA that steps as a method does, "newmark:gamma=0.6", for sofa_text().
/// @throws InputError  where it has none
SofaStep sofa_step(const std::string& method, double h);

/// The ids of the methods that have one.
std::vector<std::string> sofa_methods();

/// The scene's numbers without those that others replace: of `name` alone, of the whole body and so of every
/// region, or of one region, which may be called by its number in place of its name.
/// @param name  "E", "nu:TIP", "nu:2"
void leave_out(const Scene& scene, Parameters& parameters, const std::string& name);

/// @throws InputError  naming the line, for moduli, Poisson's ratios and densities out of range
void require_in_range(const Scene& scene, const Parameters& parameters);

}  // namespace hmax
