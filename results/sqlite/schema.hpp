/// The table layout of a store.
#pragma once

#include <string>
#include <string_view>

namespace hmax {

/// Written to PRAGMA application_id ("hmax" in ASCII): tells a store from other SQLite files.
inline constexpr int store_application_id = 0x686D6178;

/// The fields of RowKey in the order in which rows are read; no two rows have the same.
inline constexpr std::string_view order_of_rows =
    "problem, material, parameters, y0, mode, method, control, device, precision, h DESC, rtol DESC, atol DESC, "
    "t_end DESC";

/// The statements that lay out an empty store. Change them, and the lists of columns that they are made of,
/// together with Store::schema_version.
///
/// Columns of measured numbers carry no type on purpose: SQLite would turn NaN into NULL and -0.0 into 0.0,
/// so these two are kept as the texts 'nan' and '-0' beside ordinary REAL values, and a typed column would
/// convert them back. Numbers of keys are typed. cpu_s is a JSON array, readable with json_each(). Each row
/// has the digest of its values, see row_digest.hpp.
std::string store_schema();

}  // namespace hmax
