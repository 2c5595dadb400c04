/// The page about one answer: its words, the body, its rows.
#include <gtest/gtest.h>

#include "plots/pages/store_report.hpp"
#include "tests/plots/pages/browser.hpp"
#include "tests/plots/pages/made_scenes.hpp"
#include "tests/plots/pages/reported_stores.hpp"

namespace hmax {
namespace {

ReportedStore an_answer() {
  ReportedStore answer{
      .name = "this answer",
      .advice = {made_advice("rk4", "recommended", 0.01), made_advice("newmark", "tie", 0.02)},
      .sessions = made_store("a.sqlite", 1).sessions};
  BodyScene bar = made_bar(2);
  bar.modes.push_back({.words = "fastest mode", .frequency = 5, .shape = made_shape(bar.points, 1, 1)});
  answer.scenes.push_back({.key = answer.advice.front().key, .scene = scene_text(bar), .session = 1});
  return answer;
}

AnswerSections words() {
  return {.title = "liver <1>",
          .introduction = "Which & how?",
          .before = "## Answer\n\n**take rk4**\n",
          .after = "## Model\n\n| | |\n| --- | --- |\n| model | a liver |\n",
          .table = "| method | h [ms] |\n| --- | ---: |\n| rk4 | 10 |\n"};
}

TEST(AnswerReport, HasWordsBodyRowsAndMachineInThisOrder) {
  const std::string page = answer_report(an_answer(), words(), "1.2.3").html;
  EXPECT_NE(page.find("<title>liver &lt;1&gt;</title>"), std::string::npos);
  std::size_t last = 0;
  for (const char* place :
       {"Which &amp; how?", "<h2 id=\"answer\">Answer</h2>", "<strong>take rk4</strong>",
        "<h2 id=\"bodies\">The body</h2>", "id=\"body-1\"", "<h2 id=\"advice-section\">All methods</h2>",
        "<td align=\"right\">10</td>", "<h2 id=\"model\">Model</h2>", "<h2 id=\"machines\">Machine</h2>",
        "id=\"data\""}) {
    const std::size_t at = page.find(place, last);
    ASSERT_NE(at, std::string::npos) << place;
    last = at;
  }
  EXPECT_EQ(page.find("Take rk4"), std::string::npos) << "the words of the answer stand once";
}

TEST(AnswerReport, OfAProblemWithoutABodyHasNone) {
  ReportedStore answer = an_answer();
  answer.scenes.clear();
  const std::string page = answer_report(answer, words(), "1.2.3").html;
  EXPECT_EQ(page.find("id=\"bodies\""), std::string::npos);
  EXPECT_EQ(page.find("make_scene"), std::string::npos) << "nor the script of bodies";
}

TEST(StoreReport, ShowsEachBodyOnceAndSaysWhichCannotBeRead) {
  ReportedStore store = an_answer();
  store.scenes.push_back(store.scenes.front());
  store.scenes.push_back({.key = store.advice.front().key, .scene = "{}", .session = 1});
  const std::string page = store_report({&store, 1}, "1.2.3").html;
  EXPECT_NE(page.find("<h2 id=\"bodies\">Bodies</h2>"), std::string::npos);
  EXPECT_EQ(page.find("<figure class=\"scene\""), page.rfind("<figure class=\"scene\""));
  EXPECT_NE(page.find("liver_forced: not shown. "), std::string::npos);
}

TEST(AnswerReportInABrowser, ShowsFiguresAndTheBodyWithoutErrors) {
  if (browser().empty())
    GTEST_SKIP() << "chromium is not installed, so the page is not driven; apt-get install chromium";
  const auto findings =
      findings_on(answer_report(an_answer(), words(), "1.2.3").html, "answer_report_actions.js", browser());
  const std::map<std::string, std::string> expected{{"figures", "4"},
                                                    {"rows", "2"},
                                                    {"body", "1"},
                                                    {"mark leads to its row", "advice-1"},
                                                    {"errors", "none"}};
  EXPECT_EQ(findings, expected);
}

}  // namespace
}  // namespace hmax
