/// Words, tables and lists as Markdown.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "results/table.hpp"

namespace hmax {

/// `text` with the characters that Markdown and HTML would take for their own escaped, on one line.
std::string markdown_text(std::string_view text);

/// A table in Markdown, of rows of equal length, the first of them headings. Columns with digits are flush
/// right, but for the first.
std::string markdown_rows(const std::vector<std::vector<std::string>>& rows);
/// A table of numbers with up to six significant digits, NaN as a dash.
std::string markdown_table(const Table& table);

std::string markdown_list(const std::vector<std::string>& items);
/// Names and words as a table without headings; what has no name goes on with the last, what has no words is
/// left out.
std::string markdown_facts(const std::vector<std::pair<std::string, std::string>>& facts);

}  // namespace hmax
