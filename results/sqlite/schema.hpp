/// The table layout of a store. Change it together with Store::schema_version.
#pragma once

namespace hmax {

/// Written to PRAGMA application_id ("hmax" in ASCII): tells a store from other SQLite files.
inline constexpr int store_application_id = 0x686D6178;

/// Columns of measured numbers carry no type on purpose: SQLite would turn NaN into NULL and -0.0 into 0.0,
/// so these two are kept as the texts 'nan' and '-0' beside ordinary REAL values, and a typed column would
/// convert them back. cpu_s is a JSON array, readable with json_each(). Each row has the digest of its
/// values, see row_digest.hpp.
inline constexpr const char* store_schema = R"sql(
CREATE TABLE notes (
  key TEXT NOT NULL PRIMARY KEY,
  value TEXT NOT NULL,
  digest TEXT NOT NULL
);
CREATE TABLE sessions (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  started TEXT NOT NULL,
  fingerprint TEXT NOT NULL,
  digest TEXT NOT NULL
);
CREATE TABLE rows (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  session INTEGER NOT NULL REFERENCES sessions(id),
  problem TEXT NOT NULL,
  material TEXT NOT NULL,
  parameters TEXT NOT NULL,
  y0 TEXT NOT NULL,
  method TEXT NOT NULL,
  mode TEXT NOT NULL,
  control TEXT NOT NULL,
  h REAL NOT NULL,
  rtol REAL NOT NULL,
  atol REAL NOT NULL,
  t_end REAL NOT NULL,
  outcome TEXT NOT NULL,
  t_reached NOT NULL,
  steps INTEGER NOT NULL,
  rejected INTEGER NOT NULL,
  rhs INTEGER NOT NULL,
  cpu_s TEXT NOT NULL,
  runs_per_sample INTEGER NOT NULL,
  error_end NOT NULL,
  error_global NOT NULL,
  error_l2 NOT NULL,
  reference_error NOT NULL,
  reference TEXT NOT NULL,
  subnormals INTEGER NOT NULL,
  status TEXT NOT NULL,
  explored INTEGER NOT NULL,
  digest TEXT NOT NULL,
  UNIQUE (problem, material, parameters, y0, mode, method, control, h DESC, rtol DESC, atol DESC, t_end DESC)
);
)sql";

}  // namespace hmax
