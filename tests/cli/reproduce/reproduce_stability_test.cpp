#include "cli/reproduce/reproduce_stability.hpp"

#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "plots/gnuplot.hpp"
#include "plots/pages/store_report.hpp"
#include "results/table.hpp"
#include "tests/cli/html_links.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST(StabilityReport, ShowsPredictedBesideObservedAndAgrees) {
  const Scratch scratch;
  std::vector<LimitCase> cases = limit_cases();
  ASSERT_GE(cases.size(), 25u);
  // One material, one underdamped and one critically damped curve, one cubic and one driven model.
  std::vector<LimitCase> some{cases.front()};
  for (const char* family : {"linear_damping", "linear_critical", "cubic_damping", "forced_amplitude"})
    for (const LimitCase& each : cases)
      if (each.family == family) {
        some.push_back(each);
        break;
      }
  ASSERT_EQ(some.size(), 5u);
  std::vector<Method> chosen;
  for (const char* id :
       {"explicit_euler", "rk4", "abm_pece_3", "newmark", "central_difference", "implicit_euler"})
    chosen.push_back(find_method(id));
  const auto never = [] { return false; };
  Store store = Store::open_or_create(scratch / "limits.sqlite");
  const auto rows = limit_study(
      some, CaseKind::linear, chosen, &store, [](double) {}, never);
  ASSERT_EQ(rows.size(), 18u);
  const LimitSummary summary = summary_of(some, rows);
  EXPECT_EQ(summary.with_number, 12u);
  EXPECT_EQ(summary.unbounded, 6u);
  EXPECT_EQ(summary.disagreeing, 0u) << summary.worst;
  EXPECT_LT(summary.worst_gap, 1e-3) << summary.worst;
  const auto nonlinear = limit_study(
      some, CaseKind::nonlinear, {find_method("rk4")}, &store, [](double) {}, never);
  ASSERT_EQ(nonlinear.size(), 2u);
  EXPECT_GT(nonlinear[1].limit.along_least, 0);

  // Every number of the report is a stored row, and is not computed twice.
  EXPECT_EQ(store.limits().size(), 20u);
  const auto again = limit_study(
      some, CaseKind::linear, chosen, &store, [](double) { ADD_FAILURE() << "computed again"; }, never);
  ASSERT_EQ(again.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(again[i].limit.method, rows[i].limit.method);
    EXPECT_EQ(again[i].limit.observed, rows[i].limit.observed);
  }

  const ReportedStore stored = reported_store(store, "limits.sqlite");
  write_file(scratch / "rows.html", store_report({&stored, 1}, "1.2.3").html);
  const fs::path report = reproduce_stability(some, rows, nonlinear, "a machine", scratch.folder());
  EXPECT_EQ(report, scratch / "index.html");
  EXPECT_NE(text_of(report).find("<a href=\"rows.html\">Every row, with figures to hover over</a>"),
            std::string::npos);
  expect_whole_pages(scratch.folder(), 5);
  EXPECT_NE(text_of(report).find("0 disagree"), std::string::npos);
  EXPECT_NE(text_of(scratch / "limits.csv").find("male_slim:light"), std::string::npos);
  EXPECT_NE(text_of(scratch / "nonlinear.csv").find("rk4"), std::string::npos);
  EXPECT_EQ(fs::exists(scratch / "hmax_predicted_vs_observed.svg"), gnuplot_available());
}

}  // namespace
}  // namespace hmax
