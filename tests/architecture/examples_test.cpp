/// The README quotes an example word for word, so that what it shows is what the tests run.
#include <gtest/gtest.h>

#include "tests/architecture/source_tree.hpp"

namespace hmax::architecture {
namespace {

TEST(Examples, TheReadmeQuotesAWholeProgram) {
  const std::string readme = read_text(source_dir() / "README.md");
  const std::string program = read_text(source_dir() / "examples/own_struct.cpp");
  ASSERT_FALSE(program.empty());
  EXPECT_NE(readme.find("```cpp\n" + program + "```\n"), std::string::npos)
      << "README.md does not quote examples/own_struct.cpp as it is";
}

TEST(Examples, EachIsNamedInTheirReadme) {
  const std::string readme = read_text(source_dir() / "examples/README.md");
  for (const std::string& file : files_under("examples", {".cpp"}))
    EXPECT_NE(readme.find(file.substr(file.rfind('/') + 1)), std::string::npos) << file;
}

}  // namespace
}  // namespace hmax::architecture
