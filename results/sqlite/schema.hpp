/// The table layout of a store. Change it together with Store::schema_version.
#pragma once

namespace hmax {

/// Written to PRAGMA application_id ("hmax" in ASCII): tells a store from other SQLite files.
inline constexpr int store_application_id = 0x686D6178;

/// Columns of measured numbers carry no type on purpose: SQLite would turn NaN into NULL and -0.0 into 0.0,
/// so these two are kept as the texts 'nan' and '-0' beside ordinary REAL values, and a typed column would
/// convert them back. cpu_s is a JSON array, readable with json_each().
inline constexpr const char* store_schema = R"sql(
CREATE TABLE notes (
  key TEXT NOT NULL PRIMARY KEY,
  value TEXT NOT NULL
);
CREATE TABLE sessions (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  started TEXT NOT NULL,
  fingerprint TEXT NOT NULL
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
  explored INTEGER NOT NULL DEFAULT 0,
  UNIQUE (problem, material, parameters, y0, mode, method, control, h DESC, rtol DESC, atol DESC, t_end DESC)
);
)sql";

/// From layout 1, which had no error_l2, to layout 2.
inline constexpr const char* store_schema_1_to_2 =
    "ALTER TABLE rows ADD COLUMN error_l2 NOT NULL DEFAULT 'nan'; PRAGMA user_version = 2";
/// From layout 4, whose advice had neither iterations of conjugate gradients nor distributions of times, to
/// layout 5.
inline constexpr const char* store_schema_4_to_5 =
    "ALTER TABLE advice ADD COLUMN linear_per_frame NOT NULL DEFAULT 'nan'; "
    "ALTER TABLE advice ADD COLUMN frame_tail_s TEXT NOT NULL DEFAULT ''";
/// Layout 2 had no limits, which limit_schema() adds, layout 3 no advice, which advice_schema() adds, layout
/// 4 no scenes, which scene_schema() adds, layout 5 knew of no explored rows, and layout 6 had no words of
/// answers, which words_schema() adds.
inline constexpr const char* store_schema_to_6 =
    "ALTER TABLE rows ADD COLUMN explored INTEGER NOT NULL DEFAULT 0; PRAGMA user_version = 6";

}  // namespace hmax
