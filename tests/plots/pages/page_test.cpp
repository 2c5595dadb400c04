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
                                       .text = evil,
                                       .pictures = {{.svg = "x", .caption = evil}, {.caption = evil}},
                                       .table = {{evil}, {evil}}}});
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  EXPECT_NE(page.find("alt=\"&lt;b&gt; &amp; &quot;q&quot;\""), std::string::npos);
}

TEST(Page, SaysWhyAPictureIsMissing) {
  const std::string page =
      page_text("t", "", {{.title = "s", .pictures = {{.caption = "a region", .problem = "no gnuplot"}}}});
  EXPECT_NE(page.find("a region: not drawn. no gnuplot"), std::string::npos);
  EXPECT_THROW(write_page("/dev/null/folder/index.html", page), InputError);
}

}  // namespace
}  // namespace hmax
