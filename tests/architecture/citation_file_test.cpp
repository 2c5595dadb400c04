/// CITATION.cff tells the version and the license that the project has.
#include <regex>

#include <gtest/gtest.h>

#include "tests/architecture/source_tree.hpp"

namespace hmax::architecture {
namespace {

/// The first capture of `pattern` in a file, or nothing.
std::string captured(const std::string& file, const std::string& pattern) {
  const std::string text = read_text(source_dir() / file);
  std::smatch match;
  return std::regex_search(text, match, std::regex(pattern)) ? match[1].str() : "";
}

TEST(CitationFile, HasTheVersionOfTheProject) {
  const std::string version = captured("CMakeLists.txt", R"(project\(hmax VERSION ([0-9.]+))");
  EXPECT_FALSE(version.empty());
  EXPECT_EQ(captured("CITATION.cff", R"(\nversion: ([0-9.]+)\n)"), version);
}

TEST(CitationFile, HasTheLicenseOfTheProject) {
  EXPECT_EQ(captured("CITATION.cff", R"(\nlicense: ([A-Za-z0-9.-]+)\n)"),
            captured("LICENSE", "^([A-Z]+) License"));
}

}  // namespace
}  // namespace hmax::architecture
