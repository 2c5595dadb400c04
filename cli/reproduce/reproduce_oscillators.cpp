#include "cli/reproduce/reproduce_oscillators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "analysis/dynamics/phase_plane.hpp"
#include "bench/timing/sweep.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/series.hpp"
#include "cli/phase/plane.hpp"
#include "cli/reproduce/report_page.hpp"
#include "plots/curves.hpp"
#include "plots/running_totals.hpp"
#include "plots/steps.hpp"
#include "problems/oscillator/liver_problems.hpp"
#include "results/json.hpp"
#include "results/published/published.hpp"
#include "studies/liver_claims.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

// Curves are drawn from a method whose error is far below the width of a line.
constexpr std::string_view curve_method = "dop_853";
constexpr double curve_tolerance = 1e-10;
constexpr int curve_points = 1500;

LabelledTable curve_of(const LiverFamilyMember& member, const Eigen::Vector2d& y0, double t_end) {
  return {member.label, motion(forced_liver(member.parameters, y0), find_method(curve_method),
                               curve_tolerance, t_end, t_end / curve_points)};
}

std::vector<LabelledTable> curves_of(const LiverFamily& family, double t_end = 0) {
  std::vector<LabelledTable> curves;
  for (const LiverFamilyMember& member : family.members)
    curves.push_back(curve_of(member, family.y0, t_end > 0 ? t_end : family.t_end));
  return curves;
}

/// The field of a member without its force: a phase plane is drawn for the autonomous model.
PlanarField unforced(OscillatorParameters parameters) {
  parameters.P = 0;
  return frozen_at(Oscillator(parameters));
}

/// "-0.69 ± 0.085i", "-0.186 and -2.59"
std::string eigenvalues_of(const Equilibrium& equilibrium) {
  const auto& [first, second] = equilibrium.eigenvalues;
  return are_conjugate(equilibrium.eigenvalues)
             ? fmt::format("{:.4g} ± {:.4g}i", first.real(), std::abs(first.imag()))
             : fmt::format("{:.4g} and {:.4g}", first.real(), second.real());
}

/// The members of a family, each with its equilibria without the force.
Json equilibria_of(const LiverFamily& family, const Window& window) {
  Json members = Json::array();
  for (const LiverFamilyMember& member : family.members) {
    Json equilibria = Json::array();
    for (const Equilibrium& e : find_equilibria(unforced(member.parameters), window))
      equilibria.push_back({{"type", name_of(e.type)},
                            {"x", e.state[0] + 0.0},
                            {"v", e.state[1] + 0.0},
                            {"eigenvalues", eigenvalues_of(e)}});
    members.push_back({{"member", member.label}, {"equilibria", equilibria}});
  }
  return members;
}

/// Direction field, nullclines, orbits from several starts, equilibria of one member.
PhasePlane phase_plane_of(const LiverFamilyMember& member, const std::vector<Eigen::Vector2d>& starts,
                          double t_end, const Window& window) {
  const PlanarField field = unforced(member.parameters);
  PhasePlane plane = plane_of(field, window, {"x [m]", "v [m/s]"}, find_equilibria(field, window));
  plane.title = member.label;
  for (const Eigen::Vector2d& start : starts)
    plane.orbits.push_back(
        {fmt::format("from ({:g}, {:g})", start[0], start[1]), curve_of(member, start, t_end).table});
  return plane;
}

/// The first `seconds` of a curve.
LabelledTable beginning(const LabelledTable& curve, double seconds) {
  LabelledTable first = curve;
  const std::vector<double>& t = curve.table.values[0];
  const auto count = std::ranges::upper_bound(t, seconds) - t.begin();
  for (std::vector<double>& column : first.table.values) column.resize(static_cast<std::size_t>(count));
  return first;
}

/// Displacement, velocity and acceleration against time, and the orbits in the phase plane. The acceleration
/// is shown for its transient only, which is over long before the motion is.
Figure four_views(const std::string& title, const std::vector<LabelledTable>& curves, double transient) {
  std::vector<LabelledTable> first;
  for (const LabelledTable& curve : curves) first.push_back(beginning(curve, transient));
  return {.title = title,
          .panels = {series_panel("displacement", curves, "t [s]", "x [m]"),
                     series_panel("velocity", curves, "t [s]", "v [m/s]"),
                     series_panel("acceleration, transient", first, "t [s]", "a [m/s^2]"),
                     phase_panel({.title = "phase plane", .orbits = curves})},
          .columns = 2,
          .panel_height = 230};
}

std::vector<ShownMethod> shown(const std::vector<std::pair<std::string, std::string>>& ids_and_labels) {
  std::vector<ShownMethod> list;
  for (const auto& [id, label] : ids_and_labels) {
    const Method& method = find_method(id);
    list.push_back({method.id, method.order, label});
  }
  return list;
}

/// The first explicit one-step method of each order: the curves of others of its order lie beside it.
std::vector<ShownMethod> one_of_each_order() {
  std::map<int, ShownMethod> of_order;
  for (const Method& method : choose_methods({"explicit_runge_kutta"}, {}))
    of_order.try_emplace(method.order, ShownMethod{method.id, method.order});
  std::vector<ShownMethod> list;
  for (auto& [order, method] : of_order) list.push_back(std::move(method));
  return list;
}

/// Runs that are farther from the motion than half its size tell nothing of it, as those that diverged.
std::vector<Row> without_lost_runs(std::vector<Row> rows, const OscillatorParameters& p,
                                   const Eigen::Vector2d& y0, double t_end) {
  double size = 0;
  const LabelledTable curve = curve_of({.parameters = p}, y0, t_end);
  for (const std::size_t column : {1U, 2U})
    for (const double value : curve.table.values[column]) size = std::max(size, std::abs(value));
  for (Row& row : rows)
    if (row.outcome == "reached_end" && !(row.error_global <= size / 2)) row.outcome = "diverged";
  return rows;
}

/// Males broad and pale, females thin: curves that fall together are seen. One colour for each build.
Figure told_by_sex(Figure figure) {
  for (Panel& panel : figure.panels)
    for (Curve& curve : panel.curves) {
      const std::size_t build = curve.label.find('_');
      if (build == std::string::npos) continue;
      const bool male = curve.label.starts_with("male");
      const int colour = curve.label.ends_with("slim") ? 0 : curve.label.ends_with("normal") ? 1 : 2;
      curve.style = {.colour = colour, .width = male ? 5.0 : 1.4, .light = male};
    }
  return figure;
}

/// Medians of the CPU time of one run [ms] by step, a column per method, NaN where the method has no such
/// row. Three digits: a repeated measurement agrees in no more.
Table run_times(const std::vector<Row>& rows, const std::string& mode, const std::vector<ShownMethod>& list) {
  std::map<double, std::map<std::string, double>, std::greater<>> by_step;
  for (const Row& row : rows)
    if (row.key.mode == mode && row.outcome == "reached_end")
      by_step[row.key.h][row.key.method] =
          std::stod(fmt::format("{:.3g}", summarise(row.cpu_s).median * 1e3));
  Table table{.columns = {"h [s]"}, .values = {{}}};
  for (const ShownMethod& method : list) {
    table.columns.push_back((method.label.empty() ? method.id : method.label) + " [ms]");
    table.values.emplace_back();
  }
  for (const auto& [h, times] : by_step) {
    table.values[0].push_back(h);
    for (std::size_t k = 0; k < list.size(); ++k) {
      const auto it = times.find(list[k].id);
      table.values[k + 1].push_back(it == times.end() ? std::numeric_limits<double>::quiet_NaN()
                                                      : it->second);
    }
  }
  return table;
}

/// The solvers of the study under its names for them.
std::vector<ShownMethod> the_five() {
  return shown({{"explicit_euler", "Euler"},
                {"dormand_prince_54", "ode45"},
                {"rosenbrock_23", "ode23s"},
                {"adams_pece", "ode113"},
                {"trapezoidal", "ode23t"}});
}

/// The solvers of the study at MATLAB's default tolerances and step control, beside those of this report.
Json work_of_solvers(const std::vector<SolverWork>& all) {
  Json rows = Json::array();
  for (const SolverWork& work : all)
    rows.push_back({{"solver", work.method},
                    HMAX_KEYS(work, rtol, atol),
                    HMAX_KEYS(work.stats, steps, rejected),
                    {"evaluations", work.stats.rhs},
                    {"error", work.error}});
  return rows;
}

/// Each sentence of the study that can be tested, and how many hold.
void add_claims(Json& values, const std::vector<Row>& rows, const std::vector<SolverWork>& work) {
  Claims claims = claims_on_solvers(rows, work);
  claims.update(claims_on_motion());
  values.update(counts_of(claims));
  values.update(claims);
}

/// The sections of one report.
class Study {
 public:
  Study(const StudyRows& rows, const fs::path& folder,
        const std::function<void(const std::string&)>& progress)
      : rows_(rows), page_("oscillators", folder), values_(page_.values), progress_(progress) {}

  fs::path write() {
    values_ = {{"machine", rows_.machine}, {"curve_tolerance", curve_tolerance}};
    page_.link_to_rows();
    timing();
    table_2();
    starts();
    progress_("tolerances");
    const std::vector<SolverWork> work = work_at_defaults();
    values_["defaults"] = work_of_solvers(work);
    linear_families();
    phase_planes_of_stiffness();
    phase_planes_of_damping();
    forced();
    benchmark_liver();
    progress_("sentences");
    add_claims(values_, rows_.published_model, work);
    return page_.write();
  }

 private:
  void draw(Figure figure, const std::string& name, const std::string& footer) {
    figure.footer = footer;
    page_.draw(figure, name);
  }
  static std::string curve_footer(const LiverFamily& family) {
    return fmt::format("{}, rtol = atol = {:g}; x(0) = {:g} m, v(0) = {:g} m/s; {}", curve_method,
                       curve_tolerance, family.y0[0], family.y0[1], family.note);
  }
  void draw_times(Figure figure, const std::string& title, const std::string& name) {
    figure.title = title;
    draw(std::move(figure), name, "CPU time, median of 9 interleaved repetitions; " + rows_.machine);
  }

  void timing() {
    progress_("figure 1");
    const auto orders = one_of_each_order();
    draw_times(step_figure(rows_.published_model, the_five()),
               "A smaller step costs in proportion; the error stops falling at rounding",
               "figure_1_cpu_time");
    draw_times(step_figure(rows_.published_model, orders),
               "One explicit method of each order: a higher order costs more a step and errs far less",
               "figure_1_orders");
    draw_times(step_cost_figure(rows_.published_model, orders),
               "The cost of one explicit step hardly depends on its size", "figure_1_cost_of_a_step");
    OscillatorParameters growing = liver_problem("liver_forced").parameters;
    growing.c = -2;
    const LiverFamily& timing = liver_family("timing");
    draw_times(step_figure(without_lost_runs(rows_.self_exciting, growing, timing.y0, 10), the_five()),
               "With the damping of -2 that the study's text names, only small steps follow the growth",
               "figure_1_damping_minus_2");
  }

  void table_2() {
    progress_("table 2");
    const Table published = published_table("table_2");
    draw_times(running_totals_figure(published, rows_.published_model, "sampled", the_five()),
               "Table 2 holds running totals: four of five solvers start where another has ended",
               "table_2_running_totals");
    page_.show("printed", published);
    page_.show("differences", differences_per_column(published));
    for (const char* mode : {"fixed", "sampled"})
      page_.show(mode, run_times(rows_.published_model, mode, the_five()));
  }

  /// What the study leaves open about its timing experiment.
  void starts() {
    progress_("equations 2.5 and 2.9");
    const LiverFamily& timing = liver_family("timing");
    LiverFamilyMember printed = timing.members.front(), rest = printed, set = printed;
    printed.label = "from (0.5, 1), as equation 2.5";
    rest.label = "from rest, (0, 0), as equation 2.9";
    set.label = "from (0.5, 1), k1 = 0.8 N/m";
    set.parameters.k1 = 0.8;
    const std::vector<LabelledTable> curves{curve_of(printed, timing.y0, 20), curve_of(rest, {0, 0}, 20),
                                            curve_of(set, timing.y0, 20)};
    const auto apart = [&](std::size_t other, double from) {
      const std::vector<double>&t = curves[0].table.values[0], &x = curves[0].table.values[1],
            &z = curves[other].table.values[1];
      double most = 0;
      for (std::size_t i = 0; i < t.size(); ++i)
        if (t[i] >= from) most = std::max(most, std::abs(x[i] - z[i]));
      return most;
    };
    values_["starts"] = {{"apart", apart(1, 0)},
                         {"after_10_s", apart(1, 10)},
                         {"after_15_s", apart(1, 15)},
                         {"stiffer", apart(2, 0)}};
    draw(series_figure("Start and stiffness of the timing experiment, c = 2", curves), "equation_2_9_start",
         fmt::format(
             "{}, rtol = atol = {:g}; m = 1.45 kg, c = 2 N s/m, k1 = 0.7 N/m, k3 = 0.8 N/m³, P = 0.5 N",
             curve_method, curve_tolerance));
  }

  void linear_families() {
    for (const auto& [id, title] : {std::pair{"linear_mass", "A heavier liver swings more slowly"},
                                    {"linear_stiffness", "A stiffer liver swings faster"},
                                    {"linear_damping", "Damping sets how soon the swing dies out"}}) {
      const LiverFamily& family = liver_family(id);
      progress_(fmt::format("figure {}", family.figure));
      draw(series_figure(title, curves_of(family)), fmt::format("figure_{}_{}", family.figure, id),
           curve_footer(family));
      values_[fmt::format("note_of_{}", id)] = family.note;
    }
  }

  void phase_planes_of_stiffness() {
    progress_("figure 5");
    const Window near_rest{{-0.6, -1.2}, {1, 1.2}};
    for (const auto& [id, varied, name, title] :
         {std::tuple{"cubic_stiffness", "k1", "figure_5_phase_plane",
                     "Without oscillation the liver returns to rest"},
          {"cubic_hardening", "k3", "figure_5_hardening", "So it does whatever the cubic spring"}}) {
      std::vector<PhasePlane> planes;
      for (const double zeta : {1.0, 2.0}) {
        const LiverFamily family = damped_as_at_rest(liver_family(id), zeta);
        planes.push_back(phase_plane_of(family.members[1], {}, family.t_end, near_rest));
        planes.back().title = zeta == 1 ? "critically damped" : "over-damped";
        planes.back().nullclines = {};
        planes.back().rest_points = {};
        planes.back().orbits = curves_of(family);
        values_["figure_5"].push_back(
            {{"varied", varied}, {"critical", zeta == 1}, {"members", equilibria_of(family, near_rest)}});
      }
      draw(phase_figure(title, planes), name,
           fmt::format("{}, rtol = atol = {:g}; arrows: the field of the curve in the middle", curve_method,
                       curve_tolerance));
      values_[fmt::format("note_of_{}", id)] = liver_family(id).note;
    }
  }

  void phase_planes_of_damping() {
    progress_("figure 6");
    const LiverFamily& damping = liver_family("cubic_damping");
    const Window window{{-2, -2}, {2, 2}};
    const std::vector<Eigen::Vector2d> starts{{0.5, 1}, {-1.5, 0}, {1.5, -1.2}, {-0.6, 1.6}};
    std::vector<PhasePlane> four;
    for (const LiverFamilyMember& member : damping.members)
      four.push_back(phase_plane_of(member, starts, damping.t_end / 2, window));
    draw(phase_figure("From source to node: the damping decides", four), "figure_6_phase_planes",
         fmt::format("{}, rtol = atol = {:g}; four starts (triangles); {}", curve_method, curve_tolerance,
                     damping.note));
    values_["figure_6"].push_back(Json::object({{"members", equilibria_of(damping, window)}}));
    for (const auto& [id, title] :
         {std::pair{"cubic_stiffness", "The stiffer the liver, the less far it swings"},
          {"cubic_hardening", "The harder the cubic spring, the less far it swings"}}) {
      const LiverFamily& family = liver_family(id);
      draw(phase_figure(title, {{.orbits = curves_of(family)}}), fmt::format("figure_6_{}", id),
           curve_footer(family));
      values_["figure_6"].push_back(Json::object({{"members", equilibria_of(family, window)}}));
    }
  }

  void draw_four_views(int figure, const char* id, const char* title, double t_end, double transient) {
    const LiverFamily& family = liver_family(id);
    draw(told_by_sex(four_views(title, curves_of(family, t_end), transient)),
         fmt::format("figure_{}_{}", figure, id), curve_footer(family));
  }

  void forced() {
    progress_("figure 7");
    draw_four_views(7, "forced_amplitude", "The force sets the size of the lasting motion", 40, 15);
    draw_four_views(7, "forced_stiffness", "A stiffer liver moves less under the same force", 40, 15);
    draw_four_views(7, "forced_damping", "Damping decides how long the start is remembered", 40, 15);
  }

  void benchmark_liver() {
    progress_("figure 8");
    draw_four_views(8, "benchmark_unforced", "The benchmark livers without force", 8, 4);
    draw_four_views(8, "benchmark_forced", "The benchmark livers under force", 30, 4);
    values_["figure_8"] = equilibria_of(liver_family("benchmark_unforced"), Window{{-1, -1}, {1, 1}});
    for (const char* table : {"benchmark_liver", "benchmark_liver_mass"})
      page_.show(table, published_table(table));
  }

  const StudyRows& rows_;
  ReportPage page_;
  Json& values_;
  const std::function<void(const std::string&)>& progress_;
};

}  // namespace

fs::path reproduce_oscillators(const StudyRows& rows, const fs::path& folder,
                               const std::function<void(const std::string&)>& progress) {
  return Study(rows, folder, progress).write();
}

}  // namespace hmax
