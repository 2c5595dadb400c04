/// The border of a set that is known at the nodes of a grid, by marching squares.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace hmax {

/// A node of a grid; squares with a corner that is unknown are left out.
enum class GridNode : std::uint8_t { outside, inside, unknown };
/// Shape (columns + 1, rows + 1) of a grid of columns x rows squares: node (i, j) is the lower left corner of
/// square (i, j).
using GridNodes = Eigen::Array<GridNode, Eigen::Dynamic, Eigen::Dynamic>;

/// The side of a square from node (i, j) to (i + 1, j), or to (i, j + 1).
struct GridSide {
  int i, j;
  bool upward;
};

/// The sides that a curve crosses, each once; the set lies to its left.
struct GridCurve {
  std::vector<GridSide> sides;
  bool closed;
};

/// The border of what is inside: curves that end at the edge of the grid or at squares that are left out,
/// then closed ones.
/// @param middle_is_inside  asked of square (i, j) where two opposite corners alone are inside: whether these
///                          are joined
std::vector<GridCurve> border_of(const GridNodes& nodes,
                                 const std::function<bool(int i, int j)>& middle_is_inside);

}  // namespace hmax
