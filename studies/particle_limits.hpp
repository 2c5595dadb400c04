/// How many steps a second a body of springs needs, against the mass of its particles and the stiffness of
/// its springs.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// A mass-spring body at rest, without weight, whose particles all have one mass.
struct ParticleBody {
  std::string mesh = "liver";
  double particle_mass = 0.005;  ///< [kg]
  double young = 5300;           ///< E, from which each spring has its stiffness [Pa]
  double damper = 0;             ///< on the whole body [N s/m]: alpha = damper over its mass
  double damper_time = 0;        ///< of the springs, damper over stiffness [s]
};

Problem particle_problem(const ParticleBody& body);

/// Of its springs [N/m].
double mean_spring_stiffness(const ParticleBody& body);

/// The smallest number of steps a second [1/s], 1 / h_max, of each method. Infinity when every step is
/// unstable, 0 when no step is.
/// @throws InputError  for methods that have no prediction: those that choose their steps
std::vector<double> stable_step_rates(std::span<const Method> methods, const ParticleBody& body);

/// The stiffest of such bodies, by its E [Pa], on which a method is stable with `rate` steps a second, to one
/// part in a thousand: looked for between `softest` and `stiffest`, one of which it is when all or none are.
double stiffest_stable(const Method& method, ParticleBody body, double rate, double softest, double stiffest);

/// h lambda of every mode of the body.
/// @param h  [s]
std::vector<std::complex<double>> scaled_eigenvalues(const ParticleBody& body, double h);

/// Numbers from `low` to `high`, each the same factor above the one before: places of a curve over a
/// logarithmic axis. Shape (points), at least 2.
std::vector<double> logarithmic_places(double low, double high, int points);

/// The heaviest particle [kg] with which the body still has an equilibrium, hanging in its weight, without an
/// element turned inside out, to one part in a hundred. Springs are linear in their length, so that the
/// equilibrium depends on mass over E alone.
double heaviest_hanging(ParticleBody body);

}  // namespace hmax
