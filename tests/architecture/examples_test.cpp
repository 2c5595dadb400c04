/// The README and docs/library.md quote examples word for word, so that what they show is what the tests run.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/architecture/source_tree.hpp"
#include "tests/says.hpp"

namespace hmax::architecture {
namespace {

void expect_quoted(const std::string& page, const std::string& example) {
  const std::string text = read_text(source_dir() / page), program = read_text(source_dir() / example);
  ASSERT_FALSE(program.empty());
  EXPECT_TRUE(says(text, "```cpp\n" + program + "```\n"))
      << page << " does not quote " << example << " as it is";
}

TEST(Examples, PagesQuoteWholePrograms) {
  expect_quoted("README.md", "examples/own_struct.cpp");
  expect_quoted("docs/library.md", "examples/own_limit.cpp");
}

TEST(Examples, NoneNeedsWhatIsNotMeantForUsers) {
  for (const std::string& file : files_under("examples", {".cpp"}))
    EXPECT_FALSE(says(read_text(source_dir() / file), "detail::")) << file;
}

TEST(Examples, EachHasOneScreen) {
  for (const std::string& file : files_under("examples", {".cpp"})) {
    const std::string program = read_text(source_dir() / file);
    EXPECT_LE(std::ranges::count(program, '\n'), 50) << file;
  }
}

TEST(Examples, EachIsNamedInTheirReadme) {
  const std::string readme = read_text(source_dir() / "examples/README.md");
  for (const std::string& file : files_under("examples", {".cpp"}))
    EXPECT_TRUE(says(readme, file.substr(file.rfind('/') + 1))) << file;
}

}  // namespace
}  // namespace hmax::architecture
