/// Numbers that others printed, compiled in; results/published/README.md says what they are.
#pragma once

#include <string_view>

#include "results/table.hpp"

namespace hmax {

/// A published table: "table_2", "benchmark_liver", "benchmark_liver_mass".
/// @throws InputError when there is none of that name; the names are listed
Table published_table(std::string_view name);

/// What each row adds to the row above it: the first column is kept (without its first row), the others are
/// replaced by differences, so that running totals become the costs of single runs. Notes are kept.
/// @throws std::invalid_argument when the table has no row
Table differences_per_column(const Table& table);

}  // namespace hmax
