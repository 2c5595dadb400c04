#include "plots/pages/store_report.hpp"

#include <regex>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/errors.hpp"
#include "core/own_files.hpp"
#include "plots/pages/answer_words.hpp"
#include "plots/pages/report_answers.hpp"
#include "plots/pages/report_data.hpp"
#include "tests/plots/pages/reported_stores.hpp"
#include "tests/plots/text_search.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

std::string page_of(const std::vector<ReportedStore>& stores) { return store_report(stores, "1.2.3").html; }

/// The data that the script of a page reads.
AnyJson data_in(const std::string& page) {
  const std::string opening = "<script type=\"application/json\" id=\"data\">";
  const std::size_t begin = page.find(opening) + opening.size();
  return AnyJson::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

/// What a cell shows, a text as itself.
AnyJson cell(const AnyJson& data, const AnyJson& table, std::size_t row, const std::string& key) {
  for (std::size_t i = 0; i < table.at("columns").size(); ++i) {
    const AnyJson& column = table.at("columns")[i];
    if (column.at("key") != key) continue;
    const AnyJson& value = table.at("rows")[row][i + 4];
    return column.at("form") == "text" || column.at("form") == "long"
               ? data.at("words")[value.get<std::size_t>()]
               : value;
  }
  return "no such column";
}

TEST(StoreReport, SaysInWordsWhatAdviceRecommends) {
  const std::string page = page_of({made_store("a.sqlite")});
  EXPECT_TRUE(contains(page, "Take symplectic_euler with h = 2\u00a0ms, 5 steps per frame."));
  EXPECT_TRUE(contains(page, "2.272\u00a0ms predicted, 2.28\u00a0ms observed"));
  EXPECT_TRUE(contains(page, "<td>error</td>\n<td>0.68\u00a0%</td>"));
  EXPECT_TRUE(contains(page, "0.0538\u00a0ms (median), 0.0827\u00a0ms (99 %), 0.123\u00a0ms (maximum)"));
  EXPECT_TRUE(contains(page, "rk4 at 2.5\u00a0ms (equally good)"));
  EXPECT_TRUE(contains(page, "<a href=\"#advice-1\">row 1 of a.sqlite</a>"));
}

TEST(StoreReport, SaysOfAnAnswerAllThatWasSaid) {
  ReportedStore store = made_store("a.sqlite");
  const AnswerWords words{.body = "E 5500 Pa, nu 0.45, 1060 kg/m^3; 1.5 kg",
                          .facts = {{"caution", "tried with 0.5 of the load only"},
                                    {"", "a second <caution>"},
                                    {"margin", "observed: stable at 2 times the loads"}}};
  EXPECT_EQ(answer_words_of(answer_text(words)), words);
  store.words = {{.key = store.advice.front().key, .words = answer_text(words), .session = 1}};
  const std::string page = report_answers({&store, 1});
  std::size_t last = 0;
  for (
      const char* place :
      {"Take symplectic_euler", "<td>model</td>\n<td>E 5500 Pa, nu 0.45, 1060 kg/m^3; 1.5 kg</td>",
       "<td>caution</td>\n<td>tried with 0.5 of the load only</td>\n</tr>\n<tr>\n<td></td>\n<td>a second &lt;caution&gt;</td>",
       "<td>margin</td>\n<td>observed: stable at 2 times the loads</td>", "row 1 of a.sqlite"}) {
    const std::size_t at = page.find(place, last);
    ASSERT_NE(at, std::string::npos) << place << "\n" << page;
    last = at;
  }
}

TEST(StoreReport, SaysWhatWouldHelpWhereNothingMeetsAQuestion) {
  ReportedStore store{.name = "a.sqlite", .advice = {made_advice("rk4", "too_slow", 1e-3)}};
  const AnswerWords words{.help = "What helps, each tried:",
                          .remedies = {"rate 50 in place of 100", "rho 4240 in place of 1060"}};
  store.words = {{.key = store.advice.front().key, .words = answer_text(words), .session = 1}};
  EXPECT_TRUE(contains(
      report_answers({&store, 1}),
      "<td>remedies</td>\n<td>What helps, each tried:</td>\n</tr>\n<tr>\n<td></td>\n<td>rate 50 in place of 100</td>"));
  store.words.front().words = "{";  // damaged: the rows are shown all the same
  EXPECT_TRUE(contains(report_answers({&store, 1}), "No method that was tried meets this."));
  EXPECT_THROW(answer_words_of("{}"), InputError);
}

TEST(StoreReport, SaysThatNothingMeetsAQuestion) {
  ReportedStore store{.name = "a.sqlite", .advice = {made_advice("rk4", "too_slow", 1e-3)}};
  EXPECT_TRUE(contains(report_answers({&store, 1}), "No method that was tried meets this."));
  store.advice = {made_advice("rk4", "recommended", 1e-3), made_advice("rk4", "recommended", 2e-3)};
  store.advice.back().key.rate = 50;
  const std::string two = report_answers({&store, 1});
  EXPECT_TRUE(contains(two, "at 100 Hz") && contains(two, "at 50 Hz") && contains(two, "row 2 of a.sqlite"));
}

TEST(StoreReport, HoldsEveryRowWithItsNumberInItsStore) {
  const AnyJson data = data_in(page_of({made_store("a.sqlite"), made_store("b.sqlite", 3)}));
  EXPECT_EQ(data.at("stores"), (AnyJson{"a.sqlite", "b.sqlite"}));
  ASSERT_EQ(data.at("tables").size(), 3U);
  const AnyJson& runs = data.at("tables")[1];
  EXPECT_EQ(runs.at("id"), "rows");
  ASSERT_EQ(runs.at("rows").size(), 11U);
  EXPECT_EQ(runs.at("rows")[10][0], 1);
  EXPECT_EQ(runs.at("rows")[10][1], 3);
  EXPECT_EQ(cell(data, runs, 0, "method"), "rk4");
  EXPECT_EQ(cell(data, runs, 0, "h"), 500);
  EXPECT_EQ(cell(data, runs, 0, "cpu"), 0.002);
  EXPECT_EQ(cell(data, runs, 0, "rtol"), nullptr) << "a fixed step has no tolerance";
  const AnyJson& series = data.at("series")[runs.at("rows")[10][2].get<std::size_t>()];
  EXPECT_EQ(series.at("label"), "explicit_euler (b)");
  EXPECT_EQ(row_anchor(runs_table, 0, 17, 1), "rows-17");
  EXPECT_EQ(row_anchor(runs_table, 1, 17, 2), "rows-2-17");
}

TEST(StoreReport, TellsUnboundedLimitsFromMissingNumbers) {
  const AnyJson data = data_in(page_of({made_store("a.sqlite")}));
  const AnyJson& limits = data.at("tables")[2];
  EXPECT_EQ(cell(data, limits, 1, "h_max"), "inf");
  EXPECT_EQ(cell(data, limits, 1, "observed"), nullptr);
  EXPECT_EQ(cell(data, limits, 0, "h_max"), 3.2);
}

TEST(StoreReport, TextOfStoresIsNeverMarkup) {
  const std::string evil = "</script><script>alert(1)</script><!-- & \"q\" \xff";
  ReportedStore store = made_store("<b>.sqlite");
  store.runs.front().status = store.runs.front().key.problem = evil;
  store.limits.front().note = evil;
  store.advice.front().method = store.advice.front().key.motion = evil;
  store.sessions.front().fingerprint.cpu = store.sessions.front().fingerprint.kernel = evil;
  const std::string page = page_of({store});
  EXPECT_FALSE(contains(page, "<script>alert"));
  EXPECT_FALSE(contains(page, "<b>"));
  EXPECT_FALSE(contains(page, "\xff"));
  const std::regex script("</script>");
  EXPECT_EQ(std::distance(std::sregex_iterator(page.begin(), page.end(), script), {}), 2);
  EXPECT_EQ(cell(data_in(page), data_in(page).at("tables")[1], 0, "status"),
            "</script><script>alert(1)</script><!-- & \"q\" \ufffd");
}

TEST(StoreReport, NeedsNoOtherFile) {
  const std::string page = page_of({made_store("a.sqlite")});
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_LT(page.find(own_mark), 2048U);
  EXPECT_FALSE(
      std::regex_search(page, std::regex("src=|https?://(?!www\\.w3\\.org/2000/svg)|@import|url\\(")));
  EXPECT_EQ(page, page_of({made_store("a.sqlite")}));
}

TEST(StoreReport, TellsMachineDateAndVersion) {
  const std::string page = page_of({made_store("a.sqlite")});
  EXPECT_TRUE(contains(page, "a.sqlite: session 1") && contains(page, "2026-01-02T03:04:05Z") &&
              contains(page, "a test; "));
  EXPECT_TRUE(contains(page, "Written by hmax 1.2.3."));
}

TEST(StoreReport, SessionsOfOneMachineAreToldOnce) {
  ReportedStore store = made_store("a.sqlite");
  for (int id = 2; id < 6; ++id)
    store.sessions.push_back(
        {id, fmt::format("2026-01-0{}T00:00:00Z", id), store.sessions.front().fingerprint});
  store.sessions.back().fingerprint.cpu = "another";
  const std::string page = page_of({store});
  EXPECT_TRUE(contains(page, "a.sqlite: sessions 1 to 4") && contains(page, "a.sqlite: session 5"));
}

TEST(StoreReport, HasNoPartsWithoutRows) {
  const ReportedStore store{.name = "a.sqlite", .limits = {made_limit("rk4", 1e-3, 1e-3)}};
  const std::string page = page_of({store});
  EXPECT_FALSE(contains(page, "id=\"advice-section\"") || contains(page, "id=\"rows-section\""));
  EXPECT_TRUE(contains(page, "id=\"limits-section\""));
  EXPECT_EQ(data_in(page).at("figures").size(), 2U);
}

TEST(StoreReport, SaysWhereTimesOfExploredRunsAre) {
  ReportedStore store{.name = "a.sqlite", .runs = {made_run("rk4", 0.1), made_run("rk4", 0.2)}};
  EXPECT_FALSE(contains(page_of({store}), "explored runs"));
  store.runs[0].explored = true;
  const std::string page = page_of({store});
  EXPECT_TRUE(contains(page, "CPU times of explored runs are rough and not shown; 1 of these was explored."));
  EXPECT_TRUE(contains(page, "2 runs in 1 store"));
  EXPECT_TRUE(contains(page, "id=\"figure-work_precision\""));
  store.runs[1].explored = true;
  EXPECT_FALSE(contains(page_of({store}), "figure-work_precision")) << "it would have no mark";
  EXPECT_EQ(data_in(page_of({store})).at("figures").size(), 1U);
}

TEST(StoreReport, ShowsTimesOfDevicesApart) {
  ReportedStore store{.name = "a.sqlite", .runs = {made_run("rk4", 0.1), made_run("rk4", 0.1)}};
  const auto ids = [&] {
    std::string text;
    const auto data = data_in(page_of({store}));
    for (const auto& figure : data.at("figures")) text += figure.at("id").get<std::string>() + " ";
    return text;
  };
  EXPECT_EQ(ids(), "work_precision time_steps ");
  Row& there = store.runs[1];
  there.key.device = "card";
  there.device_s.swap(there.cpu_s);
  EXPECT_EQ(ids(), "work_precision device_work_precision time_steps ");
  const std::string page = page_of({store});
  EXPECT_TRUE(contains(page, "id=\"figure-device_work_precision\""));
  EXPECT_FALSE(data_in(page).at("figures").back().contains("best")) << "it would hide the curves of devices";
  EXPECT_TRUE(contains(page, "1 of these runs is on a device"));
  const auto data = data_in(page);
  const auto& table = data.at("tables").at(0);
  const auto cell = [&](std::size_t row, const std::string& key) {
    constexpr std::size_t hidden_cells = 4;
    for (std::size_t c = 0; c < table.at("columns").size(); ++c)
      if (table.at("columns")[c].at("key") == key) return table.at("rows")[row].at(c + hidden_cells);
    throw std::runtime_error("no column " + key);
  };
  EXPECT_TRUE(cell(0, "cpu").is_number() && cell(0, "device_time").is_null());
  EXPECT_TRUE(cell(1, "cpu").is_null() && cell(1, "cpu_p99").is_null());
  EXPECT_EQ(cell(1, "device_time"), cell(0, "cpu"));
  EXPECT_EQ(cell(1, "device_p99"), cell(0, "cpu_p99"));
  EXPECT_EQ(cell(1, "speed"), cell(0, "speed"));
  EXPECT_EQ(data.at("series")[1].at("label"), "rk4 on card");
  store.runs.erase(store.runs.begin());
  EXPECT_EQ(ids(), "device_work_precision time_steps ");
  EXPECT_EQ(data_in(page_of({store})).at("figures").back().at("best"),
            AnyJson::array({"error", "device_time"}));
  EXPECT_FALSE(contains(page_of({store}), "id=\"figure-work_precision\""));
}

TEST(StoreReport, LeavesOutRowsThatWouldMakeItTooLarge) {
  const std::vector<ReportedStore> stores{made_store("a.sqlite", 3000)};
  const std::size_t whole = page_of(stores).size(), most = whole - 100'000;
  const StoreReport cut = store_report(stores, "1.2.3", most);
  EXPECT_LE(cut.html.size(), most);
  EXPECT_GT(cut.left_out, 100U);
  EXPECT_LT(cut.left_out, 2900U);
  EXPECT_TRUE(contains(cut.html, fmt::format("{} rows are left out", cut.left_out)));
  EXPECT_EQ(store_report(stores, "1.2.3").left_out, 0U);
}

TEST(ReportData, TheTimeStepOfARunThatDivergedIsItsOwn) {
  ReportedStore store{.name = "a.sqlite", .runs = {made_run("rk4", 0.5), made_run("rk4", 0.5)}};
  for (Row& row : store.runs) {
    row.outcome = "diverged";
    row.t_reached = 2;
    row.steps = 3;
  }
  store.runs.back().key.mode = "sampled";
  store.runs.back().t_reached = 3;
  const AnyJson data = AnyJson::parse(report_data({&store, 1}).json);
  EXPECT_EQ(cell(data, data.at("tables")[0], 0, "step"), 500);
  EXPECT_EQ(cell(data, data.at("tables")[0], 1, "step"), 1000);
}

TEST(ReportData, ModelsOfOneNameHaveFiguresOfTheirOwn) {
  ReportedStore store{.name = "a.sqlite", .runs = {made_run("rk4", 0.1), made_run("rk4", 0.1)}};
  store.runs.back().key.parameters = "m=2";
  EXPECT_EQ(AnyJson::parse(report_data({&store, 1}).json).at("cases"),
            (AnyJson{"liver_forced, to 10 s", "liver_forced, to 10 s (2)"}));
}

}  // namespace
}  // namespace hmax
