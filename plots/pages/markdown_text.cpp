#include "plots/pages/markdown_text.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plots/gnuplot.hpp"

namespace hmax {
namespace {

std::string cell(double value) {
  if (std::isnan(value)) return "–";
  return fmt::format("{:.6g}", value);
}

}  // namespace

std::string markdown_text(std::string_view text) {
  std::string escaped;
  for (const char c : one_line(text)) {
    if (c == '<')
      escaped += "&lt;";
    else if (c == '&')
      escaped += "&amp;";
    else {
      if (std::string_view("\\`*_[]|>#!").find(c) != std::string_view::npos) escaped += '\\';
      escaped += c;
    }
  }
  return escaped;
}

std::string markdown_rows(const std::vector<std::vector<std::string>>& rows) {
  const auto has_digit = [](const std::string& text) {
    return std::ranges::any_of(text, [](char c) { return c >= '0' && c <= '9'; });
  };
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::string& each : rows[i]) text += fmt::format("| {} ", markdown_text(each));
    text += "|\n";
    for (std::size_t k = 0; i == 0 && k < rows[0].size(); ++k) {
      const bool numbers =
          std::any_of(rows.begin() + 1, rows.end(),
                      [&](const std::vector<std::string>& row) { return has_digit(row[k]); });
      text += k > 0 && numbers ? "| ---: " : "| --- ";
    }
    if (i == 0) text += "|\n";
  }
  return text;
}

std::string markdown_table(const Table& table) {
  std::vector<std::vector<std::string>> rows{table.columns};
  for (std::size_t i = 0; !table.values.empty() && i < table.values[0].size(); ++i) {
    rows.emplace_back();
    for (const auto& column : table.values) rows.back().push_back(cell(column.at(i)));
  }
  return markdown_rows(rows);
}

std::string markdown_list(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += fmt::format("- {}\n", markdown_text(item));
  return text + "\n";
}

std::string markdown_facts(const std::vector<std::pair<std::string, std::string>>& facts) {
  std::string text = "| | |\n| --- | --- |\n";
  for (const auto& [name, words] : facts)
    if (!words.empty()) text += fmt::format("| {} | {} |\n", markdown_text(name), markdown_text(words));
  return facts.empty() ? "" : text + "\n";
}

}  // namespace hmax
