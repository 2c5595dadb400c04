/// What `hmax run` writes of a motion: points, a series of meshes, a picture over time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "bench/timing/run_checkpoint.hpp"
#include "catalogue/methods/method.hpp"
#include "plots/figure.hpp"
#include "results/table.hpp"

namespace hmax {

/// Points are kept in memory until the file is written: 10 million of two states are a quarter of a gigabyte.
inline constexpr double most_points = 1e7;
/// A series for ParaView has a file for each of its instants.
inline constexpr double most_frames = 1e4;

/// Where a body has got to.
struct BodyEnd {
  double max_displacement;  ///< of a free point [m]
  double energy;            ///< potential and kinetic [J]
  double least_volume;      ///< of a tetrahedron, relative to that at rest [1]
};
/// Nothing of what is no body. @param y  shape (dim)
std::optional<BodyEnd> end_of(const Problem& problem, double t, const Eigen::VectorXd& y);

/// A run that is made again, outside the clock, to be looked at.
struct WatchedRun {
  const Problem& problem;
  const Method& method;
  const Runner& runner;
  RunSpec spec;  ///< with `every` of the user
};

/// The points that are passed, time in the first column; of bodies how far and with how much energy.
/// @param checkpoint  where the run and its points are kept, or null
/// @throws InputError  for more than most_points
Table points_of(const WatchedRun& run, RunCheckpoint* checkpoint);

/// A mesh at every instant that is passed, for ParaView: a list FILE.pvd and the meshes beside it.
/// @returns how many
/// @param checkpoint  where the run and the names of its meshes are kept, or null
/// @throws InputError  for more than most_frames, or where a mesh that was written before the run went on is
/// missing
std::size_t write_series(const std::filesystem::path& file, const WatchedRun& run,
                         RunCheckpoint* checkpoint = nullptr);

/// The states over time, one above the other, of larger systems the first eight, and of one position and
/// velocity the orbit. No peak is left out. Time is logarithmic where most of the points lie at the
/// beginning. A motion that diverges is drawn as far as its states stay below a hundred times their start.
Figure motion_figure(const WatchedRun& run, const RunRecord& record);

}  // namespace hmax
