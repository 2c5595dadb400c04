/// The fastest mode of a body at rest: bounds beside it, the element that owns it, and what changing that
/// element would gain.
#pragma once

#include <optional>
#include <vector>

#include "analysis/spectrum/element_bounds.hpp"
#include "limits/point/operating_point.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

/// The elements of a body on its free points, with the stiffness at rest.
ElementSum elements_of(const TissueBody& body);

/// What the elements of a body share its masses by: volume times density where all of them are tetrahedra,
/// otherwise nothing, which stands for stiffness.
std::vector<double> mass_weights(const TissueBody& body);

struct FastestMode {
  double kappa = 0;     ///< the largest eigenvalue of M^-1 K [1/s^2]
  double residual = 0;  ///< relative, of the Lanczos iteration
  Eigen::VectorXd shape;
  StiffnessBounds bounds;
  ModeOwner owner;
  std::vector<TissueBody::Index> points;  ///< of the owner
  Eigen::Vector3d centre;                 ///< of the owner at rest [m]

  // By what factors an undamped step limited by 2 / sqrt(kappa) would grow.
  double without = 1;     ///< the owner taken out with its share of the masses
  double with_mass = 1;   ///< its share of the masses doubled
  double added_mass = 0;  ///< what that adds to the whole body, as a share of it
  double smoothed = 1;    ///< the best of moves of one of its inner points towards the mean of its neighbours
  /// Which that was, in hmax's order; empty where none helped or there is no inner point.
  std::optional<TissueBody::Index> moved_point;
};

/// @cost  some ten to twenty Lanczos iterations; without gains one
FastestMode fastest_mode_of(const TissueBody& body, bool with_gains = true);
/// The same without an iteration for the mode where `near`, the body linearised, holds it.
FastestMode fastest_mode_of(const TissueBody& body, const Linearised& near, bool with_gains);

}  // namespace hmax
