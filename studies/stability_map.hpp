/// The largest stable step of methods over two parameters of a model.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// The values of one parameter.
struct MapAxis {
  std::string name;
  std::vector<double> values;  ///< ascending, at least two
  bool logarithmic = false;
};

/// "c=0:10:81": a name, the two ends and how many values, in equal steps or equal ratios.
/// @param option  for the error
/// @throws InputError for anything else, and for a logarithmic axis that does not begin above zero
MapAxis map_axis(std::string_view option, std::string_view text, bool logarithmic);

/// h_max over a grid.
struct StabilityMap {
  std::string method;
  MapAxis x, y;
  /// [s], h_max[row * x.values.size() + column], rows along y. Infinity where every step is stable, 0 where
  /// none is, NaN where the model itself grows, a body has no equilibrium, or the analysis does not cover it.
  std::vector<double> h_max;
  std::string note{};  ///< why there are NaN, from the first of them

  [[nodiscard]] double at(std::size_t column, std::size_t row) const {
    return h_max[row * x.values.size() + column];
  }
  /// Whether h_max falls from this column to the next, by more than rounding.
  [[nodiscard]] bool falls_along_x(std::size_t column, std::size_t row) const;
  /// The share of neighbours along x, both of which have an answer, between which h_max falls.
  [[nodiscard]] double falling_share_x() const;
  [[nodiscard]] double falling_share_y() const;
};

/// The problem at a point of the map. Called by several threads at once.
using ProblemAt = std::function<Problem(double x, double y)>;

/// Predicts for every method at every point of the grid, linearised about its place of rest once for all of
/// them. Points are shared by all cores.
/// @param progress  told the share that is done by the calling thread; may be empty, may throw to end the
/// work
std::vector<StabilityMap> stability_maps(const std::vector<Method>& methods, const ProblemAt& problem_at,
                                         const MapAxis& x, const MapAxis& y,
                                         const std::function<void(double share)>& progress = {});

/// Both axes are parameters of the problem.
/// @throws InputError when both are the same
ProblemAt over_parameters(std::string problem, ProblemSettings settings, const MapAxis& x, const MapAxis& y);

/// The plane of Rayleigh's damping, c = alpha m + beta k1: x is alpha [1/s], y beta [s].
/// @throws InputError unless the problem has m, c and k1
ProblemAt over_rayleigh(std::string problem, ProblemSettings settings);

}  // namespace hmax
