/// The published table of "execution times" beside what it measures.
#pragma once

#include <string>
#include <vector>

#include "plots/figure.hpp"
#include "plots/steps.hpp"
#include "results/row.hpp"
#include "results/table.hpp"

namespace hmax {

/// Columns (without the first) in the longest chain in which each begins where the one before has ended: the
/// order in which the solvers ran, if the table holds running totals. Starts at the smallest first value.
std::vector<std::string> order_of_running(const Table& table);

/// Four panels: the table as printed against h; its columns one after the other in the order in which they
/// ran; the differences down each column; CPU time of one run measured here, rows of `mode`, for the methods
/// given.
/// @throws InputError when the table has fewer than two columns or rows, or columns of different length
Figure running_totals_figure(const Table& published, const std::vector<Row>& rows, const std::string& mode,
                             const std::vector<ShownMethod>& methods);

}  // namespace hmax
