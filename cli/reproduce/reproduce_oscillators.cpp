#include "cli/reproduce/reproduce_oscillators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "analysis/dynamics/phase_plane.hpp"
#include "bench/timing/sweep.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/series.hpp"
#include "cli/reproduce/oscillator_claims.hpp"
#include "plots/curves.hpp"
#include "plots/draw.hpp"
#include "plots/pages/report.hpp"
#include "plots/running_totals.hpp"
#include "plots/steps.hpp"
#include "problems/oscillator/liver_problems.hpp"
#include "results/published/published.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

// Curves are drawn from a method whose error is far below the width of a line.
constexpr std::string_view curve_method = "dop_853";
constexpr double curve_tolerance = 1e-10;
constexpr int curve_points = 1500;

/// A member of a family as a problem of the catalogue.
Problem problem_of(const LiverFamilyMember& member, const Eigen::Vector2d& y0) {
  ProblemSettings settings;
  for (const auto& [name, value] : oscillator_parameter_names)
    settings.parameters.emplace_back(std::string(name), member.parameters.*value);
  settings.y0 = {y0[0], y0[1]};
  return make_problem("liver_forced", settings);
}

LabelledTable curve_of(const LiverFamilyMember& member, const Eigen::Vector2d& y0, double t_end) {
  return {member.label, motion(problem_of(member, y0), find_method(curve_method), curve_tolerance, t_end,
                               t_end / curve_points)};
}

std::vector<LabelledTable> curves_of(const LiverFamily& family, double t_end = 0) {
  std::vector<LabelledTable> curves;
  for (const LiverFamilyMember& member : family.members)
    curves.push_back(curve_of(member, family.y0, t_end > 0 ? t_end : family.t_end));
  return curves;
}

/// The equilibria of the unforced member in words: "stable_focus at (0, 0), eigenvalues -0.69 +- 0.085i".
std::string describe(const std::vector<Equilibrium>& equilibria) {
  std::string text;
  for (const Equilibrium& e : equilibria) {
    const auto& [first, second] = e.eigenvalues;
    // Rounding splits a double eigenvalue into a pair about sqrt(epsilon) apart.
    const std::string values = std::abs(first.imag()) > 1e-7 * std::abs(first)
                                   ? fmt::format("{:.4g} ± {:.4g}i", first.real(), std::abs(first.imag()))
                                   : fmt::format("{:.4g} and {:.4g}", first.real(), second.real());
    text += fmt::format("{}`{}` at ({:.3g}, {:.3g}), eigenvalues {} 1/s", text.empty() ? "" : "; ",
                        name_of(e.type), e.state[0] + 0.0, e.state[1] + 0.0, values);
  }
  return text.empty() ? "none in this window" : text;
}

/// The field of a member without its force: a phase plane is drawn for the autonomous model.
PlanarField unforced(OscillatorParameters parameters) {
  parameters.P = 0;
  return frozen_at(Oscillator(parameters));
}

/// | member | equilibria |
std::string equilibria_table(const LiverFamily& family, const Window& window) {
  std::string text = "| member | equilibria without the force |\n| --- | --- |\n";
  for (const LiverFamilyMember& member : family.members)
    text += fmt::format("| {} | {} |\n", markdown_text(member.label),
                        describe(find_equilibria(unforced(member.parameters), window)));
  return text;
}

/// Direction field, nullclines, orbits from several starts, equilibria of one member.
PhasePlane phase_plane_of(const LiverFamilyMember& member, const std::vector<Eigen::Vector2d>& starts,
                          double t_end, const Window& window) {
  const PlanarField field = unforced(member.parameters);
  PhasePlane plane{.title = member.label,
                   .x_range = Range{window.lower[0], window.upper[0]},
                   .v_range = Range{window.lower[1], window.upper[1]},
                   .direction_field = direction_field(field, window, {"x [m]", "v [m/s]"})};
  for (const Eigen::Vector2d& start : starts)
    plane.orbits.push_back(
        {fmt::format("from ({:g}, {:g})", start[0], start[1]), curve_of(member, start, t_end).table});
  for (const int component : {0, 1})
    plane.nullclines[static_cast<std::size_t>(component)] = plane_curves(nullcline(field, component, window));
  for (const Equilibrium& e : find_equilibria(field, window))
    plane.rest_points.push_back({e.state[0], e.state[1], std::string(name_of(e.type)), e.eigenvalues});
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

std::vector<ShownMethod> all_methods_shown() {
  std::vector<ShownMethod> list;
  for (const Method& method : choose_methods(study_methods(), {})) list.push_back({method.id, method.order});
  return list;
}

/// Medians of the CPU time of one run [ms] by step, a column per method, NaN where the method has no such
/// row. Three digits: a repeated measurement agrees in no more.
Table run_times(const std::vector<Row>& rows, const std::string& mode, const std::vector<ShownMethod>& list) {
  std::map<double, std::map<std::string, double>, std::greater<>> by_step;
  for (const Row& row : rows)
    if (row.key.mode == mode && row.outcome == "reached_end")
      by_step[row.key.h][row.key.method] =
          std::stod(fmt::format("{:.3g}", summarise(row.cpu_s).median * 1e3));
  Table table{.notes = {}, .columns = {"h [s]"}, .values = {{}}};
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

/// The sections of one report; every figure carries the same foot.
class Study {
 public:
  Study(const StudyRows& rows, fs::path folder, const std::function<void(const std::string&)>& progress)
      : rows_(rows), folder_(std::move(folder)), progress_(progress) {}

  fs::path write() {
    timing();
    table_2();
    starts();
    progress_("tolerances");
    sections_.push_back(defaults_section());
    linear_families();
    phase_planes_of_stiffness();
    phase_planes_of_damping();
    forced();
    benchmark_liver();
    progress_("sentences");
    sections_.push_back(claims_section(rows_.published_model));
    return write_report("The liver oscillator study, done again",
                        "Every oscillator figure and table of the study of the liver model `m x'' + c x' + "
                        "k1 x + k3 x³ = P cos(w t)`, drawn from runs of hmax, each beside what the study "
                        "printed and what differs. Curves are drawn from `" +
                            std::string(curve_method) +
                            fmt::format("` at rtol = atol = {:g}", curve_tolerance) +
                            ". Times were measured on: " + markdown_text(rows_.machine) +
                            ". The study's stiffness in kPa and damping in N/m² cannot enter this equation; "
                            "like the study we use the bare numbers as N/m and N s/m." +
                            (rows_.rows_link.empty() ? "" : "\n\n" + rows_.rows_link),
                        sections_, folder_);
  }

 private:
  FigureFiles drawn(Figure figure, const std::string& name, const std::string& footer) {
    figure.footer = footer;
    return draw(figure, folder_, name);
  }
  static std::string curve_footer(const LiverFamily& family) {
    return fmt::format("{}, rtol = atol = {:g}; x(0) = {:g} m, v(0) = {:g} m/s; {}", curve_method,
                       curve_tolerance, family.y0[0], family.y0[1], family.note);
  }
  std::string timing_footer() const {
    return "CPU time, median of 9 interleaved repetitions; " + rows_.machine;
  }

  /// The solvers of the study under its names for them.
  auto the_five() const {
    return shown({{"explicit_euler", "Euler"},
                  {"dormand_prince_54", "ode45"},
                  {"rosenbrock_23", "ode23s"},
                  {"adams_pece", "ode113"},
                  {"trapezoidal", "ode23t"}});
  }

  void timing() {
    progress_("figure 1");
    const auto five = the_five();
    const auto all = all_methods_shown();
    Figure few = step_figure(rows_.published_model, five);
    few.title = "A smaller step costs in proportion; the error stops falling at rounding";
    Figure many = step_figure(rows_.published_model, all);
    many.title = "The study's solvers and every explicit one-step method of hmax on the full liver model";
    Figure cost = step_cost_figure(rows_.published_model, all);
    cost.title = "The cost of one explicit step hardly depends on its size";
    Figure exciting = step_figure(rows_.self_exciting, five);
    exciting.title = "With the damping of -2 that the study's text names, only small steps follow the growth";
    sections_.push_back(
        {.title = "Figure 1: CPU time against step size",
         .text = "The full model `1.45 x'' + 2 x' + 0.7 x + 0.8 x³ = 0.5 cos(0.5 t)`, x(0) = 0.5, x'(0) = 1, "
                 "t = 0 … 100 s, nine steps. Left: every method integrates with the step h. Right: the "
                 "method chooses its own steps (rtol = atol = 1e-6) and h is only the output interval, which "
                 "is what `0:h:T` means in MATLAB: its error hardly depends on h, and its cost only through "
                 "the number of output points. Runs that diverge stand in the strip at the top: at h = 2 "
                 "explicit Euler and RK4 overflow although h = 2 is linearly stable at x = 0, because the "
                 "cubic term stiffens the model on the way from its start.\n\n"
                 "The study's text speaks of a damping of -2, its model of +2. With -2 the model is "
                 "self-exciting: its amplitude grows without bound, so the last figure ends at t = 10 s.",
         .figures = {drawn(few, "figure_1_cpu_time", timing_footer()),
                     drawn(many, "figure_1_all_methods", timing_footer()),
                     drawn(cost, "figure_1_cost_of_a_step", timing_footer()),
                     drawn(exciting, "figure_1_damping_minus_2", timing_footer())},
         .printed = "CPU time of Euler, ode45, ode23s, ode113 and ode23t against the step on a logarithmic "
                    "axis: five nearly horizontal lines.",
         .differs =
             "The printed lines are horizontal because they are running totals (see table 2). Measured, the "
             "time of a fixed-step run is proportional to 1/h. ode113 always chooses its own steps and "
             "order, so it stands on the right only."});
  }

  void table_2() {
    progress_("table 2");
    const Table published = published_table("table_2");
    Figure figure = running_totals_figure(published, rows_.published_model, "sampled", the_five());
    figure.title = "Table 2 holds running totals: four of five solvers start where another has ended";
    sections_.push_back(
        {.title = "Table 2: execution times",
         .text =
             "First the table as printed [s], then its differences down each column [s], then our measured "
             "counterpart: milliseconds for one run with the step h (fixed), and milliseconds with h as "
             "output interval (sampled). A dash is a run that did not reach t = 100 s, or a method without "
             "error control.",
         .figures = {drawn(figure, "table_2_running_totals", timing_footer())},
         .tables = {markdown_table(published), markdown_table(differences_per_column(published)),
                    markdown_table(run_times(rows_.published_model, "fixed", the_five())),
                    markdown_table(run_times(rows_.published_model, "sampled", the_five()))},
         .printed =
             "Execution times of 1444 s (Euler), 588 s (ode45), 964 s (ode23s), 1336 s (ode113) and 1700 s "
             "(ode23t), nearly independent of the step; conclusion: ode45 is the fastest, Euler and ode23t "
             "the slowest.",
         .differs =
             "**They are not execution times.** The printed code stores MATLAB's `cputime`, the total since "
             "the program was started: ode45 ends at 963.587 where ode23s starts at 963.6; ode23s ends at "
             "1335.6 where ode113 starts; ode113 ends at 1699.9 where ode23t starts at 1700. The printed "
             "ranking is the order in which the solvers were run. The differences down each column are the "
             "measurement: for the last step 3.4 s (Euler), 371.75 s (ode45), 368.3 s (ode23s), 360.5 s "
             "(ode113) and 35.4 s (ode23t), so Euler was the cheapest a run and not the dearest. Its "
             "column lies inside that of ode113 (1335.6 to 1699.9 s) and is no link of the chain: it comes from "
             "another run of the program, and the totals say nothing of its rank. hmax subtracts before from "
             "after, and its own columns do confirm one sentence of the study: with h as output interval ode45 "
             "is the fastest of those that choose their steps, at every h."});
  }

  /// What the study leaves open about its timing experiment.
  void starts() {
    progress_("equations 2.5 and 2.9");
    const LiverFamily& timing = liver_family("timing");
    const LiverFamilyMember& full = timing.members.front();
    LiverFamilyMember rest = full, set = full;
    rest.label = "from rest, (0, 0), as equation 2.9";
    set.label = "k1 = 0.8 N/m";
    set.parameters.k1 = 0.8;
    const auto begun = [](const LiverFamilyMember& member, const Eigen::Vector2d& y0,
                          const std::string& label) {
      LabelledTable curve = curve_of(member, y0, 20);
      curve.label = label;
      return curve;
    };
    const LabelledTable printed = begun(full, timing.y0, "from (0.5, 1), as equation 2.5"),
                        resting = begun(rest, {0, 0}, rest.label),
                        stiffer = begun(set, timing.y0, "k1 = 0.8 N/m");
    const auto apart = [&](const LabelledTable& other, double from) {
      const std::vector<double>&t = printed.table.values[0], &x = printed.table.values[1],
            &z = other.table.values[1];
      double most = 0;
      for (std::size_t i = 0; i < t.size(); ++i)
        if (t[i] >= from) most = std::max(most, std::abs(x[i] - z[i]));
      return most;
    };
    Figure figure = series_figure("Start and stiffness of the timing experiment, c = 2",
                                  {printed, resting, {"from (0.5, 1), k1 = 0.8 N/m", stiffer.table}});
    sections_.push_back(
        {.title = "Equations 2.5 and 2.9: the start, and the set that was timed",
         .text = fmt::format(
             "The start is forgotten: the two motions are up to {:.2g} m apart, after 10 s {:.2g} m and after "
             "15 s {:.2g} m. The text's set of the timing experiment, \"damping constant of -2, internal "
             "stiffness of 0.8\", is read as the cubic stiffness of the model or as its linear one; with "
             "k1 = 0.8 instead of 0.7 N/m the motion differs by at most {:.2g} m. Neither changes what a step "
             "costs. The sign of the damping does, see figure 1.",
             apart(resting, 0), apart(resting, 10), apart(resting, 15), apart(stiffer, 0)),
         .figures = {drawn(
             figure, "equation_2_9_start",
             fmt::format(
                 "{}, rtol = atol = {:g}; m = 1.45 kg, c = 2 N s/m, k1 = 0.7 N/m, k3 = 0.8 N/m³, P = 0.5 N",
                 curve_method, curve_tolerance))},
         .printed = "Equation 2.5 starts at x = 0.5 m, x' = 1 m/s, equation 2.9 at x = x' = 0.",
         .differs = "Everything else in this report starts at (0.5, 1)."});
  }

  void linear_families() {
    const struct {
      std::string_view id, title, printed;
    } figures[] = {
        {"linear_mass", "A heavier liver swings more slowly",
         "displacement against time for m = 1.2, 1.3, 1.4, 1.5 kg"},
        {"linear_stiffness", "A stiffer liver swings faster",
         "displacement against time for k = 4.6, 5.3, 6.0, 6.6"},
        {"linear_damping", "Damping sets how soon the swing dies out",
         "displacement against time for c = 0.1, 0.3, 0.8, 1.0"},
    };
    for (const auto& [id, title, printed] : figures) {
      const LiverFamily& family = liver_family(id);
      progress_(fmt::format("figure {}", family.figure));
      Figure figure = series_figure(std::string(title), curves_of(family));
      sections_.push_back(
          {.title = fmt::format("Figure {}: {}", family.figure, title),
           .text = "Case 1: linear, without force.",
           .figures = {drawn(figure, fmt::format("figure_{}_{}", family.figure, id), curve_footer(family))},
           .printed = "Case 1, " + std::string(printed) + ".",
           .differs = "The values held fixed are not published: " + std::string(family.note) + "."});
    }
  }

  void phase_planes_of_stiffness() {
    progress_("figure 5");
    const Window near_rest{{-0.6, -1.2}, {1, 1.2}};
    const std::string foot =
        fmt::format("{}, rtol = atol = {:g}; arrows: the field of the curve in the middle", curve_method,
                    curve_tolerance);
    std::vector<FigureFiles> figures;
    std::string text =
        "Case 2: cubic, without force. The damping is that of the linear part at rest, c = 2 zeta "
        "sqrt(k1 m): critical with zeta = 1, over-damped with zeta = 2.\n\n";
    for (const std::string_view id : {"cubic_stiffness", "cubic_hardening"}) {
      const bool stiffness = id == "cubic_stiffness";
      std::vector<PhasePlane> planes;
      for (const double zeta : {1.0, 2.0}) {
        const LiverFamily family = damped_as_at_rest(liver_family(id), zeta);
        planes.push_back(phase_plane_of(family.members[1], {}, family.t_end, near_rest));
        planes.back().title = zeta == 1 ? "critically damped" : "over-damped";
        planes.back().nullclines = {};
        planes.back().rest_points = {};
        planes.back().orbits = curves_of(family);
        text += fmt::format("{} varied, {}:\n\n{}\n", stiffness ? "k1" : "k3", planes.back().title,
                            equilibria_table(family, near_rest));
      }
      figures.push_back(drawn(phase_figure(stiffness ? "Without oscillation the liver returns to rest"
                                                     : "So it does whatever the cubic spring",
                                           planes),
                              stiffness ? "figure_5_phase_plane" : "figure_5_hardening", foot));
    }
    sections_.push_back(
        {.title = "Figure 5: phase plane, stiffness varied, critically and over-damped",
         .text = text,
         .figures = std::move(figures),
         .printed =
             "Phase plane with direction field of case 2 for several stiffnesses, critically (red) and over-damped "
             "(blue): both converge to 0, clockwise.",
         .differs =
             fmt::format("Which stiffnesses and dampings were drawn is not published. {}; {}. Away from rest "
                         "the cubic spring is stiffer, so that what is critical at rest is below it there.",
                         liver_family("cubic_stiffness").note, liver_family("cubic_hardening").note)});
  }

  void phase_planes_of_damping() {
    progress_("figure 6");
    const LiverFamily& damping = liver_family("cubic_damping");
    const Window window{{-2, -2}, {2, 2}};
    const std::vector<Eigen::Vector2d> starts{{0.5, 1}, {-1.5, 0}, {1.5, -1.2}, {-0.6, 1.6}};
    std::vector<PhasePlane> four;
    for (const LiverFamilyMember& member : damping.members)
      four.push_back(phase_plane_of(member, starts, damping.t_end / 2, window));
    std::vector<FigureFiles> figures{drawn(phase_figure("From source to node: the damping decides", four),
                                           "figure_6_phase_planes",
                                           fmt::format("{}, rtol = atol = {:g}; four starts (triangles); {}",
                                                       curve_method, curve_tolerance, damping.note))};
    std::string text =
        "Case 2: cubic, without force. Direction field, nullclines, orbits from four starts, and the "
        "equilibria with their eigenvalues:\n\n" +
        equilibria_table(damping, window);
    for (const std::string_view id : {"cubic_stiffness", "cubic_hardening"}) {
      const LiverFamily& family = liver_family(id);
      const char* title = id == "cubic_stiffness" ? "The stiffer the liver, the less far it swings"
                                                  : "The harder the cubic spring, the less far it swings";
      figures.push_back(drawn(phase_figure(title, {{.orbits = curves_of(family)}}),
                              "figure_6_" + std::string(id), curve_footer(family)));
      text += "\n" + equilibria_table(family, window);
    }
    sections_.push_back(
        {.title = "Figure 6: phase planes with direction field, c = -0.2, 0, 2, 10",
         .text = text,
         .figures = figures,
         .printed =
             "Phase planes with direction field for c = -0.2, 0, 2 and 10; c = 0 is called unconditionally "
             "stable and c = 10 conditionally stable.",
         .differs = "The eigenvalues say otherwise: c = 0 is a centre (orbits close, nothing decays), c = 2 "
                    "a stable focus with damping ratio 0.9926, c = 10 a stable node, c = -0.2 an unstable "
                    "focus."});
  }

  void forced() {
    progress_("figure 7");
    std::vector<FigureFiles> figures;
    for (const auto& [id, title] :
         {std::pair{"forced_amplitude", "The force sets the size of the lasting motion"},
          std::pair{"forced_stiffness", "A stiffer liver moves less under the same force"},
          std::pair{"forced_damping", "Damping decides how long the start is remembered"}}) {
      const LiverFamily& family = liver_family(id);
      figures.push_back(drawn(four_views(title, curves_of(family, 40), 15), "figure_7_" + std::string(id),
                              curve_footer(family)));
    }
    sections_.push_back(
        {.title = "Figure 7: the forced model, P, stiffness and damping varied",
         .text = "Case 3: displacement, velocity and acceleration against time, and the phase plane.",
         .figures = figures,
         .printed = "Phase plane, velocity and acceleration for P = 0.1 and 1.0.",
         .differs = "Stiffness and damping were varied in the study with values it does not print; ours "
                    "stand under each figure."});
  }

  void benchmark_liver() {
    progress_("figure 8");
    std::vector<FigureFiles> figures;
    for (const auto& [id, title] : {std::pair{"benchmark_unforced", "The benchmark livers without force"},
                                    std::pair{"benchmark_forced", "The benchmark livers under force"}}) {
      const LiverFamily& family = liver_family(id);
      figures.push_back(
          drawn(four_views(title, curves_of(family, id == std::string_view("benchmark_forced") ? 30 : 8), 4),
                "figure_8_" + std::string(id), curve_footer(family)));
    }
    sections_.push_back(
        {.title = "Figure 8: the benchmark liver with and without force",
         .text = "Six published material sets, male and female, slim, normal and fat.\n\n" +
                 equilibria_table(liver_family("benchmark_unforced"), Window{{-1, -1}, {1, 1}}),
         .figures = figures,
         .tables = {markdown_table(published_table("benchmark_liver")),
                    markdown_table(published_table("benchmark_liver_mass"))},
         .printed = "Acceleration, velocity and phase plane of the benchmark liver with and without force.",
         .differs =
             "The study calls these livers nonlinear, but its table gives no cubic stiffness: ours are linear. The "
             "force is that of the full model. Masses are the middle of the published ranges."});
  }

  const StudyRows& rows_;
  fs::path folder_;
  const std::function<void(const std::string&)>& progress_;
  std::vector<ReportSection> sections_;
};

}  // namespace

fs::path reproduce_oscillators(const StudyRows& rows, const fs::path& folder,
                               const std::function<void(const std::string&)>& progress) {
  return Study(rows, folder, progress).write();
}

}  // namespace hmax
