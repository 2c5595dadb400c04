#include "results/published/published.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "results/published/published_texts.hpp"

namespace hmax {

Table published_table(std::string_view name) {
  for (const auto& [known, csv] : published_texts()) {
    if (known == name) return parse_csv(csv, fmt::format("results/published/{}.csv", name));
  }
  std::string names;
  for (const auto& [known, csv] : published_texts())
    names += fmt::format("{}{}", names.empty() ? "" : ", ", known);
  throw InputError(fmt::format("There is no published table '{}': choose one of {}.", name, names));
}

Table differences_per_column(const Table& table) {
  if (table.values.empty() || table.values[0].empty()) {
    throw std::invalid_argument("Differences need a table with at least one row.");
  }
  Table result{.notes = table.notes, .columns = table.columns};
  for (std::size_t c = 0; c < table.values.size(); ++c) {
    const std::vector<double>& column = table.values[c];
    std::vector<double> changed;
    for (std::size_t r = 1; r < column.size(); ++r)
      changed.push_back(c == 0 ? column[r] : column[r] - column[r - 1]);
    result.values.push_back(std::move(changed));
  }
  return result;
}

}  // namespace hmax
