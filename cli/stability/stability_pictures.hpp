/// Stability as pictures: from formulas and their amplification to the panels of plots.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/amplification/region.hpp"
#include "catalogue/methods/choice/formulas.hpp"
#include "plots/stability.hpp"

namespace hmax {

/// What is told of every point of the plane.
enum class PlaneView {
  region,      ///< whether a step is stable
  field,       ///< the spectral radius, in levels
  order_star,  ///< whether a step amplifies more than the equation, |R(z) e^-z| > 1
};

/// A look at the plane of z = h lambda, or at z over the evaluations of f that a step costs.
struct PlaneLook {
  PlaneView view = PlaneView::region;
  bool per_evaluation = false;
  std::optional<PlaneWindow> window = {};  ///< in the units of the axes; one that fits when absent
  int cells = 400;
};

/// The boundary of a region, in the plane of z = h lambda, as figures take it.
RegionShape shape_of(const std::string& label, const std::vector<RegionCurve>& curves);

/// @throws InputError where a formula cannot be looked at so
void expect_look(const Formula& formula, const PlaneLook& look);

/// The window of the look, or one that fits the formula, in the units of the axes.
PlaneWindow window_of(const Formula& formula, const PlaneLook& look);

/// The rims of what is stable or, for order stars, of what amplifies more than the equation; in the units of
/// the axes.
std::vector<RegionCurve> curves_of(const Formula& formula, const PlaneLook& look, const PlaneWindow& window);

/// One formula; methods of positions and velocities as their chart over the damping ratio where they are
/// asked for their region in z.
Panel panel_of(const Formula& formula, const PlaneLook& look, int columns, int least_height, int most_height,
               int* height = nullptr);

/// A picture of one, or of several on one pair of axes (fields and order stars: one panel each), and what its
/// file is called.
struct NamedFigure {
  Figure figure = {};
  std::string name = {};
};
NamedFigure picture_of(const std::vector<Formula>& formulas, const PlaneLook& look);

/// Two lines: the stable intervals, and what becomes of fast modes.
std::vector<std::string> limits_in_words(const Formula& formula);

/// The id with characters that file names can have.
std::string file_stem(const std::string& id);

}  // namespace hmax
