/// Eigenvalues on their way out of a stability region as the step grows: an SVG that moves by itself.
#pragma once

#include <string>
#include <vector>

#include "plots/curves.hpp"
#include "plots/stability.hpp"

namespace hmax {

/// An eigenvalue, and the step at which h lambda leaves the region for the first time.
struct SlidingPoint {
  double re = 0, im = 0;  ///< lambda [1/s]
  double exit = 0;        ///< [s]; infinity when it never does
};

/// The spectrum of one model.
struct SlidingSpectrum {
  std::string label = {};
  std::vector<SlidingPoint> points = {};

  /// The first of the exits.
  [[nodiscard]] double largest_step() const;
};

/// One method and several models.
struct SlidingPicture {
  std::string title = {};
  std::vector<PlaneCurve> region = {};  ///< as RegionShape::loops
  Range re = {}, im = {};               ///< of the plane that is shown
  std::vector<SlidingSpectrum> spectra = {};
  double end = 1;  ///< h runs from 0 to this [s]
};

/// The moving picture, as text of an SVG without scripts: SMIL moves the points along their rays and turns
/// those red that are outside, the step is written. Where nothing moves, it stands at 40 % of the way.
std::string sliding_svg(const SlidingPicture& picture);

/// The same at a few steps, side by side, for where nothing moves.
/// @param steps  [s]
std::string sliding_frames_svg(const SlidingPicture& picture, const std::vector<double>& steps);

}  // namespace hmax
