/// Pages point to files and headings that exist.
#include "tests/architecture/links.hpp"

#include <gtest/gtest.h>

#include "tests/architecture/include_arrows.hpp"

namespace hmax::architecture {
namespace {

TEST(Links, OfEveryPageLeadToAFileAndAHeading) {
  const auto pages = markdown_pages();
  EXPECT_GT(pages.size(), 40U);
  for (const std::string& page : pages)
    for (const std::string& link : broken_links(page, read_text(source_dir() / page)))
      ADD_FAILURE() << page << " links to " << link << ", which does not exist.";
}

/// Pages of docs/ in the index, docs/README.md, or for commands in docs/reference/cli.md, which it links to.
TEST(Links, EveryPageOfDocsStandsInItsIndex) {
  std::set<std::string> listed{"docs/README.md"};
  for (const std::string& folder : {std::string("docs/"), std::string("docs/reference/")})
    for (const std::string& link :
         relative_links(read_text(source_dir() / folder / (folder == "docs/" ? "README.md" : "cli.md"))))
      listed.insert(folder + link.substr(0, link.find('#')));
  for (const std::string& page : files_under("docs", {".md"}))
    EXPECT_TRUE(listed.contains(page)) << page << " is in neither docs/README.md nor docs/reference/cli.md.";
}

TEST(Links, PagesNamedInTheSourcesExist) {
  std::size_t named = 0;
  for (const auto& [folder, targets] : allowed_arrows)
    for (const std::string& file : files_under(folder, {".hpp", ".cpp", ".md", ".txt"})) {
      if (file.starts_with("tests/architecture/links")) continue;  // plants names that do not exist
      for (const std::string& page : named_pages(read_text(source_dir() / file))) {
        ++named;
        EXPECT_TRUE(std::filesystem::exists(source_dir() / page)) << file << " names " << page;
      }
    }
  EXPECT_GT(named, 5U);
}

TEST(Links, ThatLeadNowhereAreFound) {
  const std::string page =
      "# The page\n## `hmax run`, *twice*\n[good](../README.md) [own](#hmax-run-twice) [site](https://x.org/a)\n"
      "![gone](images/none.svg) [no heading](#nothing) [two\nlines](none.md) `[code](code.md)`\n"
      "```\n[fenced](fenced.md)\n# no heading\n```\n[other](README.md#no-such-heading)\n";
  EXPECT_EQ(
      broken_links("docs/page.md", page),
      (std::vector<std::string>{"#nothing", "README.md#no-such-heading", "images/none.svg", "none.md"}));
  EXPECT_FALSE(anchors_of(page).contains("no-heading"));
}

TEST(Links, HeadingsThatOccurAgainAreCounted) {
  EXPECT_EQ(anchors_of("# A b\n## A b\n### [C](d.md) 1.2\n"),
            (std::set<std::string>{"a-b", "a-b-1", "c-12"}));
}

TEST(Links, PagesAreFoundInComments) {
  EXPECT_EQ(named_pages("// docs/gone.md, see\n\"docs/a/b.md\" ../docs/not.md build/docs/not.md"),
            (std::set<std::string>{"docs/gone.md", "docs/a/b.md"}));
}

}  // namespace
}  // namespace hmax::architecture
