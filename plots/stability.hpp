/// Panels of stability: regions of the plane of z = h lambda on equal scales, levels of |R|, and the charts
/// of methods that step positions and velocities.
#pragma once

#include <string>
#include <vector>

#include "plots/curves.hpp"
#include "plots/figure.hpp"

namespace hmax {

/// A part of the plane and the height of the panel that shows it with one unit equally long on both axes.
struct PlaneFrame {
  Range re = {}, im = {};
  int height = 0;  ///< as Figure::panel_height
};

/// The frame around a rectangle: the height that it asks for within the limits, and beyond them the rectangle
/// widened about its middle.
PlaneFrame equal_frame(Range re, Range im, int columns, int least_height = 170, int most_height = 520);

/// A region by its rim, in the units of the axes.
struct RegionShape {
  std::string label = {};              ///< in the key; empty: not in the key
  std::vector<PlaneCurve> loops = {};  ///< closed, the first point not repeated; the region to their left
};

/// What the axes are called.
struct PlaneAxes {
  std::string re = "Re hλ [1]", im = "Im hλ [1]";
};

/// One region, lightly filled, its holes left white. The rim is not drawn where it runs along the frame.
Panel region_panel(const RegionShape& region, const PlaneFrame& frame, const PlaneAxes& axes = {},
                   int colour = 0);

/// The rims of several regions, each with the colour and the dash of its place and with short strokes that
/// point into the region.
Panel regions_panel(const std::vector<RegionShape>& regions, const PlaneFrame& frame,
                    const PlaneAxes& axes = {});

/// The part of the plane where the spectral radius is at most `level`.
struct FieldLevel {
  double level = 0;
  RegionShape region = {};
};

/// Bands between levels, blue where a step damps and the deeper the more it does, vermillion where it
/// amplifies.
/// @param levels    descending
/// @param boundary  of the stability region, drawn in black
Panel field_panel(const std::vector<FieldLevel>& levels, const RegionShape& boundary, const PlaneFrame& frame,
                  const PlaneAxes& axes = {});

/// The largest stable omega h over the damping ratio.
struct OscillationLimit {
  std::string label = {};
  std::vector<double> zeta = {}, omega_h = {};  ///< equal length; infinity where every step is stable
};

/// What is stable lies to the left of the curve; one alone is filled, of several the curves are drawn.
Panel oscillation_panel(const std::vector<OscillationLimit>& limits);

}  // namespace hmax
