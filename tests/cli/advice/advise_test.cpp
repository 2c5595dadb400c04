#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "tests/cli/html_links.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

constexpr const char* small_question =
    "advise --mesh cube:n=2 --model fem_green --load press --rate 100 --frames 50 --methods rk4,newmark";

TEST(AdviseCommand, AnswersInTheKeysOfTheContract) {
  const Shell shell;
  const Told told = shell.hmax(std::string(small_question) + " --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.err, "");
  const AnyJson document = told.json();
  for (const char* key : {"model", "rate", "tolerance", "budget_ms", "machine", "rows", "recommended", "ties",
                          "remedies", "long_runs", "proof", "uncertainty"})
    EXPECT_TRUE(document.contains(key)) << key;
  EXPECT_EQ(document.at("long_runs"), document.at("proof"));  // its old name
  ASSERT_EQ(document.at("rows").size(), 2U);
  for (const char* key : {"method",          "options",         "h",
                          "steps_per_frame", "h_max",           "h_max_observed",
                          "h_accurate",      "bound",           "error",
                          "error_of",        "frame_ms",        "missed",
                          "frames",          "realtime_factor", "memory_bytes",
                          "damping_added",   "stiffness_shown", "stiffness_ceiling",
                          "margin",          "verdict",         "status"})
    EXPECT_TRUE(document.at("rows")[0].contains(key)) << key;
  EXPECT_EQ(document.at("recommended"), document.at("rows")[0]);
  EXPECT_EQ(document.at("recommended").at("verdict"), "recommended");
  EXPECT_EQ(document.at("budget_ms"), 10.0);
  for (const char* key : {"stiffening", "load", "load_fails", "displacement", "load_limited_by"})
    EXPECT_TRUE(document.at("recommended").at("margin").contains(key)) << key;
}

TEST(AdviseCommand, SaysWhatToTakeAndWhy) {
  const std::string told = Shell().text(small_question);
  EXPECT_TRUE(says(told, "take "));
  EXPECT_TRUE(says(told, "limited by "));
  EXPECT_TRUE(says(told, " frames took more than 10 ms"));
}

TEST(AdviseCommand, WarnsWhereItTriedLessThanTheLoad) {
  const Shell shell;
  const std::string all = std::string(small_question), much = all + " --set force=50";
  EXPECT_FALSE(says(shell.hmax(all).out, "the load only"));
  const std::string told = shell.text(much);
  EXPECT_TRUE(says(told, "of the load only: under all of it the step may fail"));
  const AnyJson document = shell.json(much);
  EXPECT_LT(document.at("load_share"), 1);
  EXPECT_EQ(document.at("gravity_share"), 1);
}

TEST(AdviseCommand, TellsWhatIsFinishedWhenItIsInterrupted) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer is too slow for times of a test";
#endif
  // A million frames of Newton's method are not timed within the four seconds after which `timeout`
  // interrupts.
  const Told told = Shell().line(
      "timeout --foreground -s INT 4 '" HMAX_PROGRAM
      "' advise --mesh cube:n=2 --load press --rate 100 --methods newmark --frames 1000000 --json");
  EXPECT_EQ(told.exit_code, 124) << "`timeout` had to interrupt";
  const AnyJson document = told.json();
  EXPECT_EQ(document.at("interrupted"), true);
  EXPECT_EQ(document.at("stage"), "timing");
  EXPECT_EQ(document.at("recommended").at("method"), "newmark");
  ASSERT_EQ(document.at("rows").size(), 1U);
  EXPECT_EQ(document.at("rows")[0].at("verdict"), "recommended");
}

/// timeout(1) signals the process and its group: two signals at once are one wish.
TEST(AdviseCommand, StoresWhatIsFinishedWhenItIsInterruptedTwiceAtOnce) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer is too slow for times of a test";
#endif
  const Shell shell;
  const std::string question =
      " advise --mesh cube:n=2 --load press --rate 100 --methods newmark --out kept.sqlite ";
  const std::string interrupted = "timeout -s INT 4 '" HMAX_PROGRAM "'" + question + "--frames 1000000 ";
  const Told told = shell.line(interrupted + "--output page.html");
  EXPECT_EQ(told.exit_code, 124) << "`timeout` had to interrupt";
  EXPECT_TRUE(says(told.out, "interrupted: the best rows are not all timed"));
  EXPECT_TRUE(says(told.out, "newmark"));
  EXPECT_TRUE(says(told.out, "Stored in kept.sqlite"));
  EXPECT_EQ(told.err, "hmax: note: interrupted; the rows so far are printed\n");
  EXPECT_TRUE(says(read_text(shell / "page.html"), "interrupted: the best rows are not all timed"));
  const auto stored = [&] { return shell.json("export kept.sqlite --of advice --format jsonl"); };
  ASSERT_EQ(stored().size(), 1U);
  EXPECT_EQ(stored()[0].at("stage"), "timing");
  EXPECT_EQ(stored()[0].at("verdict"), "recommended");
  ASSERT_EQ(shell.hmax("report kept.sqlite --output report.html").exit_code, 0);
  EXPECT_TRUE(says(read_text(shell / "report.html"), "the best that was known when the search ended early"));
  // A whole answer takes its place, and stays where a later search is interrupted.
  ASSERT_EQ(shell.hmax(question + "--frames 20").exit_code, 0);
  ASSERT_EQ(stored().size(), 1U);
  EXPECT_EQ(stored()[0].at("stage"), "done");
  const Told again = shell.line(interrupted + "--json");
  EXPECT_EQ(again.exit_code, 124);
  EXPECT_EQ(again.json().at("stage"), "timing");
  EXPECT_TRUE(says(again.err, "kept.sqlite keeps the whole answer that it has to this question"));
  EXPECT_EQ(stored()[0].at("stage"), "done");
}

TEST(AdviseCommand, SaysWhereNothingIsFinishedWhenItIsInterrupted) {
  const Shell shell;
  // The motion of a body of 10,000 points and its reference take longer than that.
  const std::string line = "timeout -s INT 2 '" HMAX_PROGRAM
                           "' advise --mesh ball:n=14 --rate 100 --methods newmark --out kept.sqlite ";
  const Told told = shell.line(line);
  EXPECT_EQ(told.exit_code, 124) << "`timeout` had to interrupt";
  EXPECT_TRUE(says(told.out, "Predicted, not run: newmark with h = 10 ms, 1 step per frame"));
  EXPECT_TRUE(says(told.err, "hmax: note: interrupted; no method was finished\n"));
  const Told json = shell.line(line + "--json");
  EXPECT_EQ(json.json().at("interrupted"), true);
  ASSERT_EQ(json.json().at("rows").size(), 1U);
  EXPECT_EQ(json.json().at("rows")[0].at("verdict"), "predicted");
  EXPECT_TRUE(json.json().at("recommended").is_null());
  EXPECT_TRUE(says(json.err, "hmax: note: interrupted; no method was finished\n"));
  EXPECT_FALSE(std::filesystem::exists(shell / "kept.sqlite"));
}

TEST(AdviseCommand, PrintsNoPredictionBesideAnError) {
  const Shell shell;
  expect_refused(shell.hmax("advise --problem liver_forced --rate 0.01 --methods rk4"),
                 "before 5 frames of 0.01 Hz");
}

TEST(AdviseCommand, AnswersWithinATime) {
  const Shell shell;
  const std::string question =
      "advise --mesh ball:n=10 --rate 100 --methods symplectic_euler,newmark --within ";
  const Told told = shell.hmax(question + "0.01 --json --out kept.sqlite");
  EXPECT_EQ(told.exit_code, 1) << told.err;
  const AnyJson document = told.json();
  EXPECT_EQ(document.at("out_of_time"), true);
  EXPECT_EQ(document.at("within"), 0.01);
  EXPECT_TRUE(document.at("recommended").is_null());
  EXPECT_FALSE(std::filesystem::exists(shell / "kept.sqlite"));
  // What is not asked for the time, such as one factor of this body, takes seconds on a busy machine.
  const AnyJson longer = shell.hmax(question + "4 --json").json();
  EXPECT_LT(longer.at("seconds"), 20);
  for (const AnyJson& row : longer.at("rows")) EXPECT_FALSE(row.at("h").is_null());
  for (const char* wrong : {"0", "-1", "nan", "inf"})
    expect_refused(shell.hmax(question + wrong), "--within");
  expect_refused(shell.hmax(question + "soon"), "--within");
}

TEST(AdviseCommand, SaysFirstWhatIsPredicted) {
  // Some of these methods are run within the two seconds after which the first answer is shown.
  const std::string told = Shell().hmax("advise --mesh cube:n=3 --rate 100 --frames 20 --within 5").out;
  const std::size_t end = told.find("The answer of runs follows");
  if (end == std::string::npos) GTEST_SKIP() << "the whole answer takes less";
  EXPECT_TRUE(says(told.substr(0, end), "predicted\n"));
  EXPECT_FALSE(says(told.substr(0, end), "suitable\n"));
}

TEST(AdviseCommand, RecommendsAStepForABallThatBounces) {
  const Shell shell;
  write_text(shell / "ball.toml",
             "[problem]\nt_end = 2\n[equations]\nx = \"v\"\nv = \"-9.81 + (x < 0 ? (-k*x - c*v)/m : 0)\"\n"
             "[parameters]\nk = 1e6\nc = 10\nm = 1\n[initial]\nx = 1\nv = 0\n");
  const std::string told =
      shell.text("advise --problem ball.toml --rate 100 --methods rk4,ode45 --frames 50");
  EXPECT_FALSE(says(told, "unstable"));
  // Which of the two takes less time is the machine's.
  const Told alone = shell.hmax("advise --problem ball.toml --rate 100 --methods rk4 --frames 50");
  EXPECT_TRUE(says(alone.out, "take rk4 with h = 0.35714 ms"));
  // The right end: at rest, pressed into the floor by m g / k.
  const AnyJson end = shell.json("run --problem ball.toml --method rk4 --h 0.000357142857142857 --t-end 60");
  EXPECT_NEAR(end.at("y")[0].get<double>(), -9.81e-6, 1e-8);
}

TEST(AdviseCommand, SaysWhatABodyIsAndWhereItsLoadsInvertIt) {
  const Shell shell;
  const std::string told = shell.text(
      "advise --mesh cube:n=2 --load press --set force=2 --rate 100 --frames 20 --methods symplectic_euler --out kept.sqlite "
      "--output page.html");
  EXPECT_TRUE(says(told, "\nE 5500 Pa, nu 0.45, 1060 kg/m^3; 1.06 kg in a box"));
  EXPECT_TRUE(says(told, " mm from the start of the motion)"));
  EXPECT_TRUE(says(told, " is inverted at t = "));
  EXPECT_FALSE(says(told, "-0,"));
  ASSERT_EQ(shell.hmax("report kept.sqlite --output report.html").exit_code, 0);
  // The card says all that the answer says.
  for (const char* page : {"page.html", "report.html"}) {
    const std::string text = read_text(shell / page);
    for (const char* words :
         {"E 5500 Pa, nu 0.45", "is inverted at t = ", "observed: stable at ", "predicted: stable up to "})
      EXPECT_TRUE(says(text, words)) << page;
  }
}

TEST(AdviseCommand, FailsWhereNothingSuits) {
  const Told told = Shell().hmax(std::string(small_question) + " --budget 1e-6");
  EXPECT_EQ(told.exit_code, 1) << told.err;
  EXPECT_TRUE(says(told.out, "no method that was tried meets this"));
}

TEST(AdviseCommand, KeepsTheAdviceInAStore) {
  const Shell shell;
  const AnyJson told = shell.json(std::string(small_question) + " --out kept.sqlite");
  const Told rows = shell.hmax("export kept.sqlite --of advice --json");
  ASSERT_EQ(rows.exit_code, 0) << rows.err;
  const AnyJson kept = rows.json(), told_rows = told.at("rows");
  ASSERT_EQ(kept.size(), told_rows.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    EXPECT_EQ(kept[i].at("method"), told_rows[i].at("method"));
    EXPECT_EQ(kept[i].at("h"), told_rows[i].at("h"));
    EXPECT_EQ(kept[i].at("verdict"), told_rows[i].at("verdict"));
  }
  const Told none = shell.hmax("export kept.sqlite --of limits");
  EXPECT_TRUE(says(none.err, "holds no limits; --of advice writes what it has"));
}

constexpr const char* page_question =
    "advise --problem liver_forced --rate 100 --frames 20 --methods rk4,newmark --output page.html";

/// Words with one space between them.
std::string spaced(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

/// What a reader of a page sees.
std::string seen(const std::string& page) {
  std::string text;
  bool inside = false;  // of a tag
  for (const char c : page.substr(page.find("<body>"))) {
    inside = inside || c == '<';
    text += inside ? ' ' : c;
    inside = inside && c != '>';
  }
  for (const auto& [entity, character] :
       {std::pair("&lt;", "<"), {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}})
    for (std::size_t at; (at = text.find(entity)) != std::string::npos;)
      text.replace(at, std::string_view(entity).size(), character);
  return spaced(text);
}

/// The number of places where a text has a part.
std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(AdvisePage, HoldsTheWholeAnswer) {
  const Shell shell;
  const std::string told = shell.text(page_question);
  const std::string page = read_text(shell / "page.html"), text = seen(page);
  EXPECT_TRUE(says(page, "<title>liver_forced at 100 Hz: integrator and step size</title>"));
  EXPECT_TRUE(says(text, "its own motion; to t = 100 s"));
  const std::size_t end = told.find("\nOpen page.html\n");
  ASSERT_NE(end, std::string::npos) << told;
  std::istringstream lines(told.substr(0, end));
  std::string line;
  std::getline(lines, line);  // model and motion, which stand apart on the page
  std::size_t compared = 0;
  for (; std::getline(lines, line); ++compared) EXPECT_TRUE(says(text, spaced(line)));
  EXPECT_GE(compared, 12U);
  EXPECT_TRUE(says(text, " c=")) << "the parameters";
}

TEST(AdvisePage, NeedsNothingElse) {
  const Shell shell;
  ASSERT_EQ(shell.hmax(page_question).exit_code, 0);
  const std::string page = read_text(shell / "page.html");
  EXPECT_EQ(page.find("<!DOCTYPE html>"), 0U);
  // A name of a language, not an address.
  EXPECT_EQ(count_of(page, "://"), count_of(page, "\"http://www.w3.org/2000/svg\""));
  EXPECT_EQ(count_of(page, "src=\""), 0U);
  EXPECT_EQ(count_of(page, "href=\""), count_of(page, "href=\"#") + count_of(page, "href=\"data:,\""));
  for (const char* figure : {"advice_error", "frame_times", "frame_tail", "steps_and_limits"})
    EXPECT_EQ(count_of(page, fmt::format("<div id=\"figure-{}\">", figure)), 1U) << figure;
  EXPECT_EQ(count_of(page, "class=\"scene\""), 0U);
  for (const char* element : {"table", "tr", "td", "th", "h2", "section", "ul", "li"})
    EXPECT_EQ(count_of(page, fmt::format("<{}>", element)) + count_of(page, fmt::format("<{} ", element)),
              count_of(page, fmt::format("</{}>", element)))
        << element;
}

TEST(AdvisePage, ShowsTheBodyAndKeepsItInTheStore) {
  const Shell shell;
  const Told told = shell.hmax(
      "advise --mesh cube:n=2 --load press --rate 100 --frames 20 --methods symplectic_euler --out kept.sqlite --output page.html");
  ASSERT_NE(told.exit_code, 2) << told.err;
  const auto expect_body = [](const std::string& page) {
    EXPECT_EQ(count_of(page, "<figure class=\"scene\" id=\"body-1\""), 1U);
    EXPECT_EQ(count_of(page, "fastest mode at rest, which limits explicit steps"), 1U);
    EXPECT_EQ(count_of(page, "slowest mode at the start of the motion"), 1U);
    EXPECT_EQ(count_of(page, "% of its energy"), 1U);
  };
  expect_body(read_text(shell / "page.html"));
  ASSERT_EQ(shell.hmax("report kept.sqlite --output report.html").exit_code, 0);
  expect_body(read_text(shell / "report.html"));
}

TEST(AdvisePage, ShowsTextOfFilesAsItIs) {
  const Shell shell;
  write_text(shell / "own.toml",
             "[problem]\nname = \"a<b>&c\"\nt_end = 5\n[equations]\nx = \"v\"\nv = \"-x\"\n"
             "[initial]\nx = 1\nv = 0\n");
  shell.text("advise --problem own.toml --rate 100 --frames 20 --methods rk2_heun,rk4 --output own.html");
  const std::string page = read_text(shell / "own.html");
  EXPECT_FALSE(says(page, "a<b>"));
  EXPECT_TRUE(says(page, "<title>a&lt;b&gt;&amp;c at 100 Hz"));
}

/// Of the methods that SOFA steps this body with, damping by stiffness leaves the implicit ones.
TEST(Advise, SaysWhatItDoesNotDoOnAGpu) {
  const Shell shell;
  const std::string ask = "advise --mesh cube:n=2 --load press --rate 100 --device ";
  expect_refused(shell.hmax(ask + "tpu"), "--device");
  expect_refused(shell.hmax(ask + "gpu --out advice"), "--device gpu does not take --out");
  expect_refused(shell.hmax(ask + "gpu --output advice.html"), "--device gpu does not take --output");
  expect_refused(shell.hmax(ask + "gpu --methods newmark"),
                 "runs none of these methods: newmark runs on no GPU");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 100 --device gpu"),
                 "bodies on meshes alone");
  EXPECT_TRUE(shell.json(ask + "cpu --methods rk4 --frames 5").at("device").is_null());
}

TEST(AdviseScene, WritesWhatItRecommendsAsASceneOfSofa) {
  const Shell shell;
  const std::string ask =
      "advise --mesh cube:n=1 --model fem_corotational --load press --rate 100 --frames 5 ";
  const auto advice = shell.json(ask + "--output cube.scn");
  for (const auto& row : advice["rows"]) EXPECT_NE(row["method"], "hht_alpha");
  const auto judged = shell.json("stability predict --scene cube.scn --unit m,kg,s");
  EXPECT_EQ(judged["scene"]["method"].get<std::string>().substr(0, 7),
            advice["recommended"]["method"].get<std::string>().substr(0, 7));
  EXPECT_EQ(judged["scene"]["h"], advice["recommended"]["h"]);
  EXPECT_EQ(judged["scene"]["within"], true);
  const auto damped = shell.json(ask + "--set beta=1e-3 --output damped.scn");
  for (const auto& row : damped["rows"]) EXPECT_NE(row["method"], "rk4");
  expect_refused(shell.hmax(ask + "--set beta=1e-3 --methods rk4 --output damped.scn --force"), "set beta=0");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 100 --output a.scn"),
                 "is a scene of a body for SOFA");
}

TEST(AdvisePage, SaysWhatWouldHelpWhereNothingSuits) {
  const Shell shell;
  const Told told = shell.hmax(std::string(small_question) + " --budget 1e-6 --output page.html");
  EXPECT_EQ(told.exit_code, 1) << told.err;
  const std::string text = seen(read_text(shell / "page.html"));
  for (const char* words : {"no method that was tried meets this Nearest: ",
                            " of 1e-06 ms per frame, measured on single steps. What helps, each tried: ",
                            " budget_ms ", "Methods that do not suit"})
    EXPECT_TRUE(says(text, words)) << told.out;
}

TEST(AdvisePage, IsRefusedBeforeTheSearch) {
  // What is found is printed before the page is written: nothing was searched where nothing is printed.
  const Shell shell;
  const std::string ask = "advise --problem liver_forced --rate 100 --frames 20 --methods rk4 --output ";
  for (const char* name : {"page.md", "page", "page.htm", ".html"})
    expect_refused(shell.hmax(ask + name), "let its name end in .html, such as advice.html");
  expect_refused(shell.hmax(ask + "/dev/null/folder/page.html"), "Cannot write '/dev/null/folder/page.html'");
  write_text(shell / "mine.html", "<p>mine</p>");
  expect_refused(shell.hmax(ask + "mine.html"), "--force");
  EXPECT_EQ(read_text(shell / "mine.html"), "<p>mine</p>");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 100 --out a/b"), "--out is 'a/b'");
}

TEST(AdvisePage, ThatCannotBeWrittenLosesNoAnswer) {
  const Shell shell;
  const Told told = shell.line(std::string("ln -s /dev/full page.html && hmax ") + page_question);
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_TRUE(says(told.out, "take "));
  EXPECT_TRUE(says(told.err, "Cannot write 'page.html'"));
}

TEST(AdviseCommand, RefusesWrongInput) {
  const Shell shell;
  expect_refused(shell.hmax("advise --problem liver_forced"), "add --rate");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 0"), "--rate is 0");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 1e9"), "between 0.0001 and 100000");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 100 --tolerance 2"), "below 1");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 100 --budget -1"), "--budget is -1");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 1000 --budget 5"), "a frame has 1 ms");
  expect_refused(shell.hmax("advise --problem liver_forced --rate 100 --methods adams_pece"), "--methods");
  expect_refused(shell.hmax("advise --mesh cube:n=2 --rate 100 --motion-at surface:1"), "--motion");
  expect_refused(shell.hmax("advise --mesh cube:n=2 --rate 100 --motion none.csv"), "none.csv");
}

}  // namespace
}  // namespace hmax
