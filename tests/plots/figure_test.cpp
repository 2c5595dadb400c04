#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "core/own_files.hpp"
#include "plots/alt_text.hpp"
#include "plots/draw.hpp"
#include "plots/gnuplot.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

namespace fs = std::filesystem;

/// An empty folder of its own for each test, gone afterwards.
class FigureTest : public testing::Test {
 protected:
  const Scratch scratch;
  const fs::path folder = scratch.folder();
};

Figure small_figure() {
  return {.title = "Error falls with the step",
          .panels = {{.title = "a panel",
                      .x = {"h [s]", true},
                      .y = {"error [1]", true},
                      .curves = {{.label = "rk2_heun",
                                  .x = {0.1, 0.01, 0.001},
                                  .y = {1e-2, 1e-4, 1e-6},
                                  .lost = {1},
                                  .style = {.marker = 7}},
                                 {.label = "rk4", .x = {0.1, 0.01}, .y = {1e-4, 1e-8}, .lost = {1, 0.5}}}}},
          .footer = "fixed step; some machine"};
}

/// A gnuplot string literal on one line: opens and closes on it, no quote inside.
bool is_string_literal(const std::string& text) {
  return std::regex_match(text, std::regex(R"('[^'\n\r]*')"));
}

TEST(FigureTitle, OfAProblemLeavesOutTheFolderOfItsFile) {
  EXPECT_EQ(title_of("liver_cubic"), "liver_cubic");
  EXPECT_EQ(title_of("mass_spring/press@liver"), "mass_spring/press@liver");
  EXPECT_EQ(title_of("fem_green@/jobs/build@2/organ.msh"), "fem_green@organ.msh");
  EXPECT_EQ(title_of("/jobs/build@2/pendulum.toml"), "pendulum.toml");
}

TEST(GnuplotString, NothingEndsTheStringOrTheLine) {
  const std::string hostile[] = {
      "it's",    "'; system('touch x'); '",   "`touch x`", "a\nsystem('x')", "back\\",       "\\'",
      "@macro",  std::string("nul\0byte", 8), "\xff\xfe",  "\xe2\x80",       "\xed\xa0\x80", "tab\tcr\r",
      "\xc2\x85"};
  for (const std::string& text : hostile) EXPECT_TRUE(is_string_literal(gnuplot_string(text))) << text;
  EXPECT_EQ(gnuplot_string("it's"), "'it’s'");
  EXPECT_EQ(one_line("a\nb\xffλ"), "a b?λ");
}

TEST(GnuplotString, LongTextIsCutBetweenCharacters) {
  EXPECT_EQ(shortened("λλλλ", 4), "λλλλ");
  EXPECT_EQ(shortened("λλλλ", 3), "λλ…");
  EXPECT_EQ(length_of("ζ = 1"), 5u);
}

TEST_F(FigureTest, ScriptAndDataAreWrittenEvenWhenNothingCanBeDrawn) {
  const char* path = std::getenv("PATH");
  const std::string kept = path == nullptr ? "" : path;
  setenv("PATH", folder.c_str(), 1);
  const FigureFiles files = draw(small_figure(), folder / "new", "steps");
  setenv("PATH", kept.c_str(), 1);
  EXPECT_FALSE(files.drawn());
  EXPECT_NE(files.problem.find("gnuplot is not installed"), std::string::npos) << files.problem;
  EXPECT_NE(files.problem.find("apt-get install gnuplot-nox"), std::string::npos);
  ASSERT_EQ(files.made.size(), 2u);
  for (const fs::path& file : files.made) EXPECT_GT(fs::file_size(file), 0u);
}

TEST_F(FigureTest, GnuplotDrawsThreePicturesTwiceTheSame) {
  if (!gnuplot_available()) GTEST_SKIP() << "gnuplot is not installed";
  const FigureFiles first = draw(small_figure(), folder / "a", "steps");
  const FigureFiles second = draw(small_figure(), folder / "b", "steps");
  ASSERT_TRUE(first.drawn()) << first.problem;
  ASSERT_EQ(first.made.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(read_text(first.made[i]), read_text(second.made[i])) << first.made[i];
  EXPECT_EQ(read_text(folder / "a/steps.png").substr(1, 3), "PNG");
  EXPECT_EQ(read_text(folder / "a/steps.pdf").substr(0, 4), "%PDF");
  EXPECT_NE(read_text(folder / "a/steps.svg").find("rk2_heun"), std::string::npos);  // no subscript
}

TEST_F(FigureTest, TheScriptDrawsAgainInItsOwnFolder) {
  if (!gnuplot_available()) GTEST_SKIP() << "gnuplot is not installed";
  draw(small_figure(), folder, "steps");
  // Behind the words for those who cannot see it, which gnuplot knows nothing of.
  const auto drawn = [&] {
    const std::string svg = read_text(folder / "steps.svg");
    return svg.substr(svg.find("</desc>"));
  };
  const std::string before = drawn(), png = read_text(folder / "steps.png");
  fs::remove(folder / "steps.svg");
  EXPECT_EQ(run_gnuplot(folder, "steps.gp"), "");
  EXPECT_EQ(drawn(), before);
  EXPECT_EQ(read_text(folder / "steps.png"), png);
}

TEST_F(FigureTest, SaysInWordsWhatIsSeen) {
  Figure figure = small_figure();
  figure.title = "Error < step & more";
  EXPECT_EQ(
      alt_text(figure),
      "Error < step & more. a panel: error [1] (logarithmic) over h [s] (logarithmic). Shown: rk2_heun, rk4.");
  const FigureFiles files = draw(figure, folder, "steps");
  EXPECT_EQ(files.alt, alt_text(figure));
  if (!files.drawn()) GTEST_SKIP() << files.problem;
  const std::string svg = read_text(folder / "steps.svg");
  EXPECT_NE(svg.find("<svg role=\"img\""), std::string::npos);
  EXPECT_NE(svg.find("<title>Error &lt; step &amp; more</title>"), std::string::npos);
  EXPECT_NE(svg.find("Shown: rk2_heun, rk4.</desc>"), std::string::npos);
}

TEST(FigureSourceText, AMarkHasItsNameBesideIt) {
  Figure figure = small_figure();
  figure.panels[0].marks = {
      {.x = 0.1, .y = 1e-4, .style = {.marker = 7}, .label = "best", .name = "hht_alpha"},
      {.x = 0.01, .y = 1e-8, .style = {.marker = 7}, .label = "best"}};
  const std::string script = source_of(figure, "steps").script;
  const std::regex name(
      R"(set label 'hht_alpha' at graph 0\.\d+,0\.\d+ (left|right) offset [^\n]* noenhanced front\n)");
  EXPECT_EQ(std::distance(std::sregex_iterator(script.begin(), script.end(), name), std::sregex_iterator()),
            1);
  EXPECT_NE(alt_text(figure).find("best: hht_alpha"), std::string::npos) << alt_text(figure);
}

TEST(FigureSourceText, NamesOfAnAxisStandInThePlaceOfNumbers) {
  Figure figure{
      .panels = {{.x = {"h [s]", true},
                  .y = {.label = "method", .range = Range{0.5, 2.5}},
                  .curves = {{.x = {0.1, 0.2}, .y = {1, 2}, .style = {.marker = 7}, .line = false}}}}};
  const auto left_edge = [&] {
    const std::string script = source_of(figure, "steps").script;
    const std::size_t at = script.find("set lmargin at screen ");
    return std::stod(script.substr(at + 22));
  };
  const double before = left_edge();
  figure.panels[0].y.names = {"hht_alpha", "linearly_implicit_euler, Jacobian frozen"};
  const std::string script = source_of(figure, "steps").script;
  EXPECT_NE(script.find("set label 'hht_alpha' at screen "), std::string::npos) << script;
  EXPECT_NE(script.find("set ytics out scale 0.5 nomirror ('' 1, '' 2)"), std::string::npos) << script;
  EXPECT_GT(left_edge(), before);
  EXPECT_LT(left_edge(), 0.5);
}

TEST_F(FigureTest, GnuplotDrawsNames) {
  if (!gnuplot_available()) GTEST_SKIP() << "gnuplot is not installed";
  Figure figure = small_figure();
  figure.panels[0].y = {.label = "method", .range = Range{0.5, 2.5}, .names = {"one", "two"}};
  figure.panels[0].marks = {{.x = 0.1, .y = 1, .style = {.marker = 7}, .name = "hht_alpha"}};
  const FigureFiles files = draw(figure, folder, "names");
  ASSERT_TRUE(files.drawn()) << files.problem;
  const std::string svg = read_text(folder / "names.svg");
  for (const char* name : {"one", "two", "hht_alpha"}) EXPECT_NE(svg.find(name), std::string::npos) << name;
}

TEST(AltText, CountsWhatItDoesNotName) {
  Figure figure = small_figure();
  figure.panels.resize(7, figure.panels[0]);
  for (std::size_t i = 0; i < 7; ++i) figure.panels[i].title = "panel " + std::to_string(i);
  const std::string text = alt_text(figure);
  EXPECT_NE(text.find("panel 3"), std::string::npos) << text;
  EXPECT_EQ(text.find("panel 4"), std::string::npos) << text;
  EXPECT_NE(text.find("and 3 more"), std::string::npos) << text;
}

TEST_F(FigureTest, LongLabelsAreBrokenBeforeTheyMeet) {
  Figure figure = small_figure();
  figure.panels.resize(2, figure.panels[0]);
  figure.columns = 2;
  const std::string one_row = source_of(figure, "steps").script;
  for (Panel& panel : figure.panels)
    panel.x.label = "largest error of any displacement [m] or velocity [m/s], root mean square over time";
  const std::string script = source_of(figure, "steps").script;
  EXPECT_EQ(script.find("velocity [m/s], root mean square over time"), std::string::npos);
  EXPECT_NE(script.find("over time'"), std::string::npos);
  EXPECT_GT(script.find("svg size 900,"), 0U);
  EXPECT_NE(script.substr(script.find("svg size"), 20), one_row.substr(one_row.find("svg size"), 20));
}

TEST_F(FigureTest, TextOfASlideIsLargerBesideTheFigure) {
  Figure figure = small_figure();
  figure.panels.resize(3, figure.panels[0]);
  figure.columns = 3;
  const std::string page = source_of(figure, "steps").script;
  const double on_page = panel_width(3);
  set_figure_style(FigureStyle::slide);
  const std::string slide = source_of(figure, "steps").script;
  const double on_slide = panel_width(3), in_two = panel_width(2);
  set_figure_style(FigureStyle::page);
  EXPECT_NE(page.find("terminal svg size 900,"), std::string::npos);
  EXPECT_NE(slide.find("terminal svg size 600,"), std::string::npos);
  EXPECT_NE(slide.find("pngcairo size 1800,"), std::string::npos);
  EXPECT_GT(on_page, 200);
  EXPECT_EQ(on_slide, in_two);  // never three panels in a row
}

TEST_F(FigureTest, RefusesFilesOfOthersBeforehand) {
  allow_replacing(Replacing::own);
  std::ofstream(folder / "steps.svg") << "a drawing of somebody else";
  EXPECT_THROW(check_figure_files(folder, "steps"), InputError);
  fs::remove(folder / "steps.svg");
  EXPECT_NO_THROW(check_figure_files(folder, "steps"));
  allow_replacing(Replacing::any);
}

TEST_F(FigureTest, ScriptsNameNoFolder) {
  const FigureFiles files = draw(small_figure(), folder, "steps");
  for (const char* name : {"steps.gp", "steps.dat"})
    EXPECT_EQ(read_text(folder / name).find(folder.filename().string()), std::string::npos) << name;
}

TEST_F(FigureTest, HostileNamesRunNoCommand) {
  const std::string payloads[] = {"`touch injected`",
                                  "'\nsystem('touch injected')\n'",
                                  "\\\nsystem 'touch injected'",
                                  "'; system('touch injected'); '",
                                  "\"; !touch injected",
                                  "{/:Bold x}_{y}^{z} <&> %d %s",
                                  "\n!touch injected\n"};
  Figure figure = small_figure();
  for (const std::string& payload : payloads) {
    figure.title = figure.footer = figure.panels[0].title = figure.panels[0].lost_label = payload;
    figure.panels[0].x.label = figure.panels[0].y.label = payload;
    figure.panels[0].curves[0].label = payload;
    figure.panels[0].notes = {payload};
    figure.panels[0].marks = {{0.1, 0.1, {.marker = 7}, payload}};
    const FigureFiles files = draw(figure, folder, "steps");
    EXPECT_TRUE(files.drawn() || !gnuplot_available()) << payload << ": " << files.problem;
    EXPECT_FALSE(fs::exists(folder / "injected")) << payload;
    // Every line of the data is a comment, a row of numbers or empty.
    std::istringstream data(read_text(folder / "steps.dat"));
    for (std::string line; std::getline(data, line);)
      EXPECT_TRUE(std::regex_match(line, std::regex(R"(#.*|[-+.e0-9 ]*)"))) << line;
  }
  if (gnuplot_available()) {
    figure.title = "a < b & c";
    draw(figure, folder, "steps");
    EXPECT_NE(read_text(folder / "steps.svg").find("a &lt; b &amp; c"), std::string::npos);
  }
}

TEST(FigureSourceText, EveryTextIsDrawnWithoutMarkup) {
  Figure figure = small_figure();
  std::istringstream script(source_of(figure, "steps").script);
  for (std::string line; std::getline(script, line);)
    if (std::regex_match(line, std::regex("set x?label '[^'].*"))) {
      EXPECT_NE(line.find("noenhanced"), std::string::npos) << line;
    }
}

TEST(FigureSourceText, EveryLostRunIsMarkedInTheStrip) {
  const std::string script = source_of(small_figure(), "steps").script;
  const std::regex mark(R"(set label '' at graph [0-9.]+,0\.9[0-9]+ point)");
  EXPECT_EQ(std::distance(std::sregex_iterator(script.begin(), script.end(), mark), {}), 3);
  EXPECT_NE(script.find("'diverged'"), std::string::npos);
  Figure calm = small_figure();
  for (Curve& curve : calm.panels[0].curves) curve.lost.clear();
  EXPECT_EQ(source_of(calm, "steps").script.find("'diverged'"), std::string::npos);
}

TEST(FigureSourceText, PointsThatCannotBeDrawnAreLeftOut) {
  Figure figure = small_figure();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   infinity = std::numeric_limits<double>::infinity();
  figure.panels[0].curves = {
      {.label = "odd", .x = {1, 2, 3, 4, 5, nan}, .y = {1, nan, infinity, 0, 10, 1}, .style = {.marker = 7}}};
  const FigureSource source = source_of(figure, "steps");
  EXPECT_NE(source.data.find("\n1 1\n5 10\n"), std::string::npos) << source.data;
  for (const std::string& text : {source.data, source.script}) {
    EXPECT_EQ(text.find("nan"), std::string::npos);
    EXPECT_EQ(text.find("inf"), std::string::npos);
  }
}

TEST(FigureSourceText, NoLineCrossesALostRun) {
  Figure figure = small_figure();
  figure.panels[0].curves = {{.label = "Euler", .x = {0.01, 0.02, 2}, .y = {1, 2, 3}, .lost = {0.5, 4}}};
  const std::string data = source_of(figure, "steps").data;
  EXPECT_NE(data.find("\n0.01 1\n0.02 2\n\n2 3\n"), std::string::npos) << data;
}

TEST(FigureSourceText, ALongFooterIsBrokenIntoLinesBelowTheKey) {
  Figure figure = small_figure();
  const auto height = [](const std::string& script) {
    static const std::regex size("set terminal svg size 900,([0-9]+)");
    std::smatch match;
    EXPECT_TRUE(std::regex_search(script, match, size));
    return std::stoi(match[1]);
  };
  const int before = height(source_of(figure, "f").script);
  figure.footer = "E=5500";
  for (int i = 0; i < 60; ++i) figure.footer += " number" + std::to_string(i);
  const std::string script = source_of(figure, "f").script;
  EXPECT_GT(height(script), before + 2 * 12);
  for (const char* word : {"number0 ", "number30", "number59"})
    EXPECT_NE(script.find(word), std::string::npos) << word;
  std::istringstream lines(script);
  for (std::string line; std::getline(lines, line);)
    if (line.find("number") != std::string::npos) {
      EXPECT_LT(line.size(), 145 + 100U);
    }
}

TEST(FigureSourceText, LabelsAlongXHaveRoomBesideEachOther) {
  // Three panels beside each other, each 206 pixels wide.
  const auto xtics = [](bool logarithmic, double low, double high) {
    Figure figure = small_figure();
    figure.columns = 3;
    figure.panels[0].x = {.label = "h [s]", .logarithmic = logarithmic, .range = Range{low, high}};
    figure.panels.resize(3, figure.panels[0]);
    const std::string script = source_of(figure, "steps").script;
    const auto from = script.find("set xtics out scale 0.5 nomirror ") + 33;
    return script.substr(from, script.find('\n', from) - from);
  };
  EXPECT_EQ(xtics(false, 0, 0.0012), "0.0005") << "0.0002 has too little room for six characters";
  EXPECT_EQ(xtics(false, 0, 5), "1");
  EXPECT_EQ(xtics(true, 1e-4, 9e-3).find("2·"), std::string::npos);
  EXPECT_NE(xtics(true, 1e-4, 9e-3).find("3·"), std::string::npos);
  EXPECT_NE(xtics(true, 1, 9).find("2·"), std::string::npos);
  EXPECT_NE(xtics(true, 2.2, 4.5).find("'3' 3"), std::string::npos) << "no power and no multiple is in it";
  EXPECT_NE(xtics(true, 0.0105, 0.0115).find("'0.011' 0.011"), std::string::npos);
}

TEST(LinesOf, KeepsWordsWhole) {
  EXPECT_EQ(lines_of("one two three", 7), (std::vector<std::string>{"one two", "three"}));
  EXPECT_EQ(lines_of("one", 1), std::vector<std::string>{"one"});
  EXPECT_TRUE(lines_of("", 7).empty());
}

TEST_F(FigureTest, TheFirstPowerOfTenIsLabelled) {
  if (!gnuplot_available()) GTEST_SKIP() << "gnuplot is not installed";
  Figure figure{.panels = {{.x = {"k [N/m]", true, Range{100, 1e6}}}}};
  figure.panels[0].curves.push_back({.x = {100, 1e6}, .y = {0, 1}});
  ASSERT_TRUE(draw(figure, folder, "powers").drawn());
  const std::string svg = read_text(folder / "powers.svg");
  for (const char* power : {">2<", ">3<", ">6<"}) EXPECT_NE(svg.find(power), std::string::npos) << power;
}

TEST_F(FigureTest, EverySampleOfTheKeyHasItsDash) {
  if (!gnuplot_available()) GTEST_SKIP() << "gnuplot is not installed";
  Figure figure{.panels = {{}}};
  for (int dash = 0; dash < 5; ++dash)
    figure.panels[0].curves.push_back(
        {.label = std::to_string(dash), .x = {0, 1}, .y = {0, 1.0 + dash}, .style = {.dash = dash}});
  ASSERT_TRUE(draw(figure, folder, "dashes").drawn());
  const std::string svg = read_text(folder / "dashes.svg");
  // Once in the panel and once in the key, each with a path of its own.
  std::map<std::string, int> paths;
  const std::regex dashed("stroke='rgb\\(  0, 114, 178\\)'( stroke-dasharray='[^']*')?");
  for (std::sregex_iterator path(svg.begin(), svg.end(), dashed), end; path != end; ++path)
    ++paths[path->str(1)];
  EXPECT_EQ(paths.size(), 5U);
  for (const auto& [dash, count] : paths) EXPECT_EQ(count, 2) << dash;
}

TEST_F(FigureTest, APanelWithNothingToDrawIsDrawnEmpty) {
  Figure figure{
      .panels = {{.x = {"h [s]", true}, .y = {"error [1]", true}}, {.x = {"t [s]"}, .y = {"x [m]"}}}};
  figure.panels[0].curves = {{.label = "all lost", .lost = {1, 2}}};
  const FigureFiles files = draw(figure, folder, "empty");
  EXPECT_TRUE(files.drawn() || !gnuplot_available()) << files.problem;
}

TEST_F(FigureTest, ALineWithoutMarkersKeepsItsShapeWithFewerPoints) {
  Curve wave{.label = "wave"};
  for (int i = 0; i <= 200000; ++i) {
    wave.x.push_back(i * 1e-5);
    wave.y.push_back(std::sin(20 * wave.x.back()));
  }
  const FigureSource source = source_of({.panels = {{.curves = {wave}}}}, "wave");
  const auto lines = std::count(source.data.begin(), source.data.end(), '\n');
  EXPECT_LT(lines, 30000);
  EXPECT_GT(lines, 1000);
  EXPECT_NE(source.data.find("\n2 "), std::string::npos);  // the last point is kept
}

TEST_F(FigureTest, BadNamesAndPlacesAreInputErrors) {
  for (const char* name : {"", "a/b", "../x", "a b", "a'b", "-d", "é"})
    EXPECT_THROW(draw(small_figure(), folder, name), InputError) << name;
  EXPECT_THROW(draw({}, folder, "none"), InputError);
  std::ofstream(folder / "file") << "in the way";
  EXPECT_THROW(draw(small_figure(), folder / "file", "steps"), InputError);
}

TEST_F(FigureTest, AFailureOfGnuplotIsTold) {
  if (!gnuplot_available()) GTEST_SKIP() << "gnuplot is not installed";
  std::ofstream(folder / "wrong.gp") << "plot nonsense(\n";
  EXPECT_NE(run_gnuplot(folder, "wrong.gp").find("could not draw"), std::string::npos);
}

TEST_F(FigureTest, ThePdfHasNoTimeOfDay) {
  const std::string kept = std::getenv("PATH");
  const auto pdf_of = [&](const std::string& drawn) {
    std::ofstream(folder / "drawn") << drawn;
    std::ofstream(folder / "gnuplot")
        << "#!/bin/sh\n/bin/cp " << (folder / "drawn").string() << " steps.pdf\n";
    std::filesystem::permissions(folder / "gnuplot", std::filesystem::perms::owner_all);
    setenv("PATH", folder.c_str(), 1);
    draw(small_figure(), folder, "steps");
    setenv("PATH", kept.c_str(), 1);
    return read_text(folder / "steps.pdf");
  };
  EXPECT_EQ(pdf_of("%PDF-1.5 /CreationDate (D:20261126143301Z) end"),
            "%PDF-1.5 /CreationDate (D:19700101000000Z) end");
  EXPECT_EQ(pdf_of("%PDF-1.5 /CreationDate (D:20261126143301"), "%PDF-1.5 /CreationDate (D:19700101000000");
  // Without a date, or cut off within it.
  for (const char* other :
       {"%PDF-1.5", "%PDF-1.5 /CreationDate (D:2026112614330", "%PDF-1.5 /CreationDate (D:"})
    EXPECT_EQ(pdf_of(other), other);
}

TEST_F(FigureTest, AGnuplotThatHangsIsEnded) {
  std::ofstream(folder / "gnuplot") << "#!/bin/sh\nexec /bin/sleep 60\n";
  std::filesystem::permissions(folder / "gnuplot", std::filesystem::perms::owner_all);
  const std::string kept = std::getenv("PATH");
  setenv("PATH", folder.c_str(), 1);
  const std::string told = run_gnuplot(folder, "a.gp", 0.2);
  setenv("PATH", kept.c_str(), 1);
  EXPECT_NE(told.find("took longer than"), std::string::npos) << told;
}

TEST_F(FigureTest, WhatAGnuplotThatHangsHasStartedIsEndedToo) {
  std::ofstream(folder / "gnuplot") << "#!/bin/sh\n/bin/sleep 60 & echo $! > started\nwait\n";
  std::filesystem::permissions(folder / "gnuplot", std::filesystem::perms::owner_all);
  const std::string kept = std::getenv("PATH");
  setenv("PATH", folder.c_str(), 1);
  const std::string told = run_gnuplot(folder, "a.gp", 0.5);
  setenv("PATH", kept.c_str(), 1);
  EXPECT_NE(told.find("took longer than"), std::string::npos) << told;
  pid_t started = 0;
  std::ifstream(folder / "started") >> started;
  ASSERT_GT(started, 0);
  // Ended and not yet waited for by init counts as ended.
  const auto runs = [&] {
    std::ifstream stat("/proc/" + std::to_string(started) + "/stat");
    std::string number, name, state;
    return stat >> number >> name >> state && state != "Z";
  };
  for (int i = 0; i < 100 && runs(); ++i) usleep(10'000);
  EXPECT_FALSE(runs());
}

}  // namespace
}  // namespace hmax
