#include <cmath>
#include <iterator>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "plots/curves.hpp"
#include "plots/draw.hpp"
#include "plots/pages/report.hpp"
#include "plots/running_totals.hpp"
#include "plots/steps.hpp"

namespace hmax {
namespace {

Row row(const std::string& method, const std::string& mode, double h, double seconds, double error,
        const std::string& outcome = "reached_end") {
  Row r;
  r.key.problem = "liver_forced";
  r.key.method = method;
  r.key.mode = mode;
  r.key.h = h;
  r.key.t_end = 100;
  r.outcome = outcome;
  r.steps = static_cast<std::int64_t>(100 / h);
  r.cpu_s = {seconds * 0.9, seconds, seconds * 1.2};
  r.error_global = error;
  return r;
}

const std::vector<ShownMethod> shown_methods{
    {"explicit_euler", 1}, {"rk4", 4}, {"rk4_38", 4}, {"dormand_prince_54", 5, "ode45"}};

std::vector<Row> rows() {
  return {row("rk4", "fixed", 0.01, 1e-3, 1e-8),
          row("rk4", "fixed", 0.1, 1e-4, 1e-4),
          row("rk4", "fixed", 2, 1e-6, NAN, "diverged"),
          row("explicit_euler", "fixed", 0.1, 5e-5, 1e-2),
          row("explicit_euler", "fixed", 2, 1e-6, NAN, "diverged"),
          row("dormand_prince_54", "sampled", 0.1, 2e-4, 1e-5),
          row("dormand_prince_54", "sampled", 2, 1e-4, 1e-5),
          row("not_wanted", "fixed", 0.1, 1, 1)};
}

TEST(Figures, RefuseExploredRows) {
  std::vector<Row> some = rows();
  some[0].explored = true;
  EXPECT_THROW(step_figure(some, shown_methods), InputError);
  EXPECT_THROW(step_cost_figure(some, shown_methods), InputError);
  EXPECT_THROW(work_precision_figure(some, shown_methods), InputError);
  EXPECT_THROW(run_time_panel(some, "fixed", shown_methods), InputError);
}

TEST(Figures, ShowOneDeviceOrTheProcessor) {
  std::vector<Row> some = rows();
  for (Row& row : some) {
    row.key.device = "card";
    row.device_s.swap(row.cpu_s);
  }
  const Panel there = run_time_panel(some, "fixed", shown_methods),
              here = run_time_panel(rows(), "fixed", shown_methods);
  EXPECT_EQ(here.title, "CPU time of one run");
  EXPECT_EQ(here.y.label, "CPU time [s]");
  EXPECT_EQ(there.title, "Device time of one run on card");
  EXPECT_EQ(there.y.label, "device time [s]");
  EXPECT_EQ(there.curves.at(1).y, here.curves.at(1).y);
  EXPECT_EQ(work_precision_figure(some, shown_methods).panels[0].y.label, "device time [s]");
  EXPECT_EQ(step_cost_figure(some, shown_methods).panels[0].y.label, "device time per step [ns]");
  some[0] = rows()[0];
  EXPECT_THROW(step_figure(some, shown_methods), InputError);
  EXPECT_THROW(step_cost_figure(some, shown_methods), InputError);
  EXPECT_THROW(work_precision_figure(some, shown_methods), InputError);
}

TEST(StepFigure, ShowsTimeOverErrorForBothReadingsOfAStep) {
  const Figure figure = step_figure(rows(), shown_methods);
  ASSERT_EQ(figure.panels.size(), 4u);
  EXPECT_EQ(figure.columns, 2);
  const Panel& time = figure.panels[0];
  ASSERT_EQ(time.curves.size(), 2u);
  const Curve& rk4 = time.curves[1];
  EXPECT_EQ(rk4.label, "rk4");
  EXPECT_EQ(rk4.x, (std::vector<double>{0.01, 0.1}));
  EXPECT_EQ(rk4.y, (std::vector<double>{1e-3, 1e-4}));
  EXPECT_EQ(rk4.lost, (std::vector<double>{2}));
  EXPECT_LT(rk4.low[0], rk4.y[0]);
  EXPECT_GT(rk4.high[0], rk4.y[0]);
  EXPECT_EQ(figure.panels[1].curves.at(0).label, "ode45");
  EXPECT_EQ(figure.panels[2].curves[1].y, (std::vector<double>{1e-8, 1e-4}));
  EXPECT_EQ(figure.panels[2].curves[1].lost, (std::vector<double>{2}));
}

TEST(StepFigure, OneReadingAloneStandsSideBySide) {
  std::vector<Row> fixed = rows();
  std::erase_if(fixed, [](const Row& r) { return r.key.mode != "fixed"; });
  const Figure figure = step_figure(fixed, shown_methods);
  EXPECT_EQ(figure.panels.size(), 2u);
  EXPECT_EQ(figure.columns, 2);
}

TEST(StepFigure, RowsOfTwoProblemsAreRefused) {
  std::vector<Row> mixed = rows();
  mixed[1].key.parameters = "c=6";
  EXPECT_THROW(step_figure(mixed, shown_methods), InputError);
  EXPECT_THROW(step_figure({}, shown_methods), InputError);
  EXPECT_THROW(work_precision_figure({}, shown_methods), InputError);
  EXPECT_THROW(step_cost_figure({}, shown_methods), InputError);
}

TEST(StepFigure, OtherFailuresAreNotCalledDivergence) {
  std::vector<Row> other = rows();
  EXPECT_EQ(run_time_panel(other, "fixed", shown_methods).lost_label, "diverged");
  other[2].outcome = "too_many_steps";
  EXPECT_EQ(run_time_panel(other, "fixed", shown_methods).lost_label, "did not reach the end");
}

TEST(StepCostFigure, DividesTheMedianByTheSteps) {
  const Figure figure = step_cost_figure(rows(), shown_methods);
  EXPECT_NEAR(figure.panels.at(0).curves.at(1).y.at(0), 1e-3 / 1e4 * 1e9, 1e-9);
}

TEST(WorkPrecisionFigure, DrawsTheCostOfTheFewestStepsThatAreStable) {
  // 50 steps of 2 s take 1 ms and 200 evaluations; of 2.5 s, the largest stable ones, 40 would do.
  std::vector<Row> some{row("rk4", "fixed", 2, 1e-3, 1e-2), row("rk4", "fixed", 0.1, 2e-2, 1e-6)};
  for (Row& each : some) each.rhs = 4 * each.steps;
  const auto limits = [&](double stable_step) {
    std::vector<Curve> found;
    for (const Panel& panel :
         work_precision_figure(some, {{.id = "rk4", .order = 4, .stable_step = stable_step}}, "error").panels)
      for (const Curve& curve : panel.curves)
        if (curve.label == "least for stability") found.push_back(curve);
    return found;
  };
  const std::vector<Curve> lines = limits(2.5);
  ASSERT_EQ(lines.size(), 2U);
  for (const Curve& line : lines) EXPECT_EQ(line.x, (std::vector{1e-6, 1e-2}));
  EXPECT_NEAR(lines[0].y.at(0), 0.8e-3, 1e-12);
  EXPECT_NEAR(lines[1].y.at(0), 160, 1e-9);
  // Longer steps would be stable than any that was taken; nothing held it back.
  EXPECT_TRUE(limits(3.5).empty());
  EXPECT_TRUE(limits(INFINITY).empty());
}

TEST(MethodStyles, NoTwoOfManyMethodsLookTheSame) {
  std::vector<ShownMethod> methods;
  const int orders[] = {1, 2, 2, 2, 3, 3, 3, 4, 4, 5, 5, 5, 8, 8, 0, 6};
  for (const int order : orders) methods.push_back({std::string(methods.size() + 1, 'm'), order});
  const auto styles = method_styles(methods);
  for (std::size_t i = 0; i < styles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_FALSE(styles[i].colour == styles[j].colour && styles[i].dash == styles[j].dash &&
                   styles[i].marker == styles[j].marker)
          << i << ' ' << j;
}

Table orbit() {
  return {{}, {"t [s]", "x [m]", "v [m/s]"}, {{0, 1, 2, 3}, {1, 0.5, INFINITY, 7}, {0, -1, 0, 0}}};
}

TEST(Series, CurvesEndWhereTheyStopBeingFinite) {
  const Panel panel = series_panel("", {{"c = 1", orbit()}}, "t [s]", "x [m]");
  EXPECT_EQ(panel.curves.at(0).x, (std::vector<double>{0, 1}));
}

TEST(Series, AMissingColumnIsNamed) {
  try {
    series_panel("", {{"c = 1", orbit()}}, "t [s]", "a [m/s^2]");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no column 'a [m/s^2]'; it has t [s], x [m], v [m/s]"),
              std::string::npos)
        << error.what();
  }
}

TEST(PhasePanel, NamesTypeAndEigenvaluesOfEveryRestPoint) {
  const Panel panel = phase_panel({.orbits = {{"a", orbit()}},
                                   .rest_points = {{0, -1e-18, "stable_focus", {{{-0.5, 2}, {-0.5, -2}}}},
                                                   {1.5, 0, "saddle", {{{1, 0}, {-2, 0}}}},
                                                   {0, 0, "centre", {{{0, 0.5}, {0, -0.5}}}}}});
  ASSERT_EQ(panel.notes.size(), 3u);
  EXPECT_EQ(panel.notes[0], "stable focus at (0, 0): λ = −0.5 ± 2i 1/s");
  EXPECT_EQ(panel.notes[1], "saddle at (1.5, 0): λ = 1, −2 1/s");
  EXPECT_EQ(panel.notes[2], "centre at (0, 0): λ = ±0.5i 1/s");
  EXPECT_EQ(panel.marks.size(), 4u);  // three rest points and the start of the orbit
}

TEST(PhasePanel, OrbitsFromOnePointShareItsMark) {
  LabelledTable other{"b", orbit()};
  EXPECT_EQ(phase_panel({.orbits = {{"a", orbit()}, other}}).marks.size(), 1u);
  for (std::vector<double>& values : other.table.values) values.front() += 1;
  EXPECT_EQ(phase_panel({.orbits = {{"a", orbit()}, other}}).marks.size(), 2u);
}

TEST(PhasePanel, ADoubleEigenvalueIsNoPairForItsRounding) {
  const Panel panel = phase_panel({.rest_points = {{0, 0, "stable_node", {{{-1.5, 2e-8}, {-1.5, -2e-8}}}}}});
  EXPECT_EQ(panel.notes.at(0), "stable node at (0, 0): λ = −1.5, −1.5 1/s");
}

TEST(RunningTotals, TheOrderOfRunningFollowsTheClock) {
  // Three solvers on one clock: b ran first, then c, then a; d belongs to another session.
  const Table printed{{}, {"h", "a", "b", "c", "d"}, {{1, 0.1}, {9, 12}, {1, 2}, {2, 8.5}, {5, 6}}};
  EXPECT_EQ(order_of_running(printed), (std::vector<std::string>{"b", "c", "a"}));
  const Figure figure = running_totals_figure(printed, rows(), "fixed", {{"explicit_euler", 1}});
  ASSERT_EQ(figure.panels.size(), 4u);
  EXPECT_EQ(figure.panels[0].curves.size(), 4u);
  EXPECT_EQ(figure.panels[1].curves.size(), 3u);
  EXPECT_EQ(figure.panels[1].curves[0].label, "a");
  EXPECT_EQ(figure.panels[1].curves[0].x, (std::vector<double>{5, 6}));
  EXPECT_EQ(figure.panels[3].curves.at(0).label, "explicit_euler");
  // The first column is that of the first method and looks like it, here as in the figure of the steps.
  const Style euler = method_styles({{"explicit_euler", 1}}).front();
  for (const std::size_t panel : {0U, 3U})
    EXPECT_EQ(figure.panels[panel].curves[0].style.colour, euler.colour);
  for (const Panel& panel : figure.panels)
    for (const std::string& note : panel.notes) EXPECT_LE(note.size(), 55U) << note << " is cut";
  EXPECT_EQ(figure.panels[2].curves[2].y, (std::vector<double>{6.5}));
  EXPECT_THROW(order_of_running({{}, {"h", "a"}, {{1, 2}, {1}}}), InputError);
}

TEST(Report, ShowsFiguresWithRelativeLinksAndTellsWhatIsMissing) {
  const FigureFiles drawn{"out/figures/steps", {}, "", "falls_as h"},
      missing{"out/phase", {}, "gnuplot is not installed"};
  EXPECT_EQ(figure_markdown(drawn, "out"),
            "[![falls\\_as h](figures/steps.png)](figures/steps.svg)\n\n[SVG](figures/steps.svg) · "
            "[PDF](figures/steps.pdf) · [script](figures/steps.gp) · [data](figures/steps.dat)");
  EXPECT_EQ(figure_markdown(missing, "out"),
            "_Not drawn: gnuplot is not installed_ · [script](phase.gp) · [data](phase.dat)");
}

TEST(Report, NamesCannotBecomeMarkup) {
  EXPECT_EQ(markdown_text("rk2_heun <b>`x`|\n"), "rk2\\_heun &lt;b\\>\\`x\\`\\| ");
  EXPECT_EQ(markdown_table({{}, {"h [s]", "a|b"}, {{0.5, 2}, {NAN, 1e-20}}}),
            "| h \\[s\\] | a\\|b |\n| --- | ---: |\n| 0.5 | – |\n| 2 | 1e-20 |\n");
  EXPECT_EQ(markdown_rows({{"a", "b", "c"}, {"x", "1 %", "<yes>"}, {"y", "-", "no"}}),
            "| a | b | c |\n| --- | ---: | --- |\n| x | 1 % | &lt;yes\\> |\n| y | - | no |\n");
  EXPECT_EQ(markdown_facts({{"error", "1 %"}, {"runs", "*one*"}, {"", "another"}, {"none", ""}}),
            "| | |\n| --- | --- |\n| error | 1 % |\n| runs | \\*one\\* |\n|  | another |\n\n");
  EXPECT_EQ(markdown_list({"x", "<b>"}), "- x\n- &lt;b\\>\n\n");
}

}  // namespace
}  // namespace hmax
