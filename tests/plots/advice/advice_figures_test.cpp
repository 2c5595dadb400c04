#include "plots/advice/advice_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "plots/alt_text.hpp"
#include "plots/draw.hpp"

namespace hmax {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

AdviceRecord row(const std::string& method, const std::string& verdict, double ms, double error,
                 double h = 1e-3, double h_max = AdviceRecord::none, double observed = AdviceRecord::none) {
  AdviceRecord record;
  record.method = method;
  record.verdict = verdict;
  record.frame_p50 = 1e-3 * ms;
  record.error = error;
  record.h = h;
  record.h_max = h_max;
  record.h_max_observed = observed;
  return record;
}

AdviceKey question() {
  AdviceKey key;
  key.rate = 100;
  key.tolerance = 0.01;
  key.budget = 0.01;
  return key;
}

std::vector<AdviceRecord> rows() {
  return {row("rk4", "recommended", 0.08, 0.007, 2e-3, 2.3e-3, 2.29e-3),
          row("newmark", "tie", 0.085, 0.001, 10e-3, infinity),
          row("rk2_heun", "suitable", 0.2, 0.002, 1e-3, 1.2e-3),
          row("sdirk_4", "too_slow", 30, 1e-6, 10e-3, infinity),
          row("explicit_euler", "unstable", 2, infinity, 1e-5, 1e-6),
          row("imex_euler", "unstable", AdviceRecord::none, AdviceRecord::none, AdviceRecord::none, 0)};
}

const Curve& curve_of(const Panel& panel, const std::string& label) {
  const auto found = std::ranges::find(panel.curves, label, &Curve::label);
  EXPECT_NE(found, panel.curves.end()) << label;
  return *found;
}

TEST(AdviceCostFigure, ShowsEachRowByItsVerdict) {
  const Figure figure = advice_cost_figure(question(), rows(), "largest displacement");
  ASSERT_EQ(figure.panels.size(), 1U);
  const Panel& panel = figure.panels[0];
  EXPECT_TRUE(panel.x.logarithmic && panel.y.logarithmic);
  EXPECT_EQ(panel.y.label, "error, relative to the largest displacement [%]");
  ASSERT_EQ(panel.marks.size(), 1U);
  EXPECT_EQ(panel.marks[0].name, "rk4");
  EXPECT_NEAR(panel.marks[0].x, 0.08, 1e-12);
  EXPECT_NEAR(panel.marks[0].y, 0.7, 1e-12);
  EXPECT_EQ(curve_of(panel, "tie").x.size(), 1U);
  EXPECT_EQ(curve_of(panel, "suitable").x.size(), 1U);
  // The one that is too slow, and in the strip the one that did not reach its end.
  EXPECT_EQ(curve_of(panel, "not suitable").x.size(), 1U);
  EXPECT_EQ(curve_of(panel, "not suitable").lost.size(), 1U);
  ASSERT_EQ(panel.notes.size(), 2U);
  EXPECT_EQ(panel.notes[1], "1 without a time or an error is not shown");
}

TEST(AdviceCostFigure, HasLinesAtToleranceAndBudget) {
  const Panel panel = advice_cost_figure(question(), rows(), "").panels[0];
  const Curve &tolerance = curve_of(panel, "tolerance 1 %"), &budget = curve_of(panel, "budget 10 ms");
  EXPECT_NEAR(tolerance.y[0], 1, 1e-12);
  EXPECT_EQ(tolerance.y[0], tolerance.y[1]);
  EXPECT_NEAR(budget.x[0], 10, 1e-12);
  EXPECT_EQ(budget.x[0], budget.x[1]);
  for (const Curve& curve : panel.curves)
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      EXPECT_GE(curve.x[i], panel.x.range->low) << curve.label;
      EXPECT_LE(curve.x[i], panel.x.range->high) << curve.label;
      EXPECT_GE(curve.y[i], panel.y.range->low) << curve.label;
      EXPECT_LE(curve.y[i], panel.y.range->high) << curve.label;
    }
  EXPECT_LT(panel.x.range->low, 0.08);
  EXPECT_GT(panel.x.range->high, 30);
}

TEST(AdviceCostFigure, IsDrawnOfNothingToo) {
  const FigureSource source = source_of(advice_cost_figure(question(), {}, "largest displacement"), "cost");
  EXPECT_NE(source.script.find("budget 10 ms"), std::string::npos);
  EXPECT_EQ(source.data.find("nan"), std::string::npos);
}

TEST(AdviceStepFigure, HasTheRowsWithLimitsTheBestAtTheTop) {
  const auto figure = advice_step_figure(rows());
  ASSERT_TRUE(figure);
  const Panel& panel = figure->panels.at(0);
  EXPECT_EQ(panel.y.names, (std::vector<std::string>{"explicit_euler", "rk2_heun", "rk4"}));
  const Curve &step = curve_of(panel, "step h"), &predicted = curve_of(panel, "h_max predicted"),
              &observed = curve_of(panel, "h_max observed");
  EXPECT_EQ(step.y, (std::vector<double>{1, 2, 3}));
  EXPECT_NEAR(step.x[2], 2, 1e-12);
  EXPECT_NEAR(predicted.x[2], 2.3, 1e-12);
  ASSERT_EQ(observed.x.size(), 1U);
  EXPECT_EQ(observed.y[0], 3);
  EXPECT_NE(alt_text(*figure).find("method over step [ms] (logarithmic)"), std::string::npos)
      << alt_text(*figure);
}

TEST(AdviceStepFigure, IsNoneWhereEveryStepIsStable) {
  EXPECT_FALSE(advice_step_figure({row("newmark", "recommended", 1, 0.001, 1e-2, infinity)}));
  EXPECT_FALSE(advice_step_figure({}));
}

}  // namespace
}  // namespace hmax
