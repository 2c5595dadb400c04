#include "cli/reproduce/report_text.hpp"

#include <cmath>
#include <regex>
#include <set>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "plots/pages/markdown_page.hpp"
#include "studies/scale_study.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Ordered = nlohmann::ordered_json;

/// The message of what `filled` throws; empty where it throws nothing.
std::string refusal(std::string_view text, const Ordered& values, const ReportPieces& pieces = {}) {
  return error_of<std::logic_error>([&] { filled(text, values, pieces); });
}

TEST(ReportText, FormatsNumbersAndEscapesWords) {
  const Ordered values{
      {"n", 7},      {"x", 0.0123456789}, {"large", 123456.7}, {"many", {1.5, 2.25}}, {"never", INFINITY},
      {"none", NAN}, {"name", "rk2_heun"}};
  EXPECT_EQ(
      filled("{{n}} {{x}} {{x:.2g}} {{x*1000:.3g}} mm {{large:3 digits}} {{x:3 digits}} {{many}} {{name}} "
             "{{never:.3g}} {{none:.3g}}",
             values, {}),
      "7 0.0123457 0.012 12.3 mm 123000 0.0123 1.5, 2.25 rk2\\_heun unbounded –");
}

TEST(ReportText, RepeatsRowsAndLooksNamesUpFromInsideOut) {
  const Ordered values{{"unit", "s"},
                       {"rows", {{{"h", 1}, {"unit", "ms"}}, {{"h", 2}, {"unit", "us"}}}},
                       {"empty", Ordered::array()},
                       {"box", Ordered::object({{"inside", 3}})},
                       {"words", {"a", "b"}}};
  EXPECT_EQ(
      filled("| h |\n{{#rows}}\n| {{h}} {{unit}} |\n{{/rows}}\nin {{unit}}{{#box}}, {{inside}}{{/box}}\n"
             "{{#empty}}{{/empty}}{{^empty}}none{{/empty}} {{#words|; }}<{{.}}>{{/words}}",
             values, {}),
      "| h |\n| 1 ms |\n| 2 us |\nin s, 3\nnone <a>; <b>");
}

TEST(ReportText, ShowsASentenceWhereItsConditionHolds) {
  const std::string text = "A.\n{{#good}}\nGood: {{x}}.\n{{/good}}\n{{^good}}\nBad.\n{{/good}}\n";
  EXPECT_EQ(filled(text, {{"good", true}, {"x", 1}}, {}), "A.\nGood: 1.\n");
  EXPECT_EQ(filled(text, {{"good", false}, {"x", 1}}, {}), "A.\nBad.\n");
}

TEST(ReportText, PutsPiecesWhereTheyBelong) {
  EXPECT_EQ(
      filled("{{figure motion}} {{motion}}\n{{#files|, }}{{link .}}{{/files}}",
             {{"files", {"a.csv", "b.csv"}}, {"motion", 1}},
             {{"figure motion", "![m](m.svg)"}, {"link a.csv", "[A](a.csv)"}, {"link b.csv", "[B](b.csv)"}}),
      "![m](m.svg) 1\n[A](a.csv), [B](b.csv)");
}

TEST(ReportText, RefusesUnknownPlaces) {
  EXPECT_TRUE(says(refusal("{{x}}", Ordered::object()), "the place {{x}}: it has no value"));
  EXPECT_TRUE(says(refusal("{{figure x}}", Ordered::object()), "the place {{figure x}}: there is none"));
  // Also where nobody would see it today.
  EXPECT_TRUE(says(refusal("{{#a}}{{x}}{{/a}}", {{"a", false}}), "the place {{x}}"));
  EXPECT_TRUE(says(refusal("{{^a}}{{x}}{{/a}}", {{"a", true}}), "the place {{x}}"));
  EXPECT_EQ(refusal("{{#a}}{{x}}{{/a}}", {{"a", nullptr}}), "");
}

TEST(ReportText, RefusesWhatHasNoPlace) {
  EXPECT_TRUE(says(refusal("{{x}}", {{"x", 1}, {"y", 2}}), "no place for the value y"));
  EXPECT_TRUE(says(refusal("{{#rows}}{{x}}{{/rows}}", {{"rows", {{{"x", 1}, {"y", 2}}}}}),
                   "no place for the value rows.y"));
  EXPECT_TRUE(says(refusal("{{#box}}{{x}}{{/box}}", {{"box", {{"x", 1}, {"y", 2}}}}),
                   "no place for the value box.y"));
  EXPECT_TRUE(says(refusal("", Ordered::object(), {{"figure x", ""}}), "no place for the figure x"));
  EXPECT_EQ(refusal("{{#a}}{{x}}{{/a}}", {{"a", false}, {"x", 1}}), "");
}

TEST(ReportText, RefusesWrongPlaces) {
  EXPECT_TRUE(says(refusal("{{x", {{"x", 1}}), "no end"));
  EXPECT_TRUE(says(refusal("{{#x}}", {{"x", true}}), "no end"));
  EXPECT_TRUE(says(refusal("{{/x}}", {{"x", true}}), "ends no part"));
  EXPECT_TRUE(says(refusal("{{#x}}{{#y}}{{/x}}{{/y}}", {{"x", true}, {"y", true}}), "ends no part"));
  EXPECT_TRUE(says(refusal("{{#x}}{{/x}}", {{"x", 1}}), "no yes or no"));
  EXPECT_TRUE(says(refusal("{{x:.3g}}", {{"x", "word"}}), "no number"));
  EXPECT_TRUE(says(refusal("{{x:.3q}}", {{"x", 1.5}}), "the place {{x:.3q}}"));
  EXPECT_TRUE(says(refusal("{{x}}", {{"x", true}}), "no number"));
}

TEST(ReportText, OfEveryReportIsThere) {
  EXPECT_EQ(report_texts().size(), 6U);
  for (const char* name : {"all", "docket", "oscillators", "real_time", "stability", "tissue"}) {
    EXPECT_TRUE(report_text(name).starts_with("# ")) << name;
    // Values are escaped, which a code span would show.
    EXPECT_EQ(report_text(name).find("`{{"), std::string_view::npos) << name;
  }
  EXPECT_THROW(report_text("none"), std::logic_error);
}

/// Links lead into the pages of the parts by their headings.
TEST(ReportText, OfAllLinksToHeadingsThatAreThere) {
  static const std::regex link("\\]\\((\\w+)\\.md#([^)]+)\\)"), heading("(?:^|\n)###? ([^\n]*)");
  const std::string all(report_text("all"));
  int links = 0;
  for (std::sregex_iterator it(all.begin(), all.end(), link), end; it != end; ++it, ++links) {
    const std::string part(report_text((*it)[1].str()));
    std::set<std::string> anchors;
    for (std::sregex_iterator each(part.begin(), part.end(), heading); each != end; ++each)
      anchors.insert(heading_anchor((*each)[1].str()));
    EXPECT_TRUE(anchors.contains((*it)[2].str())) << it->str();
  }
  EXPECT_GT(links, 20);
}

/// No item of the sources is left open.
TEST(ReportText, OfAllHasAnAnswerForEveryItem) {
  static const std::regex row("\n\\| ([^|\n]+) \\| ([^|\n]+) \\| ([^|\n]*) \\|"),
      answer("(redone: .*\\S|judged.*: \\[.*|out of reach: .*\\S.*)");
  const std::string all(report_text("all"));
  int rows = 0;
  std::set<int> slides;
  for (std::sregex_iterator it(all.begin(), all.end(), row), end; it != end; ++it) {
    const std::string printed = (*it)[1].str(), says = (*it)[3].str();
    if (printed == "printed" || printed == "---") continue;
    EXPECT_TRUE(std::regex_match(says, answer)) << it->str();
    ++rows;
    if (!printed.starts_with("Slide")) continue;
    static const std::regex range("(\\d+)(?: to (\\d+))?");
    for (std::sregex_iterator each(printed.begin(), printed.end(), range), none; each != none; ++each) {
      const int first = std::stoi((*each)[1]), last = (*each)[2].matched ? std::stoi((*each)[2]) : first;
      for (int slide = first; slide <= last; ++slide) slides.insert(slide);
    }
  }
  EXPECT_GT(rows, 50);
  EXPECT_EQ(slides.size(), 72U) << "every slide of the thesis";
}

/// A figure or a table does not stand alone.
TEST(ReportText, BeginsEverySectionWithASentence) {
  static const std::regex section("(?:^|\n)(##+ [^\n]*)\n((?:\\s|\\{\\{[#^/][^}]*\\}\\})*)([^\n]*)");
  int sections = 0;
  for (const char* name : {"all", "docket", "oscillators", "real_time", "stability", "tissue"}) {
    const std::string text(report_text(name));
    for (std::sregex_iterator it(text.begin(), text.end(), section), end; it != end; ++it, ++sections) {
      const std::string first = (*it)[3].str();
      for (const char* alone : {"|", "{{figure", "{{table", "**The"})
        EXPECT_FALSE(first.starts_with(alone)) << name << ": " << (*it)[1].str();
    }
  }
  EXPECT_GT(sections, 40);
}

/// Slide 60 is read in one way, that of slide 34: not stable, or a large mass.
TEST(ReportText, OfTissueQuotesTheLargeMassAsItIsPrinted) {
  const std::string_view text = report_text("tissue");
  EXPECT_EQ(text.find("\"not stable\" with"), std::string_view::npos);
  EXPECT_EQ(text.find("but for a"), std::string_view::npos);
  EXPECT_EQ(text.find("the body buckles"), std::string_view::npos);
}

/// The other parts are filled by the tests of the reports; this one is made for --scale alone.
TEST(ReportText, HasAPlaceForEveryCostOfAMesh) {
  const std::string_view text = report_text("tissue");
  const std::vector<ScaleRow> rows{{.mesh = "ball:n=2", .tetrahedra = 48, .peak_memory = 2.5e9}};
  Ordered sizes{{"meshes", rows}, {"force_spread", 1.25}, {"step_spread", 1.5}, {"device", nullptr}};
  const auto filled_with = [&] {
    return filled(text.substr(text.find("{{#sizes}}")), Ordered::object({{"sizes", sizes}}),
                  {{"figure costs_over_size", "the figure"}});
  };
  const std::string part = filled_with();
  EXPECT_NE(part.find("| ball:n=2 | 48 | 0 | 0 | 0 | 0 | 0 | 0 | 0 | 2.50 |\n\nthe figure\n"),
            std::string::npos)
      << part;
  EXPECT_EQ(part.find("device time"), std::string::npos);
  sizes["device"] = {{"device", "card"},
                     {"clock_mhz", 1980.0},
                     {"driver", "driver 1"},
                     {"precision", "double"},
                     {"steps", {{{"mesh", "ball:n=2"}, {"tetrahedra", 48}, {"device_step", 1.25e-5}}}}};
  EXPECT_TRUE(says(filled_with(), "on card, 1980 MHz, driver 1, in double precision"));
  EXPECT_TRUE(says(filled_with(), "| ball:n=2 | 48 | 1.25e-05 |"));
}

}  // namespace
}  // namespace hmax
