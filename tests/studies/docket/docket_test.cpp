#include "studies/docket/docket.hpp"

#include <algorithm>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

std::string text_of_report(std::string_view name) { return std::string(text_of(docket_texts(), name)); }

/// The text with the first `from` replaced.
std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

DocketReport judged(const std::string& text) { return docket_report(parse_toml(text, "my.toml")); }

std::string refusal(const std::string& text) {
  return error_of<InputError>([&] { judged(text); });
}

/// A report that is right: a mode of 10 rad/s, whose steps of symplectic Euler grow above 0.2 s.
const std::string swing = R"([report]
title = "a"
link = "https://example.org/1"
program = "b"
version = "c"
posted = "d"
asked = "e"
happened = "f"
control = false
[equations]
x = "v"
v = "-w^2*x"
[parameters]
w = 10
[initial]
x = 1
v = 0
[[case]]
name = "swing"
method = "symplectic_euler"
h = 0.21
cause = "step"
)";

/// Readers know the assumed numbers that are varied by the names that the page gives them.
TEST(Docket, SaysWhatItsVariedNumbersAre) {
  for (const auto& [name, text] : docket_texts()) {
    const auto report = parse_toml(std::string(text), std::string(name)).root.at("report");
    const std::string words = report.at("posted").get<std::string>() + report.value("assumed", report).dump();
    for (const std::string& varied : report.value("vary", std::vector<std::string>{}))
      EXPECT_TRUE(std::regex_search(words, std::regex("\\b" + varied + "\\b"))) << name << ": " << varied;
  }
}

TEST(Docket, IsJudgedAsItsThreadsEnd) {
  std::ptrdiff_t right = 0, controls = 0, firm = 0;
  std::set<std::string> links, titles;
  for (const EmbeddedText& text : docket_texts()) {
    const DocketReport report = docket_report(parse_toml(text.text, std::string(text.name) + ".toml"));
    EXPECT_EQ(report.name, text.name);
    EXPECT_TRUE(report.link.starts_with("https://")) << report.name;
    EXPECT_TRUE(links.insert(report.link).second) << report.name << ": its thread has a report already";
    EXPECT_TRUE(titles.insert(report.title).second) << report.name;
    EXPECT_FALSE(report.discussed.empty()) << report.name;
    const bool of_step = std::ranges::any_of(report.rows, [](const DocketRow& row) {
      return row.cause == "step" || row.cause == "work" || row.cause == "accuracy" || row.cause == "material";
    });
    EXPECT_NE(report.control, of_step) << report.name;
    right += report.right ? 1 : 0;
    controls += report.control ? 1 : 0;
    firm += report.right && report.decisive.empty() ? 1 : 0;
  }
  const auto count = std::ssize(docket_texts());
  EXPECT_GE(count, 24);
  EXPECT_GE(3 * controls, count);
  EXPECT_GE(10 * right, 9 * count);
  EXPECT_GE(3 * firm, 2 * count);
}

TEST(Docket, FindsTheNumbersOfThreads) {
  // The thread has 1531 steps, and an explicit step of 3.3 / 100 for 50 s makes 1512.
  const DocketReport odeint = judged(text_of_report("odeint-189"));
  EXPECT_NEAR(std::stod(odeint.rows.at(1).found), 1531, 15);
  // 0.25 dx^2 / diffusivity, which the change refuses to exceed, and 4 / omega.
  EXPECT_EQ(judged(text_of_report("xarray-1281")).rows.at(0).found, "largest stable step 0.25 s");
  EXPECT_TRUE(
      judged(text_of_report("fenics-14378")).rows.at(0).found.starts_with("largest stable step 0.00365 s"));
  EXPECT_EQ(judged(text_of_report("fenics-14378")).rows.at(0).remedy,
            "at most 0.00365 s, or 2 substeps; newmark: no step is unstable");
}

TEST(Docket, NoticesAWrongFact) {
  struct Fact {
    const char *name, *from, *to, *verdict;
  };
  for (const Fact& fact : {Fact{"taichi-8345", "h = 2.8e-4", "h = 2.7e-4", "none"},
                           Fact{"genesis-903", "E = 3.45e9", "E = 3.45e5", "none"},
                           Fact{"odejl-81", "c = -120", "c = 12", "none"},
                           Fact{"newton-2933", "iterations=1,reset=1", "iterations=100", "none"},
                           Fact{"scipy-11274", "t_end = 1e5", "t_end = 10", "none"},
                           Fact{"diffeqbase-188", "h = 1e-4", "h = 1e-3", "step"},
                           Fact{"cannon-356", "h = 0.016666666666666666", "h = 10", "accuracy"},
                           Fact{"ordinarydiffeq-4155", "\"u^2\"", "\"-u^2\"", "none"},
                           Fact{"newton-3699", "z = 0.1", "z = 0.3", "none"}}) {
    const std::string text = text_of_report(fact.name);
    EXPECT_TRUE(judged(text).right) << fact.name;
    const DocketReport planted = judged(with(text, fact.from, fact.to));
    EXPECT_FALSE(planted.right) << fact.name;
    EXPECT_EQ(planted.rows.front().verdict, fact.verdict) << fact.name;
  }
}

TEST(Docket, TakesNoRemedyThatIsNone) {
  EXPECT_TRUE(judged(swing).right);
  EXPECT_TRUE(judged(swing + "remedy = {h = 0.19}\n").right);
  EXPECT_FALSE(judged(swing + "remedy = {h = 0.201}\n").right);
  const DocketRow other = judged(swing + "remedy = {method = \"rk4\", set = {w = 9}}\n").rows.front();
  EXPECT_TRUE(other.remedy.starts_with("at most 0.2 s, or 2 substeps; rk4, w=9: largest stable step 0.31"))
      << other.remedy;
  // A control whose step is to blame is not right.
  EXPECT_FALSE(judged(with(swing, "\"step\"", "\"other\"")).right);
  EXPECT_TRUE(judged(with(with(swing, "\"step\"", "\"other\""), "0.21", "0.19")).right);
}

TEST(Docket, TellsAssumedNumbersThatDecide) {
  const auto decisive = [](const std::string& text) { return judged(text).decisive; };
  EXPECT_TRUE(decisive(swing).empty());
  // The limit is 2 / w: half of w makes the step stable. Twice a step of 0.21 s is one that grows, too.
  const std::string varied = with(swing, "control", "vary = [\"w\", \"h\"]\ncontrol");
  EXPECT_EQ(decisive(varied), (std::vector<std::string>{"w", "h"}));
  EXPECT_TRUE(decisive(with(varied, "0.21", "0.41")).empty());
  EXPECT_EQ(decisive(with(with(varied, "0.21", "0.15"), "\"step\"", "\"none\"")),
            (std::vector<std::string>{"w", "h"}));
  // Also numbers in the id of a method or of a model.
  EXPECT_EQ(decisive(with(with(varied, "[\"w\", \"h\"]", "[\"gamma\"]"), "symplectic_euler",
                          "newmark:beta=0.25,gamma=0.5")),
            std::vector<std::string>{"gamma"});
  EXPECT_TRUE(
      says(refusal(with(varied, "\"w\"", "\"k\"")), "my.toml:9: no number of the report is called 'k'"));
  EXPECT_TRUE(
      says(refusal(with(varied, "\"w\"", "3")), "my.toml:9: 'vary' must be a list of texts in quotes"));
}

TEST(Docket, TellsAModelThatGrowsFromLooseTolerances) {
  // Of Robertson's reactions a loose run leaves the amounts that are above 0, and then grows.
  const std::string loose = with(text_of_report("scipy-11274"), "atol = 1e-6", "atol = 2e-6");
  EXPECT_EQ(judged(loose).rows.front().verdict, "accuracy");
  EXPECT_EQ(judged(text_of_report("diffeq-921")).rows.front().verdict, "model");
}

TEST(Docket, JudgesStepsOfAMotion) {
  // Far out a spring that stiffens is faster than at rest, and an implicit method has no limit that runs are
  // short of.
  const std::string stiff =
      with(with(swing, "-w^2*x", "-w^2*(x + 30*x^3)"), "[[case]]", "[problem]\nt_end = 1\n[[case]]");
  EXPECT_EQ(judged(with(stiff, "0.21", "0.1")).rows.front().verdict, "step");
  EXPECT_EQ(judged(with(swing, "0.21", "0.1")).rows.front().verdict, "none");
  EXPECT_EQ(judged(with(stiff, "symplectic_euler", "implicit_euler")).rows.front().verdict, "none");
}

TEST(Docket, RefusesAMalformedReportInOneSentence) {
  EXPECT_EQ(refusal("[[case]]\n"), "my.toml: there is no [report]");
  EXPECT_EQ(refusal(swing.substr(0, swing.find("[[case]]"))),
            "my.toml: there is no run to judge; write [[case]]");
  struct Wrong {
    const char *from, *to, *says;
  };
  for (const Wrong& wrong :
       {Wrong{"title = \"a\"\n", "", "my.toml:1: 'title' must be a text in quotes"},
        Wrong{"asked = \"e\"", "asked = 3", "my.toml:7: 'asked' must be a text in quotes"},
        Wrong{"control = false\n", "", "my.toml:1: 'control' must be true or false"},
        Wrong{"program", "programme",
              "my.toml:4: unknown key 'programme' in [report]; did you mean 'program'?"},
        Wrong{"\"step\"", "\"stop\"", "my.toml:22: 'stop' is no cause; did you mean 'step'?"},
        Wrong{"h = 0.21", "h = -1", "my.toml:21: 'h' must be above 0"},
        Wrong{"h = 0.21\n", "", "my.toml:18: 'h' must be a finite number"},
        Wrong{"h = 0.21", "h = \"0.21\"", "my.toml:21: 'h' must be a finite number"},
        Wrong{"h = 0.21", "hh = 0.21", "my.toml:21: unknown key 'hh' in [case.0]; known are name"},
        Wrong{"symplectic_euler", "all", "my.toml:20: 'all' is not one method that steps"},
        Wrong{"symplectic_euler\"\nh = 0.21", "bdf_5\"\nrtol = 1e-3\natol = 1e-3",
              "my.toml:20: 'bdf_5' is not one method that steps"},
        Wrong{"symplectic_euler\"\nh = 0.21", "vbd\"\nrate = 60", "my.toml:19: "},
        Wrong{"symplectic", "symplektic", "my.toml:19: "},
        Wrong{"cause", "set = {k = 1}\ncause", "my.toml:19: "},
        Wrong{"cause", "set = {w = \"1\"}\ncause", "my.toml:22: 'set' must hold finite numbers"},
        Wrong{"cause", "y0 = 3\ncause", "my.toml:22: 'y0' must be a table or a list of numbers"},
        Wrong{"cause", "remedy = 3\ncause", "'remedy' must be a table, like remedy = {h = 0.001}"},
        Wrong{"cause", "remedy = {hh = 3}\ncause", "unknown key 'hh'"},
        Wrong{"w^2*x", "w^2*", "my.toml"},
        Wrong{"w = 10", "w = nan", "my.toml:14: "},
        Wrong{"control", "assumed = [3]\ncontrol", "my.toml:9: 'assumed' must be a list of texts in quotes"},
        Wrong{"control", "model = \"nothing\"\ncontrol", "my.toml:20: unknown problem 'nothing'"}}) {
    const std::string said = refusal(with(swing, wrong.from, wrong.to));
    EXPECT_NE(said.find(wrong.says), std::string::npos) << wrong.to << ": " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace hmax
