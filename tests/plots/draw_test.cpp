/// Where a figure's script puts what it draws, in pixels of the page.
#include "plots/draw.hpp"

#include <array>
#include <cmath>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "plots/gnuplot.hpp"

namespace hmax {
namespace {

constexpr double page = 900;

/// All places of a script at which a pattern of two numbers stands.
std::vector<std::array<double, 2>> places(const std::string& script, const std::string& before,
                                          const std::string& after = "") {
  const std::regex pattern(before + "([-+.0-9e]+)[,:]([-+.0-9e]+)" + after);
  std::vector<std::array<double, 2>> found;
  for (std::sregex_iterator at(script.begin(), script.end(), pattern), end; at != end; ++at)
    found.push_back({std::stod(at->str(1)), std::stod(at->str(2))});
  return found;
}
std::vector<double> numbers(const std::string& script, const std::string& before) {
  const std::regex pattern(before + "([-+.0-9e]+)");
  std::vector<double> found;
  for (std::sregex_iterator at(script.begin(), script.end(), pattern), end; at != end; ++at)
    found.push_back(std::stod(at->str(1)));
  return found;
}

/// The plotting areas of a script's panels [pixels], y down.
struct Place {
  double left, right, top, bottom;
};
std::vector<Place> panels_of(const std::string& script) {
  const double height = places(script, "set terminal svg size ").at(0)[1];
  const auto l = numbers(script, "set lmargin at screen "), r = numbers(script, "set rmargin at screen "),
             t = numbers(script, "set tmargin at screen "), b = numbers(script, "set bmargin at screen ");
  std::vector<Place> found;
  for (std::size_t i = 0; i < l.size(); ++i)
    found.push_back({page * l[i], page * r[i], height * (1 - t[i]), height * (1 - b[i])});
  return found;
}

/// One panel with so many curves that are all lost at x = 2.
Figure lost_at_two(std::size_t count) {
  Figure figure{.panels = {{.x = {.range = Range{0, 10}}, .y = {.range = Range{0, 6}}}}};
  for (std::size_t i = 0; i < count; ++i)
    figure.panels[0].curves.push_back({.x = {5}, .y = {6}, .lost = {2}, .style = {.marker = 1}});
  return figure;
}

TEST(LostRuns, StandInRowsOfFourTenPixelsApartInTheMiddleOfTheirStep) {
  for (const bool named : {false, true}) {
    Figure figure = lost_at_two(6);
    if (named) figure.panels[0].y.names = {"a long name of a row of the figure"};
    const std::string script = source_of(figure, "f").script;
    const Place place = panels_of(script).at(0);
    const double wide = place.right - place.left;
    EXPECT_NEAR(place.bottom - place.top, 300, 0.02);
    EXPECT_EQ(wide < 750, named);
    const auto marks = places(script, "set label '' at graph ", " point");
    ASSERT_EQ(marks.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) {
      const double row = i < 4 ? 0 : 1,
                   from_middle = i < 4 ? static_cast<double>(i) - 1.5 : static_cast<double>(i) - 4.5;
      EXPECT_NEAR((marks[i][0] - 0.2) * wide, 10 * from_middle, 0.02) << i;
      EXPECT_NEAR((1 - marks[i][1]) * 300, 5 + 10 * (row + 0.5), 0.02) << i;
    }
    // The strip holds two rows and five pixels on both sides; the range of y ends under it.
    const double strip = 1 - places(script, "set object rectangle from graph ").at(0)[1];
    EXPECT_NEAR(strip * 300, 30, 0.02);
    EXPECT_NEAR(places(script, R"(set yrange \[)").at(0)[1], 6 / (1 - strip), 1e-4);
  }
}

TEST(LostRuns, HaveNarrowerRowsWhereTheNextStepIsNear) {
  Figure figure = lost_at_two(5);
  const double wide = page - left_margin - right_margin;
  figure.panels[0].curves[4].lost = {2 + 10 * 25 / wide};  // 25 pixels: two marks a row
  const auto marks = places(source_of(figure, "f").script, "set label '' at graph ", " point");
  ASSERT_EQ(marks.size(), 5U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR((marks[i][0] - 0.2) * wide, i % 2 == 0 ? -5 : 5, 0.02) << i;
    EXPECT_NEAR((1 - marks[i][1]) * 300, i < 2 ? 10 : 20, 0.02) << i;
  }
  EXPECT_NEAR((marks[4][0] - 0.2) * wide, 25, 0.02);
  EXPECT_NEAR((1 - marks[4][1]) * 300, 10, 0.02);
  // On a logarithmic axis the curve ends under the strip, too.
  figure.panels[0].y = {.logarithmic = true, .range = Range{1, 100}};
  const std::string script = source_of(figure, "f").script;
  const double strip = 1 - places(script, "set object rectangle from graph ").at(0)[1];
  EXPECT_NEAR(std::log10(places(script, R"(set yrange \[)").at(0)[1]), 2 / (1 - strip), 1e-4);
}

TEST(Ranges, HaveAMarginInTheCoordinateInWhichTheAxisIsEven) {
  const auto range = [](char axis, const Curve& curve, bool logarithmic) {
    const Figure figure{
        .panels = {
            {.x = {.logarithmic = logarithmic}, .y = {.logarithmic = logarithmic}, .curves = {curve}}}};
    return places(source_of(figure, "f").script, std::string("set ") + axis + R"(range \[)").at(0);
  };
  const auto expect_range = [](std::array<double, 2> found, double low, double high) {
    EXPECT_NEAR(found[0], low, 1e-6 * std::abs(high - low));
    EXPECT_NEAR(found[1], high, 1e-6 * std::abs(high - low));
  };
  const Curve line{.x = {1, 100}, .y = {10, 20}}, dots{.x = {1, 100}, .y = {10, 20}, .style = {.marker = 1}};
  expect_range(range('y', line, false), 10 - 0.6, 20 + 0.6);
  expect_range(range('x', line, false), 1, 100);
  expect_range(range('x', dots, false), 1 - 0.04 * 99, 100 + 0.04 * 99);
  expect_range(range('x', dots, true), std::pow(10, -0.08), std::pow(10, 2.08));
  // One value: a tenth of it, or half a decade, on both sides.
  const Curve point{.x = {50}, .y = {50}};
  expect_range(range('x', point, false), 45, 55);
  expect_range(range('y', point, true), 50 / std::sqrt(10), 50 * std::sqrt(10));
  // Nothing at all.
  expect_range(range('x', {}, false), 0 - 0.0, 1);
  expect_range(range('x', {}, true), 1, 10);
  // Ends of bars.
  expect_range(range('y', {.x = {1, 2}, .y = {3, 3}, .low = {1, 2}, .high = {4, 11}}, false), 1 - 0.6,
               11 + 0.6);
}

TEST(Ranges, IncludeAreasFillsAndMarks) {
  Figure figure{.panels = {{.areas = {{.x = {1}, .y = {10}, .w = {2}, .h = {4}}}}}};
  const auto range = [&](char axis) {
    return places(source_of(figure, "f").script, std::string("set ") + axis + R"(range \[)").at(0);
  };
  EXPECT_EQ(range('x'), (std::array{0.0, 2.0}));
  EXPECT_NEAR(range('y')[0], 8 - 0.06 * 4, 1e-9);
  EXPECT_NEAR(range('y')[1], 12 + 0.06 * 4, 1e-9);
  figure.panels[0].fills = {{.loops = {{{-3, 9}, {5, 9}, {5, 9.5}}}}};
  EXPECT_EQ(range('x'), (std::array{-3.0, 5.0}));
  figure.panels[0].marks = {{.x = 15, .y = 30, .style = {.marker = 1}}};
  EXPECT_NEAR(range('x')[0], -3 - 0.04 * 18, 1e-9);
  EXPECT_NEAR(range('y')[1], 30 + 0.06 * 22, 1e-9);
}

TEST(Panels, StandInRowsAndColumnsOfTheirSize) {
  Figure figure{.panels = {{.curves = {{.label = "one", .x = {0, 1}, .y = {0, 1}}}}},
                .columns = 2,
                .panel_height = 200};
  figure.panels.resize(3, figure.panels[0]);
  figure.panels[2].notes = {"a note", "another"};
  const auto place = panels_of(source_of(figure, "f").script);
  ASSERT_EQ(place.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(place[i].right - place[i].left, 450 - left_margin - right_margin, 0.02) << i;
    EXPECT_NEAR(place[i].left, (i == 1 ? 450 : 0) + left_margin, 0.02) << i;
    EXPECT_NEAR(place[i].bottom - place[i].top, 200, 0.02) << i;
  }
  EXPECT_NEAR(place[1].top, place[0].top, 1e-9);
  // Numbers and label of the axis, then two lines of notes.
  EXPECT_NEAR(place[2].top - place[0].bottom, 56 + 8 + 2 * 15, 0.02);
}

TEST(Keys, AreFilledDownTheirColumns) {
  Figure figure{.panels = {{}}};
  for (int i = 0; i < 8; ++i)
    figure.panels[0].curves.push_back({.label = "entry " + std::to_string(i), .x = {0, 1}, .y = {0, 1}});
  const std::string script = source_of(figure, "f").script;
  const double height = places(script, "set terminal svg size ").at(0)[1];
  const auto samples = places(script, "set arrow from screen "), ends = places(script, "to screen ");
  ASSERT_EQ(samples.size(), 8U);
  // Six columns at most, so two rows of four; 19 pixels a row.
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(samples[i][0],
                samples[i % 2][0] + static_cast<double>(i / 2) * (samples[2][0] - samples[0][0]), 3e-5)
        << i;
    EXPECT_NEAR((samples[i][1] - samples[i - i % 2][1]) * height, i % 2 == 0 ? 0 : -19, 0.02) << i;
    EXPECT_NEAR((ends[i][0] - samples[i][0]) * page, 34, 0.02) << i;
  }
  EXPECT_NEAR(samples[0][0] * page, left_margin - 30, 0.02);
  EXPECT_EQ(script.find(" point pt"), std::string::npos) << "curves without markers";
  EXPECT_GT((samples[2][0] - samples[0][0]) * page, 34 + 7 * static_cast<double>(length_of("entry 0")));
  const Place place = panels_of(script).at(0);
  EXPECT_GT(height * (1 - samples[0][1]), place.bottom + 45);
  EXPECT_LT(height * (1 - samples[1][1]), height - 20);
}

TEST(Keys, ShowTheMarkerInTheMiddleOfTheLine) {
  const Figure figure{
      .panels = {{.curves = {{.label = "dots", .x = {0, 1}, .y = {0, 1}, .style = {.marker = 7}}}}}};
  const std::string script = source_of(figure, "f").script;
  const auto line = places(script, "set arrow from screen "),
             marker = places(script, "set label '' at screen ", " point pt 7");
  ASSERT_EQ(marker.size(), 1U);
  EXPECT_NEAR((marker[0][0] - line.at(0)[0]) * page, 17, 0.02);
  EXPECT_EQ(marker[0][1], line[0][1]);
}

TEST(Headings, FitTheirPanel) {
  // Of a third of a page: (300 - 94) pixels by 8.4 a character.
  Figure figure{.panels = {{.title = std::string(200, 'x'), .curves = {{.x = {0, 1}, .y = {0, 1}}}}},
                .columns = 3};
  figure.panels.resize(3, figure.panels[0]);
  figure.panels[0].notes = {std::string(200, 'y')};
  const std::string script = source_of(figure, "f").script;
  EXPECT_NE(script.find("'" + std::string(23, 'x') + "…'"), std::string::npos);
  EXPECT_NE(script.find("'" + std::string(32, 'y') + "…'"), std::string::npos);
}

TEST(NamesOfMarks, StandInCornersOfTheirOwnWhereMarksLieOnOneAnother) {
  Figure figure;
  figure.panels.emplace_back();
  for (const char* name : {"1", "2", "3", "4"})
    figure.panels[0].marks.push_back({.x = 1, .y = 1, .style = {.marker = 1}, .name = name});
  figure.panels[0].marks.push_back({.x = 2, .y = 2, .style = {.marker = 1}, .name = "far"});
  const std::string script = source_of(figure, "f").script;
  const std::regex corner(R"(set label '[1-4]' at graph \S+ \w+ offset (\S+) font)");
  std::set<std::string> corners;
  for (std::sregex_iterator found(script.begin(), script.end(), corner), end; found != end; ++found)
    corners.insert((*found)[1]);
  EXPECT_EQ(corners, (std::set<std::string>{"1,0.8", "1,-0.8", "-1,0.8", "-1,-0.8"})) << script;
}

TEST(NamesOfMarks, AreLeftOutWithMarksBeyondTheAxes) {
  Figure figure{.panels = {{.x = {.range = Range{0, 10}}, .y = {.range = Range{0, 10}}}}};
  figure.panels[0].marks = {{.x = 5, .y = 12, .style = {.marker = 1}, .name = "high"},
                            {.x = 5, .y = 9, .style = {.marker = 1}, .name = "seen"}};
  const std::string script = source_of(figure, "f").script;
  EXPECT_EQ(script.find("'high'"), std::string::npos);
  EXPECT_NE(script.find("'seen'"), std::string::npos);
}

TEST(NamesOfMarks, StandTowardsTheMiddle) {
  Figure figure{.panels = {{.x = {.range = Range{0, 10}}, .y = {.range = Range{0, 10}}}}};
  for (const double x : {2.0, 8.0})
    for (const double y : {3.0, 7.0})
      figure.panels[0].marks.push_back({.x = x, .y = y, .style = {.marker = 1}, .name = "mark"});
  const std::string script = source_of(figure, "f").script;
  for (const char* expected :
       {"0.20000,0.30000 left offset 1,0.8 ", "0.20000,0.70000 left offset 1,-0.8 ",
        "0.80000,0.30000 right offset -1,0.8 ", "0.80000,0.70000 right offset -1,-0.8 "})
    EXPECT_NE(script.find(std::string("set label 'mark' at graph ") + expected), std::string::npos)
        << expected;
}

TEST(Data, OfEveryKindIsWhatGnuplotIsToldToRead) {
  const auto data = [](const Panel& panel) { return source_of({.panels = {panel}}, "f").data; };
  const auto expect_rows = [](const std::string& text, const std::string& rows) {
    EXPECT_EQ(text.substr(text.find('\n') + 1), rows);
  };
  // Centres and half sizes.
  expect_rows(data({.areas = {{.x = {1}, .y = {10}, .w = {2}, .h = {5}}}}), "1 10 1 2.5\n");
  expect_rows(data({.arrows = {.x = {1}, .y = {2}, .dx = {3}, .dy = {4}}}), "1 2 3 4\n");
  // Two points a line.
  expect_rows(data({.curves = {{.x = {1, 2, 3, 4}, .y = {1, 1, 2, 2}, .strokes = true}}}),
              "1 1\n2 1\n\n3 2\n4 2\n");
  // Bars, whose ends that cannot be drawn are the point itself.
  expect_rows(data({.curves = {{.x = {1, 2}, .y = {3, 4}, .low = {2, NAN}, .high = {4, 5}}}}),
              "1 3 2 4\n2 4 4 5\n");
  expect_rows(data({.y = {.logarithmic = true},
                    .curves = {{.x = {1, 2}, .y = {3, 4}, .low = {2, -1}, .high = {4, 5}}}}),
              "1 3 2 4\n2 4 4 5\n");
  // A loop is closed; a later one is reached from the start of the first and left to it again; two points are
  // none.
  expect_rows(
      data({.fills = {{.loops = {{{0, 0}, {9, 0}, {0, 9}}, {{1, 1}, {2, 2}}, {{1, 1}, {1, 2}, {2, 1}}}}}}),
      "0 0\n9 0\n0 9\n0 0\n1 1\n1 2\n2 1\n1 1\n0 0\n");
}

TEST(Key, FillsItsColumnsInTheOrderOfItsEntries) {
  Figure figure{.panels = {{.x = {.range = Range{0, 10}}, .y = {.range = Range{0, 6}}}}};
  for (int i = 0; i < 11; ++i)
    figure.panels[0].curves.push_back({.label = "a curve of number " + std::to_string(i),
                                       .x = {1, 2},
                                       .y = {1, 2},
                                       .style = {.width = 1.0 + i}});
  const std::string script = source_of(figure, "f").script;
  const auto samples = places(script, "set arrow from screen ");
  ASSERT_EQ(samples.size(), 11U);
  std::size_t rows = 0;
  while (rows < samples.size() && samples[rows][0] == samples[0][0]) ++rows;
  // Several columns of several rows, on the page, equally far apart.
  ASSERT_TRUE(rows > 1 && rows < samples.size()) << rows;
  const double wide = samples[rows][0] - samples[0][0], high = samples[0][1] - samples[1][1];
  EXPECT_GT(wide, 0.1);
  EXPECT_GT(high, 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_NEAR(samples[i][0], samples[0][0] + wide * static_cast<double>(i / rows), 2e-5) << i;
    EXPECT_NEAR(samples[i][1], samples[0][1] - high * static_cast<double>(i % rows), 5e-5) << i;
    EXPECT_TRUE(samples[i][0] > 0 && samples[i][0] < 0.9 && samples[i][1] > 0) << i;
  }
}

}  // namespace
}  // namespace hmax
