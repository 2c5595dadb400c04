/// A page over stores in a browser: what its script does when a user sorts, filters, hovers, clicks. Skipped
/// without chromium.
#include <map>

#include <gtest/gtest.h>

#include "plots/pages/store_report.hpp"
#include "tests/plots/pages/browser.hpp"
#include "tests/plots/pages/reported_stores.hpp"

namespace hmax {
namespace {

TEST(StoreReportInABrowser, SortsFiltersAndShowsValues) {
  const std::string program = browser();
  if (program.empty())
    GTEST_SKIP() << "chromium is not installed, so the page is not driven; apt-get install chromium";
  ReportedStore store = made_store("a.sqlite", 250);
  store.runs.front().status = "<i class=\"evil\">x</i>";
  store.advice.front().key.motion = "<i class=\"evil\">x</i>";
  const auto findings =
      findings_on(store_report({&store, 1}, "1.2.3").html, "store_report_actions.js", program);
  const std::map<std::string, std::string> expected{{"rows at first", "200"},
                                                    {"count at first", "first 200 of 250 rows"},
                                                    {"sorted up", "true ascending"},
                                                    {"sorted down", "true descending"},
                                                    {"rows printed", "250, drawings 1"},
                                                    {"rows after printing", "200"},
                                                    {"all rows", "250"},
                                                    {"filtered", "63 true"},
                                                    {"theme changes", "true"},
                                                    {"theme returns", "true"},
                                                    {"tip at first", "hidden"},
                                                    {"tip on hover", "true"},
                                                    {"tip after hover", "hidden"},
                                                    {"tip on focus", "true"},
                                                    {"arrow moves", "true"},
                                                    {"mark leads to its row", "true"},
                                                    {"hidden by the legend", "true false"},
                                                    {"shown by the legend", "true true"},
                                                    {"unbounded", "true"},
                                                    {"markup", "0"},
                                                    {"without names", "0"},
                                                    {"wider than a phone", "nothing"},
                                                    {"errors", "none"}};
  EXPECT_EQ(findings, expected);
}

TEST(StoreReportInABrowser, NamesTheCurvesOfADeviceWhereTheyAre) {
  const std::string program = browser();
  if (program.empty())
    GTEST_SKIP() << "chromium is not installed, so the page is not driven; apt-get install chromium";
  ReportedStore store = made_store("a.sqlite", 2);
  Row& there = store.runs[1];
  there.key.device = "card";
  there.device_s.swap(there.cpu_s);
  const auto findings =
      findings_on(store_report({&store, 1}, "1.2.3").html, "store_report_legends.js", program);
  const std::map<std::string, std::string> expected{{"work_precision", "rk4"},
                                                    {"device_work_precision", "newmark on card"},
                                                    {"time_steps", "newmark on card, rk4"},
                                                    {"hidden", "0"},
                                                    {"errors", "none"}};
  EXPECT_EQ(findings, expected);
}

TEST(StoreReportInABrowser, HidesNoCurveOfAProblemWhoseRunsHaveNoTime) {
  const std::string program = browser();
  if (program.empty())
    GTEST_SKIP() << "chromium is not installed, so the page is not driven; apt-get install chromium";
  ReportedStore store{.name = "a.sqlite"};
  for (int method = 0; method < 20; ++method) {
    store.runs.push_back(made_run("method_" + std::to_string(method), 0.1));
    store.runs.back().explored = true;
  }
  store.runs.push_back(made_run("rk4", 0.1));
  store.runs.back().key.problem = "timed";
  auto findings = findings_on(store_report({&store, 1}, "1.2.3").html, "store_report_legends.js", program);
  EXPECT_EQ(findings["hidden"], "0");
  EXPECT_EQ(findings["errors"], "none");
}

}  // namespace
}  // namespace hmax
