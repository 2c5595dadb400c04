#include "cli/run/motion_outputs.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "cli/run/checkpoint_option.hpp"
#include "cli/shared/outputs.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "plots/curves.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/mesh/files/mesh_writers.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// A motion of any number of rows as curves show it: of each of equally long stretches of rows those in which
/// a column is least or largest. No peak is lost, however short it is.
class Outline {
 public:
  using Row = std::vector<double>;

  void add(Row row) {
    if (count_++ % stride_ == 0) {
      if (stretches_.size() == most) merge();
      stretches_.emplace_back();
    }
    stretches_.back().push_back(std::move(row));
    keep_extremes(stretches_.back());
  }

  /// @param columns  as many as rows have numbers
  void write_to(std::vector<std::vector<double>>& columns) const {
    for (const std::vector<Row>& rows : stretches_)
      for (const Row& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i) columns[i].push_back(row[i]);
  }

 private:
  static constexpr std::size_t most = 2000;  // stretches, an even number

  /// The first and the last are those of the least and the largest time.
  static void keep_extremes(std::vector<Row>& rows) {
    std::vector<bool> kept(rows.size(), false);
    for (std::size_t column = 0; column < rows.front().size(); ++column) {
      const auto [least, largest] =
          std::ranges::minmax_element(rows, {}, [=](const Row& row) { return row[column]; });
      kept[static_cast<std::size_t>(least - rows.begin())] = true;
      kept[static_cast<std::size_t>(largest - rows.begin())] = true;
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (kept[i]) rows[count++].swap(rows[i]);
    rows.resize(count);
  }

  /// Two stretches each become one.
  void merge() {
    for (std::size_t i = 0; i < most / 2; ++i) {
      std::vector<Row> both = std::move(stretches_[2 * i]);
      std::ranges::move(stretches_[2 * i + 1], std::back_inserter(both));
      keep_extremes(both);
      stretches_[i] = std::move(both);
    }
    stretches_.resize(most / 2);
    stride_ *= 2;
  }

  std::vector<std::vector<Row>> stretches_;
  std::size_t count_ = 0, stride_ = 1;
};

/// The rows before the first in which a state is above `times` the largest of the start; two rows at least.
Table before_it_leaves(Table table, double times) {
  double start = 0;
  for (std::size_t i = 1; i < table.values.size(); ++i)
    start = std::max(start, std::abs(table.values[i].front()));
  if (start == 0) start = 1;
  std::size_t rows = table.values.front().size();
  for (std::size_t i = 1; i < table.values.size(); ++i) {
    const auto out =
        std::ranges::find_if(table.values[i], [&](double y) { return !(std::abs(y) <= times * start); });
    rows = std::min(rows, std::max<std::size_t>(2, static_cast<std::size_t>(out - table.values[i].begin())));
  }
  for (std::vector<double>& column : table.values) column.resize(std::min(rows, column.size()));
  return table;
}

/// Runs once more for the points, kept by the checkpoint if there is one together with what the points
/// change.
template <class... Members>
void watch(const WatchedRun& run, RunCheckpoint* checkpoint, const Sink& sink, Members&... members) {
  if (checkpoint)
    checkpoint->run(output_part, run.runner, run.spec, kept_output(sink, members...));
  else
    run.runner.run(run.spec, sink);
}

/// Whether half of the points lie in the first thousandth of a time from 0 on, as those of stiff problems do.
/// A logarithm does not stretch the beginning of a time that begins elsewhere.
bool begins_fast(const Table& table) {
  const std::vector<double>& t = table.values.front();
  return t.size() > 20 && t.front() == 0 && t.back() > 0 && t[t.size() / 2] < 1e-3 * t.back();
}

/// The columns of a motion, without rows.
Table columns_of(const WatchedRun& run) {
  const auto& [problem, method, runner, spec] = run;
  Table table;
  table.notes = {{"problem", problem.id},
                 {"parameters", describe(problem.parameters)},
                 {"y0", start_in_words(problem)},
                 {"method", method.id}};
  if (spec.adaptive) {
    table.notes.emplace_back("rtol", to_text(spec.rtol));
    table.notes.emplace_back("atol", to_text(spec.atol));
    table.notes.emplace_back("control", control_of(method, spec));
  } else {
    table.notes.emplace_back("h", to_text(spec.h));
  }
  table.columns = {"t [s]"};
  std::ranges::copy(problem.shown.in_order(states_with_units(problem)), std::back_inserter(table.columns));
  if (problem.body) table.columns.insert(table.columns.end(), {"largest displacement [m]", "energy [J]"});
  return table;
}

/// The numbers of a row of columns_of().
std::vector<double> row_at(const Problem& problem, double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
  std::vector<double> row{problem.shown.time(t)};
  if (const auto here = end_of(problem, t, y)) {
    row.insert(row.end(), {here->max_displacement, here->energy});
  } else {
    const Eigen::VectorXd listed = problem.shown.state(y);
    row.insert(row.end(), listed.begin(), listed.end());
  }
  return row;
}

/// The first columns of a motion as curves show them.
Table outline_of(const WatchedRun& run, std::size_t most_columns) {
  Table table = columns_of(run);
  table.columns.resize(std::min(table.columns.size(), most_columns));
  table.values.resize(table.columns.size());
  Outline outline;
  run.runner.run(run.spec, [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    std::vector<double> row = row_at(run.problem, t, y);
    row.resize(table.columns.size());
    outline.add(std::move(row));
  });
  outline.write_to(table.values);
  return table;
}

/// Between the long steps of an error control motions are smooth: more points of the same run.
Table smooth(const WatchedRun& run, Table table) {
  constexpr std::size_t samples = 2000;
  if (!run.spec.adaptive || run.spec.every > 0 || table.values.front().size() > samples) return table;
  WatchedRun closer = run;
  closer.spec.every = run.spec.t_end / static_cast<double>(samples);
  return outline_of(closer, table.columns.size());
}

/// The method and how its steps are chosen.
std::string words_of_steps(const WatchedRun& run) {
  return run.spec.adaptive ? fmt::format("{}, rtol {}, atol {}", run.method.id, to_text(run.spec.rtol),
                                         to_text(run.spec.atol))
                           : fmt::format("{}, h = {} s", run.method.id, to_text(run.spec.h));
}

}  // namespace

std::optional<BodyEnd> end_of(const Problem& problem, double t, const Eigen::VectorXd& y) {
  if (!problem.body) return std::nullopt;
  const TissueBody& body = *problem.body;
  const Eigen::VectorXd q = y.head(body.dofs()), v = y.tail(body.dofs());
  return BodyEnd{.max_displacement = largest_displacement(q),
                 .energy = body.energy(t, q) + body.kinetic_energy(v),
                 .least_volume = body.least_volume(t, q).first};
}

std::size_t write_series(const std::filesystem::path& file, const WatchedRun& run,
                         RunCheckpoint* checkpoint) {
  const TissueBody& body = *run.problem.body;
  std::vector<std::pair<double, std::string>> frames;
  const Sink write_frame = [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    if (static_cast<double>(frames.size()) > most_frames)
      throw InputError(
          fmt::format("the run has more than {:.0g} steps, too many to write; give --every", most_frames));
    const std::string name = fmt::format("{}_{:05}.vtu", file.stem().string(), frames.size());
    const Eigen::MatrixXd displacement = body.positions(t, y.head(body.dofs())) - body.mesh().points;
    write_file(
        file.parent_path() / name,
        vtu_text(body.origin()->file,
                 {.points = {{"displacement", body.origin()->on_points(displacement)}}, .tetrahedra = {}}));
    frames.emplace_back(t, name);
  };
  watch(run, checkpoint, write_frame, frames);
  for (const auto& [t, name] : frames)
    if (!std::filesystem::exists(file.parent_path() / name))
      throw InputError(
          fmt::format("{} is missing, the mesh at t = {} s; remove the checkpoint to write all meshes again",
                      (file.parent_path() / name).string(), to_text(t)));
  write_file(file, pvd_text(frames));
  return frames.size();
}

Table points_of(const WatchedRun& run, RunCheckpoint* checkpoint) {
  Table table = columns_of(run);
  table.values.resize(table.columns.size());
  const Sink add = [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    if (static_cast<double>(table.values[0].size()) > most_points)
      throw InputError(
          fmt::format("the run has more than {:.0g} steps, too many to write; give --every", most_points));
    const std::vector<double> row = row_at(run.problem, t, y);
    for (std::size_t i = 0; i < row.size(); ++i) table.values[i].push_back(row[i]);
  };
  watch(run, checkpoint, add, table.values);
  return table;
}

Figure motion_figure(const WatchedRun& run, const RunRecord& record) {
  constexpr std::size_t most_states = 8;
  const bool diverged = record.outcome == Outcome::diverged;
  const std::size_t states = columns_of(run).columns.size() - 1;
  Table table = outline_of(run, 1 + most_states);
  const bool logarithmic = begins_fast(table);
  if (!logarithmic) table = smooth(run, std::move(table));
  if (diverged) table = before_it_leaves(std::move(table), 100);
  const std::vector<std::string> shown(table.columns.begin() + 1, table.columns.end());
  const std::vector<LabelledTable> motion{{"", table}};
  Figure figure = series_figure(
      diverged
          ? fmt::format("{} diverged at t = {:.4g} s; what is above a hundred times the start is not drawn",
                        run.problem.id, run.problem.shown.time(record.t))
          : run.problem.id,
      motion, shown);
  for (Panel& panel : figure.panels) panel.x.logarithmic = logarithmic;
  if (is_second_order(run.problem) && run.problem.y0.size() == 2) {
    const std::vector<std::string> own = states_with_units(run.problem);  // the position first
    figure.panels.push_back(phase_panel({.title = "orbit", .orbits = motion, .x = own[0], .v = own[1]}));
  }
  figure.footer = fmt::format(
      "{}; {}{}", words_of_steps(run), describe_acting(run.problem),
      states > most_states ? fmt::format("; the first {} of {} states", most_states, states) : "");
  return figure;
}

}  // namespace hmax
