/// hmax phase --basins: which place of rest each start in the window leads to.
#include <algorithm>
#include <mutex>

#include <fmt/format.h>

#include "analysis/dynamics/basins.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/planar.hpp"
#include "cli/phase/phase.hpp"
#include "core/errors.hpp"
#include "core/parallel_for.hpp"
#include "plots/dynamics.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

/// Columns or rows of a grid: 400 MB of fates; and of one that is drawn as rectangles.
constexpr std::int64_t most_cells = 10'000, most_drawn_cells = 4000;
/// That a card runs together, while other threads begin and judge theirs.
constexpr std::size_t starts_at_once = 1 << 17;

/// Throws unless something attracts.
void require_attractor(const PhaseView& view) {
  if (view.t)
    throw InputError(
        fmt::format("--basins is for problems that do not depend on time, and {} is driven; set its force to "
                    "zero, or see what it settles to with --poincare",
                    view.problem.id));
  if (std::ranges::any_of(view.equilibria, is_stable, &Equilibrium::type)) return;
  const bool is_told =
      view.check.accounts() &&
      std::ranges::count(view.equilibria, EquilibriumType::degenerate, &Equilibrium::type) == 0;
  throw InputError(fmt::format(
      "no stable equilibrium of {} was found in the window, so nothing has a basin; {}", view.problem.id,
      is_told ? "look elsewhere with --window" : "some may have been missed: narrow --window"));
}

/// Columns and rows of --cells, "200" or "200,100". @param most  of either
std::pair<int, int> grid_of(const std::string& cells, std::int64_t most) {
  const std::size_t comma = std::min(cells.find(','), cells.size());
  const std::int64_t columns = cells.empty() ? 120 : parse_count("--cells", cells.substr(0, comma), 2);
  const std::int64_t rows =
      comma == cells.size() ? (columns * 3 + 3) / 4 : parse_count("--cells", cells.substr(comma + 1), 2);
  if (const std::int64_t asked = std::max(columns, rows); asked > most)
    throw InputError(fmt::format("--cells is {}, more than the limit of {}; take fewer", asked, most));
  return {static_cast<int>(columns), static_cast<int>(rows)};
}

Figure picture(const PhaseView& view, const Basins& found) {
  std::vector<std::string> labels;
  std::vector<int> number(view.equilibria.size(), -1);  // among those that attract
  for (std::size_t i = 0; i < view.equilibria.size(); ++i) {
    const Equilibrium& e = view.equilibria[i];
    if (!is_stable(e.type)) continue;
    number[i] = static_cast<int>(labels.size());
    labels.push_back(fmt::format("converges to ({}, {}): {:.1f} %", short_name(e.state(0)),
                                 short_name(e.state(1)), 100 * found.share(static_cast<int>(i))));
  }
  const Window& w = view.window;
  BasinMap map{.columns = found.columns,
               .rows = found.rows,
               .x = {w.lower(0), w.upper(0)},
               .v = {w.lower(1), w.upper(1)}};
  for (const int fate : found.fate)
    map.attractor.push_back(fate < 0 ? -1 : number[static_cast<std::size_t>(fate)]);
  const auto names = states_with_units(view.problem);
  Panel panel = phase_panel({.x = names[0],
                             .v = names[1],
                             .x_range = map.x,
                             .v_range = map.v,
                             .rest_points = rest_points_of(view.equilibria)});
  panel.areas = basin_areas(map, labels, "leaves, or settles elsewhere");
  for (const Equilibrium& e : view.equilibria)
    if (e.type == EquilibriumType::saddle)
      for (Curve& way : ways_of(view, e, true)) panel.curves.push_back(std::move(way));
  return {
      .title = fmt::format("{}: basins of attraction", view.problem.id),
      .panels = {panel},
      .footer = fmt::format("{}; {} x {} starts", describe_acting(view.problem), found.columns, found.rows),
      .panel_height = 440};
}

}  // namespace

void phase_basins(const PhaseOptions& options, Console& console) {
  const PhaseView view = view_of(options);
  require_attractor(view);
  const auto [columns, rows] = grid_of(options.cells, options.output.empty() ? most_cells : most_drawn_cells);
  const std::unique_ptr<Device> device = options.device.open();
  const MotionRunner runner = runner_on(device.get(), starts_at_once);
  Progress progress(console, "basins");
  const auto& interrupted = interrupt_flag();
  // Of each motion, since those from far may take minutes.
  std::mutex counting;
  std::int64_t ended = 0;
  const auto count = [&, all = std::int64_t{columns} * rows] {
    const std::scoped_lock lock(counting);
    progress.update(static_cast<double>(++ended) / static_cast<double>(all));
  };
  // A problem for each thread: some systems have one workspace.
  std::vector<FatesOf> fates_of;
  while (fates_of.size() < std::min(jobs(), static_cast<std::size_t>(rows)))
    fates_of.push_back(fates_of_starts(fates_of.empty() ? view.still : frozen(options.problem.make(), 0),
                                       view.window, view.equilibria, runner, count));
  const auto going = [&](double) { return !interrupted; };
  const Basins found = basins(fates_of, view.window, columns, rows, going, device ? starts_at_once : 1);
  if (interrupted) throw Interrupted{};

  Json document = document_of(view);
  const auto names = states_with_units(view.problem);
  Json attractors = Json::array();
  TextTable table({"converges to", names[0], names[1], "share of the starts"});
  for (std::size_t i = 0; i < view.equilibria.size(); ++i) {
    const Equilibrium& e = view.equilibria[i];
    if (!is_stable(e.type)) continue;
    const double share = found.share(static_cast<int>(i));
    attractors.push_back({{"x", e.state(0)}, {"v", e.state(1)}, {"type", name_of(e.type)}, {"share", share}});
    table.add({std::string(name_of(e.type)), short_name(e.state(0)), short_name(e.state(1)),
               fmt::format("{:.2f} %", 100 * share)});
  }
  for (const auto& [fate, words] :
       {std::pair{unbounded, "goes far away"}, {undecided, "settles elsewhere or later"}})
    if (found.share(fate) > 0) table.add({words, "", "", fmt::format("{:.2f} %", 100 * found.share(fate))});
  const Tolerances<double> tolerances = tolerances_in(view.window, basin_tolerances);
  document["tolerances"] = to_json(tolerances);
  document["cells"] = {found.columns, found.rows};
  document["attractors"] = attractors;
  document["unbounded"] = found.share(unbounded);
  document["undecided"] = found.share(undecided);
  std::string text = headline(view.problem) + equilibria_table(view, console) + "\n" + table.text(console) +
                     fmt::format("motions: {}\n", in_words(tolerances));
  add_time(device.get(), document, text);
  if (!options.output.empty()) deliver(picture(view, found), options, document, text, console);
  console.show(document, text);
}

}  // namespace hmax
