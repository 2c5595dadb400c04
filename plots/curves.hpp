/// Panels of stored curves: series over time and phase planes.
#pragma once

#include <array>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "plots/figure.hpp"
#include "results/table.hpp"

namespace hmax {

/// A stored curve and what distinguishes it: "c = 2 N s/m".
struct LabelledTable {
  std::string label;
  Table table;
};

/// One curve per table, column `y` against column `x`. The k-th table has the k-th style of the family, so
/// the same tables in another panel of the figure share its key. Each curve ends at its first point that is
/// not finite.
/// @throws InputError when a table lacks a column (label and known columns named) or its columns differ in
/// length
Panel series_panel(const std::string& title, const std::vector<LabelledTable>& tables, const std::string& x,
                   const std::string& y);

/// One panel per column of `ys`, one above the other, over the same x: displacement, velocity, acceleration.
Figure series_figure(const std::string& title, const std::vector<LabelledTable>& tables,
                     const std::vector<std::string>& ys = {"x [m]"}, const std::string& x = "t [s]");

/// A point of rest in a phase plane, as the analysis found it.
struct RestPoint {
  double x, v;
  std::string type;                                 ///< stable_node, stable_focus, centre, saddle, ...
  std::array<std::complex<double>, 2> eigenvalues;  ///< [1/s]
};

/// The marker of a point of rest by its type: filled where stable, open where unstable; squares nodes,
/// circles foci; a diamond a centre, a cross a saddle, a star what is degenerate.
int marker_of(const std::string& type);

/// "stable focus" of stable_focus.
std::string type_in_words(std::string type);

/// Points of a curve in the plane.
using PlaneCurve = std::vector<std::array<double, 2>>;

/// Any container of containers of points p with p(0) and p(1), such as the nullclines of the analysis.
template <class Polylines>
std::vector<PlaneCurve> plane_curves(const Polylines& polylines) {
  std::vector<PlaneCurve> curves;
  for (const auto& polyline : polylines) {
    curves.emplace_back();
    for (const auto& point : polyline) curves.back().push_back({point(0), point(1)});
  }
  return curves;
}

/// Whether two eigenvalues are a conjugate pair. Rounding splits a double one into a pair about
/// sqrt(epsilon) apart.
bool are_conjugate(const std::array<std::complex<double>, 2>& eigenvalues);

/// What a phase plane shows; everything but the orbits may be absent.
struct PhasePlane {
  std::string title = {};
  std::vector<LabelledTable> orbits = {};
  std::string x = "x [m]", v = "v [m/s]";                  ///< columns of the orbits and labels of the axes
  std::optional<Range> x_range = {}, v_range = {};         ///< computed from the orbits when absent
  Table direction_field = {};                              ///< four columns: point and arrow centred on it
  std::array<std::vector<PlaneCurve>, 2> nullclines = {};  ///< x' = 0 and v' = 0
  std::vector<RestPoint> rest_points = {};
};

/// Direction field, nullclines, orbits with a triangle at their start, and rest points by type; type
/// and eigenvalues stand in words under the title. Filled marks are stable, open ones unstable; squares
/// nodes, circles foci.
/// @throws InputError as series_panel, or when the direction field has not four columns
Panel phase_panel(const PhasePlane& plane);

/// Phase planes two in a row (one alone is drawn wide).
Figure phase_figure(const std::string& title, const std::vector<PhasePlane>& planes);

/// What a method of so many substeps shows of a material, over the work of a frame.
struct WorkCurve {
  std::string label;
  std::vector<double> work, stiffness, damping;  ///< equal length; NaN where nothing is shown
};

/// Stiffness shown and added damping over work, side by side; where nothing settles a mark at the top. Each
/// curve is named at its end, and in the key.
Figure work_figure(const std::string& title, const std::vector<WorkCurve>& curves, const std::string& footer);

}  // namespace hmax
