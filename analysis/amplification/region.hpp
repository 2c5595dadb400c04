/// The stability region of a method in the plane of z = h lambda: its boundary as closed curves.
#pragma once

#include <functional>
#include <vector>

#include "analysis/amplification/amplification.hpp"

namespace hmax {

/// A rectangle of the complex plane.
struct PlaneWindow {
  double re_from = 0, re_to = 0, im_from = 0, im_to = 0;
};

/// A closed curve, its first point not repeated; the region lies to its left, so that outlines run
/// counter-clockwise and holes clockwise.
struct RegionCurve {
  std::vector<Complex> points;
  bool clipped = false;  ///< parts of it are the edge of the window

  /// The area that it encloses, negative for holes.
  /// By the shoelace formula, half of sum (x_i y_i+1 - x_i+1 y_i).
  [[nodiscard]] double area() const;
};

/// Whether the method is stable at z. The functions that take it expect the same answer at conj(z).
/// z = h lambda has no unit. The region of a real method is symmetric about the real axis.
using StableAt = std::function<bool(Complex z)>;

/// Of an amplification, decided without roots where there is a polynomial.
StableAt stable_at(const Amplification& amplification);

/// The boundary of the region inside the window: the outline of every piece and of every hole that a grid of
/// cells x cells squares sees, each crossing of a grid line located by bisection. What leaves the window is
/// closed along its edge.
/// Features narrower than a cell may be missed. Marching squares; a point is located to 2^-45 of a cell.
/// @return  the largest area first
/// @param cells  along the longer side, >= 2
/// @throws std::invalid_argument for an empty window or too few cells
std::vector<RegionCurve> region_boundary(const StableAt& is_stable, const PlaneWindow& window,
                                         int cells = 400);

/// A window with equal scales that shows the region of a method whose region is bounded, or the instability
/// of one whose is not.
/// Bounded: 1.2 times the farthest exit of the rays at 91 to 180 degrees to the left. Else it reaches
/// beyond the end of the unstable interval on the positive real axis.
PlaneWindow window_of(const Amplification& amplification);

}  // namespace hmax
