/// A body identified backwards from its motion: elasticity and damping from displacements over time.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "results/json.hpp"

namespace hmax {

/// A model fitted to the measured motion.
struct FittedMotion {
  std::string model;
  double young = 0;   ///< E [Pa]
  double alpha = 0;   ///< damping over mass [1/s]
  double misfit = 0;  ///< root of the squared differences over that of the displacements [1]
  int runs = 0;       ///< of the model
};
HMAX_RECORD(FittedMotion, model, young, alpha, misfit, runs);

/// A phantom that a force begins to press, its motion measured with noise, and what models make of it.
struct IdentifiedMotion {
  double young = 4700, alpha = 7;  ///< of the measured body of finite elements, Green's strain
  double noise = 0.01;             ///< of each number, over the largest displacement [1]
  long numbers = 0;                ///< measured
  std::vector<FittedMotion> fits;  ///< by the model that was measured, and by springs
};
HMAX_RECORD(IdentifiedMotion, young, alpha, noise, numbers, fits);

/// The measured motion is that of an adaptive method of order 8, models are run with fixed steps of RK4.
/// Least squares by Gauss-Newton in the logarithms of E and alpha, from E = 10 kPa and alpha = 2 / s.
IdentifiedMotion identified_motion(std::string_view mesh, std::uint64_t seed = 1);

}  // namespace hmax
