/// The scripts that every page has, in a browser. Skipped without chromium.
#include <map>

#include <gtest/gtest.h>

#include "plots/pages/markdown_page.hpp"
#include "plots/pages/markdown_text.hpp"
#include "tests/plots/pages/browser.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

TEST(PageInABrowser, SortsTablesShowsFiguresAndFitsAPhone) {
  const std::string program = browser();
  if (program.empty())
    GTEST_SKIP() << "chromium is not installed, so the page is not driven; apt-get install chromium";
  const Scratch folder;
  write_text(
      folder / "a.svg",
      "<svg xmlns='http://www.w3.org/2000/svg' width='30' height='20'><path d=\"M0 0h9\" stroke='#f00'/></svg>");
  const std::string text =
      "# t\n\n## numbers\n\n" + markdown_facts({{"one", "1"}, {"two", "2"}}) + "![5 % of \"it\"](a.svg)\n\n" +
      markdown_rows({{"name", "count", "time",
                      "size of a very long heading that no phone has room for, and more of it"},
                     {"b10", "1,151", "2.5e-3", "9 ms"},
                     {"b9", "\u2013", "\u22121", "2 s"},
                     {"a", "unbounded", "it grows", "10 ms"},
                     {"b1", "299", "0.01", "4 ms"}});
  const std::map<std::string, std::string> expected{{"name up", "a b1 b9 b10"},
                                                    {"count up", "299 1,151 unbounded \u2013"},
                                                    {"count down", "unbounded 1,151 299 \u2013"},
                                                    {"direction told", "none descending none none"},
                                                    {"as written", "1,151 \u2013 unbounded 299"},
                                                    {"time up", "\u22121 2.5e-3 0.01 it grows"},
                                                    {"units", "2 s 4 ms 9 ms 10 ms"},
                                                    {"buttons", "4"},
                                                    {"theme changes", "true"},
                                                    {"pictures", "30x20"},
                                                    {"wider than a phone", "nothing"},
                                                    {"errors", "none"}};
  EXPECT_EQ(findings_on(markdown_page(text, folder.folder()), "page_actions.js", program), expected);
}

}  // namespace
}  // namespace hmax
