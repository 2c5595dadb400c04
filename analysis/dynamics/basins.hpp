/// Basins of attraction: which place of rest a start leads to.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/phase_plane.hpp"
#include "analysis/dynamics/trap.hpp"

namespace hmax {

/// The fates of starts at the centres of columns x rows cells of a window.
/// Cells of one fate together are the picture of a basin; their border is resolved to one cell.
struct Basins {
  int columns, rows;
  Window window;
  std::vector<int>
      fate;  ///< [row * columns + column], rows upwards: the number of a place of rest, or a Fate

  /// The part of the cells that have this fate.
  [[nodiscard]] double share(int of) const;
};

/// The fates of several starts, written to as many numbers. One such function is called by one thread at a
/// time.
using FatesOf = std::function<void(std::span<const Eigen::Vector2d> starts, std::span<int> fates)>;

/// Asks for the fate of each of the columns x rows centres once, some rows in one call, from below. Calls are
/// shared by all cores.
/// @param fates_of  one for each thread: at least as many as jobs(), or as there are calls
/// @param going     called with the share that is begun before each call, by one thread at a time; none is
///                  begun after it answers false, and the cells that are left are undecided
/// @param at_once   starts in a call, about; a row at least
/// @throws std::invalid_argument when the window is empty or there are no cells
Basins basins(const std::vector<FatesOf>& fates_of, const Window& window, int columns, int rows,
              const std::function<bool(double)>& going = {}, std::size_t at_once = 1);

}  // namespace hmax
