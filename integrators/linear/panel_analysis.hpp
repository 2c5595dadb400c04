/// Where the numbers of a sparse factorisation stand: the order of elimination and the panels, from the
/// pattern alone.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace hmax {

/// The plan of P A P^T = L D L^T for a symmetric pattern, and of its multifrontal computation. Neighbouring
/// unknowns with one pattern, as the three of a point of a body have it, are taken for one. They are ordered
/// by minimum degree or nested dissection, whichever leaves less work; columns of L that have the same rows
/// below them, or nearly so, make a panel, which is stored as a dense matrix. What the elimination of a panel
/// leaves to later ones, its update, is a dense matrix too, that of its rows, and goes to one other panel,
/// its parent.
/// @source [liu1992multifrontal]; [davis2016survey] 4 and 7 for the order and the structure of L
struct PanelAnalysis {
  using Index = int;

  /// Numbers that stand side by side here and there.
  struct Run {
    Index from, length;
    std::size_t to;
  };

  struct Panel {
    Index first, width;    ///< its unknowns, in the order of elimination
    Index height;          ///< rows below them
    Index parent;          ///< -1: none
    std::size_t rows;      ///< where its rows begin in `rows`
    std::size_t entries;   ///< where its entries of A begin in `entries`; they end where the next ones begin
    std::size_t joins[3];  ///< where its rows stand in its parent: begin of `joins` of those that are
                           ///< unknowns there, begin of those that are rows there too, end
    std::size_t values;    ///< where its triangle begins, shape (padded width, width), B behind it
    std::size_t update;    ///< where its update begins, shape (padded height, height)
  };

  std::vector<Panel> panels;  ///< children before their parents
  std::vector<Index> rows;    ///< ascending in each panel
  std::vector<Run> entries;   ///< from the values of A to `values`
  std::vector<Run> joins;     ///< from rows of a panel to unknowns, or to rows, of its parent
  std::vector<Index> to;      ///< unknown i of A is unknown to[i] of L
  std::size_t values = 0;     ///< how many numbers all panels hold
  std::size_t updates = 0;    ///< how many the updates that wait hold at most
  Index tallest = 0, widest = 0;
  double work = 0;  ///< multiplications and additions of one factorisation

  PanelAnalysis() = default;
  /// @param outer, inner  a symmetric pattern of n columns, rows ascending; shapes (n + 1), (entries)
  PanelAnalysis(std::span<const Index> outer, std::span<const Index> inner);
};

}  // namespace hmax
