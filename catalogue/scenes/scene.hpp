/// Scenes of other programs as bodies of hmax (catalogue/models/tissue_problem.hpp): a subset of each
/// format, and what is not in it is refused by name.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// A body, and how the program that the scene is of steps it.
struct Scene {
  std::string model;               ///< part of tissue_id(); its load is gravity
  ProblemSettings settings;        ///< SI, with the unit of the mesh
  std::string integrator;          ///< as the file calls it; empty: none
  std::string method;              ///< of hmax, with its parameters: "hht_alpha:alpha=-0.05"
  std::optional<double> step;      ///< of the file [s]
  std::vector<std::string> notes;  ///< sentences: what was left out, and what differs from that program
};

/// Reads CalculiX and Abaqus .inp: *NODE, *ELEMENT of C3D4, *NSET, *ELSET, *SOLID SECTION; *MATERIAL with
/// *ELASTIC, *DENSITY and *DAMPING; *BOUNDARY that fixes directions 1 to 3; *DLOAD of GRAV; one *STEP with
/// *DYNAMIC, *STATIC or *FREQUENCY. SOFA .scn: one body of tetrahedra, in the file or from one that a loader
/// names; TetrahedronFEMForceField and the like, UniformMass, DiagonalMass, FixedProjectiveConstraint,
/// BoxROI; implicit and explicit Euler, Newmark and Runge-Kutta solvers. FEBio .feb of format 4.0: tet4 of
/// isotropic elastic and neo-Hookean solids, zero displacements, static and dynamic analyses.
/// @param units    of length, mass and time, which files do not say: "m,kg,s", "mm,t,s", or numbers of
///                 metres, kilograms and seconds
/// @param ignored  parts that are left out where they are not understood: "CLOAD,BOUNDARY"
/// @throws InputError  one sentence with file, line and remedy
Scene read_scene(const std::string& file, std::string_view units, std::string_view ignored);

}  // namespace hmax
