/// A page of HTML over result stores: advice in words, and every row in tables and figures that the page
/// draws itself.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "plots/pages/reported_store.hpp"

namespace hmax {

struct StoreReport {
  std::string html;
  std::size_t left_out = 0;  ///< rows that the page has no room for; it says so
};

/// What a page about the answer to one question says around its rows.
struct AnswerSections {
  std::string title = {}, introduction = {};  ///< shown as they are
  std::string before = {};                    ///< Markdown, in place of the answers in words
  std::string after = {};                     ///< Markdown
  std::string table = {};                     ///< Markdown: the rows where there is no JavaScript
};

/// One page without any other file. Texts of stores are shown as they are; none of it becomes markup. Stores
/// that are alike give the same bytes.
/// @param version     of hmax
/// @param most_bytes  of the page; where it would be larger, the last rows of long tables are left out
StoreReport store_report(std::span<const ReportedStore> stores, const std::string& version,
                         std::size_t most_bytes = 5'000'000);

/// The same page about the answer to one question.
/// @param answer  its rows and its body, if it is about one, and a session
StoreReport answer_report(const ReportedStore& answer, const AnswerSections& sections,
                          const std::string& version, std::size_t most_bytes = 5'000'000);

}  // namespace hmax
