/// What a page shows of a result store.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "results/store.hpp"

namespace hmax {

/// The content of a store, in the order of its rows: row 1 is the first.
struct ReportedStore {
  std::string name = {};  ///< of its file, as the page shows it
  std::vector<Row> runs = {};
  std::vector<LimitRow> limits = {};
  std::vector<AdviceRecord> advice = {};
  std::vector<AdviceScene> scenes = {};  ///< bodies of this advice
  std::vector<AdviceWords> words = {};   ///< what is said of it
  std::vector<Session> sessions = {};

  [[nodiscard]] std::size_t size() const { return runs.size() + limits.size() + advice.size(); }
};

/// @param name  that the page shows
ReportedStore reported_store(const Store& store, std::string name);

/// The tables of the page; these are their ids in its links.
inline constexpr std::string_view advice_table = "advice", runs_table = "rows", limits_table = "limits";

/// The id of a row on the page: "rows-17", with several stores "rows-2-17".
/// @param store   its index, from 0
/// @param number  of the row in its store, from 1
/// @param stores  number of stores on the page
std::string row_anchor(std::string_view table, std::size_t store, std::size_t number, std::size_t stores);

}  // namespace hmax
