/// What organs are made of: stress against strain of a parenchyma and of a skin, and what a skin does.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "results/json.hpp"

namespace hmax {

/// Nominal stress of a bar that is stretched along its axis and free at its sides.
struct StressCurve {
  std::string law;
  std::vector<double> strain;  ///< -0.3 to 0.5 [1]
  std::vector<double> stress;  ///< force over the section at rest [Pa]
};
/// Of the elastic laws of the mesh models, and of springs with phi = (exp(b s) - 1) / b, b = 5.
/// @param young    E [Pa]
/// @param poisson  nu [1]
std::vector<StressCurve> stress_curves(double young, double poisson);

/// A body with and without a skin, pressed with the same force.
struct SkinEffect {
  double relative = 0;               ///< E of the skin over that of the parenchyma [1]
  double bare = 0, skinned = 0;      ///< largest displacement in equilibrium [m]
  double h_bare = 0, h_skinned = 0;  ///< largest stable step of symplectic Euler at rest [s]
};
HMAX_RECORD(SkinEffect, relative, bare, skinned, h_bare, h_skinned);
/// Of finite elements of Green's strain under 0.2 N, with a membrane of 0.1 mm that is 1000 times as stiff.
SkinEffect skin_effect(std::string_view mesh, std::string_view material);

}  // namespace hmax
