#include "plots/pages/page.hpp"

#include <gtest/gtest.h>

#include "core/errors.hpp"

namespace hmax {
namespace {

TEST(Page, HoldsItsPicturesInItself) {
  // Of RFC 4648, section 10.
  const std::pair<std::string, std::string> known[] = {
      {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [png, encoded] : known)
    EXPECT_EQ(embedded_png(png, "\"a\""),
              "<img alt=\"&quot;a&quot;\" src=\"data:image/png;base64," + encoded + "\">");
  const std::string page =
      page_text("t", "", {{.title = "s", .pictures = {{.svg = "<svg fill='#fff'>\n5 % & \"q\"</svg>"}}}});
  EXPECT_NE(page.find("src='data:image/svg+xml,<svg fill=&#39;%23fff&#39;> 5 %25 &amp; \"q\"</svg>'"),
            std::string::npos)
      << page;
  EXPECT_NE(embedded_svg("<svg a='' b='' c=\"\"/>", "")
                .find("src=\"data:image/svg+xml,<svg a='' b='' c=&quot;&quot;/>\""),
            std::string::npos);
}

TEST(Page, HasNavigationThemesAndTablesThatSort) {
  const std::vector<PageSection> sections{{.title = "a & b", .table = {{"x"}, {"1"}, {"2"}}}, {.title = "c"}};
  const std::string page = page_text("t", "", sections);
  EXPECT_NE(page.find("<a href=\"#s0\">a &amp; b</a>\n<a href=\"#s1\">c</a>"), std::string::npos) << page;
  EXPECT_NE(page.find(sections_html(sections)), std::string::npos);
  EXPECT_NE(page.find("<h2 id=\"s0\">a &amp; b</h2>"), std::string::npos);
  EXPECT_NE(
      page.find(
          "aria-label=\"a &amp; b\"><table>\n<thead>\n<tr><th scope=\"col\">x</th></tr>\n</thead>\n<tbody>\n<tr><td>1<"),
      std::string::npos);
  for (const char* part : {"prefers-color-scheme:dark", "id=\"theme\"", "aria-sort", "@media print"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
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
  const std::string page =
      page_text("t", "", {{.title = "s", .table = {{"a", "b", "c"}, {"x", "1 %", "yes"}, {"y", "-", "no"}}}});
  EXPECT_NE(page.find("<th scope=\"col\">b</th><th scope=\"col\" class=\"words\">c</th>"), std::string::npos)
      << page;
  EXPECT_NE(page.find("<td>-</td><td class=\"words\">no</td>"), std::string::npos) << page;
}

TEST(Page, HasMoreWordsForThoseWhoCannotSeeAPicture) {
  const std::string page = page_text(
      "t", "", {{.title = "s", .pictures = {{.svg = "x", .caption = "short", .alt = "at length"}}}});
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
