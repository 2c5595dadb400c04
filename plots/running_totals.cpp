#include "plots/running_totals.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "results/published/published.hpp"

namespace hmax {
namespace {

void require_table(const Table& table) {
  const bool whole = table.columns.size() >= 2 && table.values.size() == table.columns.size() &&
                     table.values[0].size() >= 2 &&
                     std::all_of(table.values.begin(), table.values.end(),
                                 [&](const auto& column) { return column.size() == table.values[0].size(); });
  if (!whole)
    throw InputError(
        "a table of totals needs a column of steps, a column per solver and two rows of equal length");
}

/// "ode45" of "ode45 [s]".
std::string without_unit(const std::string& column) { return column.substr(0, column.find(" [")); }

}  // namespace

std::vector<std::string> order_of_running(const Table& table) {
  require_table(table);
  std::vector<std::size_t> left;
  for (std::size_t c = 1; c < table.columns.size(); ++c) left.push_back(c);
  std::stable_sort(left.begin(), left.end(),
                   [&](std::size_t a, std::size_t b) { return table.values[a][0] < table.values[b][0]; });
  std::vector<std::string> order;
  double ended = -std::numeric_limits<double>::infinity();
  for (const std::size_t c : left) {
    if (table.values[c].front() < ended) continue;
    order.push_back(table.columns[c]);
    ended = table.values[c].back();
  }
  return order;
}

Figure running_totals_figure(const Table& published, const std::vector<Row>& rows, const std::string& mode,
                             const std::vector<ShownMethod>& methods) {
  require_table(published);
  const Table differences = differences_per_column(published);
  const std::vector<std::string> order = order_of_running(published);
  const auto& h = published.values[0];
  const auto count = h.size();

  double growth = 1;
  for (std::size_t c = 1; c < published.values.size(); ++c)
    growth = std::max(growth, published.values[c].back() / published.values[c].front());

  Panel printed{.title = "As printed: \"execution time\"",
                .x = {"h [s]", true},
                .y = {"printed value [s]"},
                .notes = {fmt::format("h falls {:.0f}-fold, the values grow at most {:.2g}-fold",
                                      h.front() / h.back(), growth)}};
  Panel chained{.title = "The same numbers in the order of running",
                .x = {"row of the table, solver after solver"},
                .y = {"printed value [s]"},
                .notes = {"without Euler, which is of another run"}};
  Panel cost{.title = "Differences down each column",
             .x = {"h [s]", true},
             .y = {"time of one row [s]", true},
             .notes = {"what a row cost; differences of 0 cannot be drawn"}};
  // The k-th method is the counterpart of the k-th solver and looks like it.
  const std::vector<Style> styles = method_styles(methods);
  for (std::size_t c = 1; c < published.columns.size(); ++c) {
    Curve curve{.label = without_unit(published.columns[c]),
                .x = h,
                .y = published.values[c],
                .style = c - 1 < styles.size() ? styles[c - 1] : family_style(static_cast<int>(c), true)};
    printed.curves.push_back(curve);
    const auto place = std::find(order.begin(), order.end(), published.columns[c]);
    if (place != order.end()) {
      Curve run = curve;
      for (std::size_t i = 0; i < count; ++i)
        run.x[i] = static_cast<double>(static_cast<std::size_t>(place - order.begin()) * count + i + 1);
      chained.curves.push_back(std::move(run));
    }
    curve.x = differences.values[0];
    curve.y = differences.values[c];
    cost.curves.push_back(std::move(curve));
  }
  Panel measured = run_time_panel(rows, mode, methods);
  measured.title = "Measured here: CPU time of one run";
  return {.title = "The published times are running totals of one clock",
          .panels = {printed, chained, cost, measured},
          .columns = 2};
}

}  // namespace hmax
