/// Limits of the step for people, from their rows.
#pragma once

#include <span>
#include <string>

#include "cli/shared/console.hpp"
#include "results/limit_row.hpp"

namespace hmax {

/// Which columns a table of limits has.
struct LimitColumns {
  bool verified = false;  ///< what runs on both sides showed
  bool safe = false;      ///< what runs from the start of a motion showed
  std::string path;       ///< motion | load: the least limit along it; empty for none
};

/// "unbounded" of infinity, "-" of NaN.
std::string step_words(double h, int digits = 6);

/// One line a row.
std::string limit_table(std::span<const LimitRow> rows, const LimitColumns& columns, const Console& console);

/// The notes of rows, each once with all methods of which it is said.
std::string words_of_notes(std::span<const LimitRow> rows);

/// What is to be said of limits along paths, once of neighbours that say the same.
std::string words_of_paths(std::span<const LimitRow> rows);

/// What runs from the start of a motion say of the steps below them, and which of them fail below the limit
/// that is necessary; empty where there were none.
std::string words_of_safe(std::span<const LimitRow> rows);

}  // namespace hmax
