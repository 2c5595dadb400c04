/// What the thesis on deformable organs says of strain, volume and static solutions, measured on its meshes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/statics/static_solution.hpp"
#include "catalogue/methods/method.hpp"
#include "results/json.hpp"

namespace hmax {

/// Elastic energy of a free body that is turned as a whole, which strains nothing.
struct TurnedBody {
  std::string model;
  std::vector<double> angle;   ///< [degree], 0 to 90
  std::vector<double> energy;  ///< over E times the volume [1]: (the strain that the model sees)^2 / 2, about
};
/// Of all models of the mesh with nu = 0.3, turned about the x axis.
std::vector<TurnedBody> turned_bodies(std::string_view mesh);

/// A body under a load that presses it, in equilibrium.
struct PressedVolume {
  std::string model;
  double nu = 0;            ///< Poisson's ratio; that of springs is 1/4
  double displacement = 0;  ///< the largest [m]
  double lost = 0;          ///< share of the volume of the body that is lost [1]
  double spread = 0;        ///< largest relative change of the volume of a tetrahedron [1]
};
HMAX_RECORD(PressedVolume, model, nu, displacement, lost, spread);
/// Springs and Green's strain with nu = 0.3, 0.45 and 0.49, all brought to the same largest displacement.
/// @param displacement  [m]
std::vector<PressedVolume> pressed_volumes(std::string_view mesh, double displacement);

/// Newton's method, modified or not, whose linear systems are solved by SOR to a tolerance.
struct InnerTolerance {
  StaticMethod method;
  double tolerance = 0;  ///< of the linear systems, relative to their right-hand side
  bool converged = false;
  int iterations = 0;       ///< linear systems
  std::int64_t sweeps = 0;  ///< of SOR in all
  double seconds = 0;       ///< CPU time
};
/// @param model       in equilibrium to 1e-9 of its load
/// @param relaxation  of SOR
std::vector<InnerTolerance> inner_tolerances(const StaticModel& model, double relaxation);

/// What an accurate solution of the linear systems would have to save.
struct AccurateSolution {
  double iteration = 0;  ///< what an iteration costs beside its sweeps, in sweeps
  double needed = 0;     ///< from where the fewer iterations of a tolerance of 1e-4 pay for its sweeps
};
/// Of rows of Newton's method: seconds = a iterations + b sweeps by least squares, 1e-4 against 0.1.
AccurateSolution accurate_solution(const std::vector<InnerTolerance>& rows);

/// Iterations of both methods with exact linear systems under a force, all of it at once.
struct LoadedIterations {
  double force = 0;              ///< [N]
  int newton = 0, modified = 0;  ///< 0: not converged
};
HMAX_RECORD(LoadedIterations, force, newton, modified);
/// Of finite elements of Green's strain, pressed.
std::vector<LoadedIterations> loaded_iterations(std::string_view mesh, std::string_view material,
                                                const std::vector<double>& forces);

/// A linear model at rest: displacements from forces by the inverse of K, and by its factors.
struct LinearSolutions {
  Eigen::Index dofs = 0;
  double invert = 0, factor = 0;   ///< CPU time, once [s]
  double multiply = 0, solve = 0;  ///< CPU time of a displacement field [s]
  double inverse_bytes = 0;        ///< of the dense inverse
};
HMAX_RECORD(LinearSolutions, dofs, invert, factor, multiply, solve, inverse_bytes);
LinearSolutions linear_solutions(const StaticModel& model);

/// A load that is brought on within a second of `frames` frames, each of which has a number of iterations of
/// Newton's method.
struct FrameBudget {
  int iterations = 0;
  double error =
      0;  ///< the largest |q - q*| / |q*| of all frames against their equilibria [1]; NaN where it diverged
  double seconds = 0;  ///< median CPU time of a frame
};
HMAX_RECORD(FrameBudget, iterations, error, seconds);
/// One, two and four iterations, linear systems solved directly.
std::vector<FrameBudget> frame_budgets(const StaticModel& model, int frames);

}  // namespace hmax
