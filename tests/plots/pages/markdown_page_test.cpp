#include "plots/pages/markdown_page.hpp"

#include <gtest/gtest.h>

#include "core/own_files.hpp"
#include "plots/pages/embedded.hpp"
#include "plots/pages/markdown_text.hpp"
#include "tests/plots/text_search.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

namespace fs = std::filesystem;

/// An SVG of about `size` bytes that is hard to make smaller.
std::string large_svg(std::size_t size) {
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"M0 0";
  for (unsigned k = 1; svg.size() < size; ++k) svg += "l" + std::to_string(k * 2654435761U % 100000) + " 0";
  return svg + "\"/></svg>";
}

TEST(MarkdownPage, HasTitleNavigationAndIds) {
  const std::string page = markdown_page(
      "<!-- written by hmax -->\n\n# The *title*\n\nFirst words.\n\n## Figure 1: `x''` & more\n\ntext\n\n## Same\n\n## Same\n",
      ".");
  EXPECT_TRUE(contains(page, "<h1>The title</h1>"));
  EXPECT_EQ(page.find("<h1"), page.rfind("<h1"));
  EXPECT_TRUE(contains(page, "<h2 id=\"figure-1-x--more\">Figure 1: <code>x''</code> &amp; more</h2>"))
      << page;
  EXPECT_TRUE(contains(page, "<a href=\"#figure-1-x--more\">Figure 1: x'' &amp; more</a>"));
  EXPECT_TRUE(contains(page, "<h2 id=\"same\">") && contains(page, "<h2 id=\"same-1\">"));
  EXPECT_LT(page.find("First words."), page.find("<nav")) << "the introduction is above the navigation";
  EXPECT_LT(page.find(own_mark), 2048U);
  EXPECT_TRUE(contains(page, "<a href=\"README.md\">"));
  EXPECT_EQ(heading_anchor("Table 2: k_1, 5 N/m²"), "table-2-k_1-5-nm²");
}

TEST(MarkdownPage, HasThemesSortedTablesAndPrint) {
  const std::string page = markdown_page("# t\n\n## a & b\n\n## c\n", ".");
  EXPECT_TRUE(contains(page, "<a href=\"#a--b\">a &amp; b</a>\n<a href=\"#c\">c</a>")) << page;
  for (const char* part : {"prefers-color-scheme:dark", "id=\"theme\"", "aria-sort", "@media print"})
    EXPECT_TRUE(contains(page, part)) << part;
}

TEST(MarkdownParts, AreWhatAPageShowsOfText) {
  const MarkdownParts parts = markdown_parts("# t\n\n## A <b>\n\n- **x**: 1\n\n" +
                                             markdown_facts({{"error", "1 %"}}) + "![p](p.svg)\n");
  EXPECT_EQ(parts.title, "t");
  ASSERT_EQ(parts.links.size(), 1U);
  EXPECT_EQ(parts.links[0].target, "#a-b");
  EXPECT_TRUE(contains(parts.html, "<li><strong>x</strong>: 1</li>")) << parts.html;
  EXPECT_TRUE(contains(parts.html, "<div class=\"facts\">\n<table>")) << parts.html;
  EXPECT_TRUE(contains(parts.html, "<td>error</td>\n<td>1 %</td>")) << parts.html;
  EXPECT_FALSE(contains(parts.html, "<b>"));
}

TEST(EmbeddedPictures, StandInTheirElement) {
  // Of RFC 4648, section 10.
  const std::pair<std::string, std::string> known[] = {
      {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [png, encoded] : known)
    EXPECT_EQ(embedded_png(png, "\"a\""),
              "<img alt=\"&quot;a&quot;\" src=\"data:image/png;base64," + encoded + "\">");
  EXPECT_EQ(embedded_svg("<svg fill='#fff'>\n5 % & \"q\"</svg>", ""),
            "<img alt=\"\" src='data:image/svg+xml,<svg fill=&#39;%23fff&#39;> 5 %25 &amp; \"q\"</svg>'>");
  EXPECT_EQ(embedded_svg("<svg a='' b='' c=\"\"/>", ""),
            "<img alt=\"\" src=\"data:image/svg+xml,<svg a='' b='' c=&quot;&quot;/>\">");
}

TEST(MarkdownPage, HasTablesInBoxesWithTheirAlignment) {
  const std::string page = markdown_page("# t\n\n## s\n\n| a | b |\n| --- | ---: |\n| x | 1 |\n", ".");
  EXPECT_TRUE(contains(page, "aria-label=\"s\">\n<table>")) << page;
  EXPECT_TRUE(contains(page, "<td align=\"right\">1</td>"));
  EXPECT_TRUE(contains(page, "</table>\n</div>"));
}

TEST(MarkdownPage, TextIsNeverMarkup) {
  const std::string page = markdown_page(
      "# t <b>\n\n## <i>h</i>\n\n<script>alert(1)</script>\n\n1 &lt; 2 &amp; <b onclick=\"x\">c</b> [l](javascript:alert(1)) "
      "![<u>](gone.svg)\n",
      ".");
  for (const char* markup : {"<b>", "<b ", "<i>", "<u>", "<script>alert", "javascript:"})
    EXPECT_FALSE(contains(page, markup)) << markup;
  EXPECT_TRUE(contains(page, "1 &lt; 2 &amp; &lt;b onclick"));
  EXPECT_TRUE(contains(page, "&lt;script&gt;alert(1)"));
  EXPECT_TRUE(contains(page, "<a href=\"gone.svg\">&lt;u&gt;</a>"))
      << "a picture that is not there is a link";
}

TEST(MarkdownPage, EmbedsPicturesAsSvg) {
  const Scratch folder;
  write_text(folder / "a.svg", "<svg id=\"a\"/>");
  write_text(folder / "a.png", "png");
  write_text(folder / "b.png", "png");
  const std::string page = markdown_page(
      "# t\n\n[![seen](a.png)](a.svg)\n\n![other](b.png)\n\nin ![x](a.svg) text\n", folder.folder());
  EXPECT_TRUE(contains(
      page,
      "<figure><a href=\"a.svg\"><img alt=\"seen\" src='data:image/svg+xml,<svg id=\"a\"/>'></a></figure>"))
      << page;
  EXPECT_TRUE(contains(page, "<figure><a href=\"b.png\"><img alt=\"other\" src=\"data:image/png;base64,"));
  EXPECT_TRUE(contains(page, "<p>in <a href=\"a.svg\"><img"));
  EXPECT_FALSE(contains(page, "because it would be larger"));
}

TEST(MarkdownPage, MakesTheLargestPicturesSmaller) {
  const Scratch folder;
  for (const char* name : {"a", "b", "c"})
    write_text(folder / (std::string(name) + ".svg"), large_svg(300'000));
  write_text(folder / "a.png", std::string(3000, 'p'));
  write_text(folder / "small.svg", "<svg id=\"small\"/>");
  const std::string text = "# t\n\n![a](a.svg)\n\n![b](b.svg)\n\n![c](c.svg)\n\n![small](small.svg)\n";
  EXPECT_GT(markdown_page(text, folder.folder()).size(), 900'000U);
  for (const std::size_t most : {800'000U, 50'000U}) {
    const std::string page = markdown_page(text, folder.folder(), most);
    EXPECT_LE(page.size(), most);
    EXPECT_TRUE(contains(page, "The page shows 1 figure as PNG")) << most;
    EXPECT_TRUE(contains(page, "<svg id=\"small\"/>")) << most;
  }
  const std::string linked = markdown_page(text, folder.folder(), 50'000);
  EXPECT_TRUE(
      contains(linked, "1 figure as PNG and 2 figures as a link, because it would be larger than 5 MB."));
  EXPECT_TRUE(contains(linked, "<figure><a href=\"b.svg\">b</a></figure>"));
}

TEST(MarkdownPage, LeadsToThePagesOfOtherReports) {
  const Scratch folder;
  for (const char* part : {"made", "other"}) fs::create_directory(folder / part);
  write_text(folder / "made/index.html", "");
  const std::string page =
      markdown_page("# t\n\n[a](made/README.md#x) [b](other/README.md#y) [c](README.md)\n", folder.folder());
  EXPECT_TRUE(contains(page, "<a href=\"made/index.html#x\">")) << page;
  EXPECT_TRUE(contains(page, "<a href=\"other/README.md#y\">"));
}

/// Nodes of a heading are copied, and those of a picture go with it.
TEST(MarkdownPage, LeavesPicturesInHeadingsAndInOtherPictures) {
  const Scratch folder;
  write_text(folder / "a.svg", "<svg xmlns='http://www.w3.org/2000/svg' width='3' height='2'/>");
  for (const char* text : {"## ![a](a.svg)\n", "# ![a](a.svg)\n\n![a](a.svg)\n", "![a ![b](a.svg)](a.svg)\n",
                           "[![a](a.svg)](javascript:alert(1))\n"}) {
    const std::string page = markdown_page(text, folder.folder());
    EXPECT_NE(page.find("</html>"), std::string::npos) << text;
    EXPECT_EQ(page.find("javascript:"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace hmax
