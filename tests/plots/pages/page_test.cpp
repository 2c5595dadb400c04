#include "plots/pages/page.hpp"

#include <gtest/gtest.h>

#include "results/errors.hpp"

namespace hmax {
namespace {

TEST(Page, HoldsItsPicturesInItself) {
  // Of RFC 4648, section 10.
  const std::pair<std::string, std::string> known[] = {
      {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [svg, encoded] : known) {
    const std::string page = page_text("t", "", {{.title = "s", .pictures = {{.svg = svg}}}});
    EXPECT_NE(page.find("base64," + encoded + "\""), std::string::npos) << svg;
  }
}

TEST(Page, TextIsNeverMarkup) {
  const std::string evil = "<b> & \"q\"";
  const std::string page = page_text(evil, evil,
                                     {{.title = evil,
                                       .lead = evil,
                                       .text = evil,
                                       .facts = {{evil, evil}, {"", evil}},
                                       .list = {evil},
                                       .pictures = {{.svg = "x", .caption = evil}, {.caption = evil}},
                                       .table = {{evil}, {evil}}}});
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  EXPECT_NE(page.find("alt=\"&lt;b&gt; &amp; &quot;q&quot;\""), std::string::npos);
}

TEST(Page, HasOnlyCharacters) {
  const std::string page = page_text("a\xff\x01z", "", {});
  EXPECT_NE(page.find("<h1>a? z</h1>"), std::string::npos) << page;
}

TEST(Page, HasFactsAndLists) {
  const std::string page = page_text("t", "",
                                     {{.title = "s",
                                       .lead = "take it",
                                       .facts = {{"error", "1 %"}, {"long runs", "one"}, {"", "another"}},
                                       .list = {"x", "y"}}});
  EXPECT_NE(page.find("<p><strong>take it</strong></p>"), std::string::npos);
  EXPECT_NE(page.find("<tr><th scope=\"row\">error</th><td>1 %</td></tr>"), std::string::npos);
  EXPECT_NE(page.find("<tr><td></td><td>another</td></tr>"), std::string::npos);
  EXPECT_NE(page.find("<ul>\n<li>x</li>\n<li>y</li>\n</ul>"), std::string::npos);
  EXPECT_EQ(page.find("<img"), std::string::npos);
}

TEST(Page, ColumnsWithoutADigitAreWords) {
  const std::string page = page_text(
      "t", "", {{.title = "s", .table = {{"a", "b", "c"}, {"x", "1 %", "yes"}, {"y", "-", "no"}}}});
  EXPECT_NE(page.find("<th scope=\"col\">b</th><th scope=\"col\" class=\"words\">c</th>"), std::string::npos) << page;
  EXPECT_NE(page.find("<td>-</td><td class=\"words\">no</td>"), std::string::npos) << page;
}

TEST(Page, HasMoreWordsForThoseWhoCannotSeeAPicture) {
  const std::string page =
      page_text("t", "", {{.title = "s", .pictures = {{.svg = "x", .caption = "short", .alt = "at length"}}}});
  EXPECT_NE(page.find("<img alt=\"at length\" "), std::string::npos);
  EXPECT_NE(page.find("<figcaption>short</figcaption>"), std::string::npos);
}

TEST(Page, SaysWhyAPictureIsMissing) {
  const std::string page =
      page_text("t", "", {{.title = "s", .pictures = {{.caption = "a region", .problem = "no gnuplot"}}}});
  EXPECT_NE(page.find("a region: not drawn. no gnuplot"), std::string::npos);
  EXPECT_THROW(write_page("/dev/null/folder/index.html", page), InputError);
}

}  // namespace
}  // namespace hmax
