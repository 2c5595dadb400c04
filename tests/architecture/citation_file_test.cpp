/// CITATION.cff, the changelog, the recipes of packages and the examples tell the version and the license
/// that the project has.
#include <algorithm>
#include <cctype>
#include <iterator>
#include <regex>
#include <string>

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

std::string project_version() { return captured("CMakeLists.txt", R"(project\(hmax VERSION ([0-9.]+))"); }

TEST(CitationFile, HasTheVersionOfTheProject) {
  EXPECT_FALSE(project_version().empty());
  EXPECT_EQ(captured("CITATION.cff", R"(\nversion: ([0-9.]+)\n)"), project_version());
}

TEST(Changelog, BeginsWithWhatIsUnreleasedAndThenHasTheVersionOfTheProject) {
  EXPECT_EQ(captured("CHANGELOG.md", R"(\n## \[([^\]]+)\])"), "Unreleased");
  EXPECT_EQ(captured("CHANGELOG.md", R"(\n## \[([0-9.]+)\] - [0-9]{4}-[0-9]{2}-[0-9]{2}\n)"),
            project_version());
}

TEST(Changelog, TellsAVersionInAtMost150Lines) {
  const std::string text = read_text(source_dir() / "CHANGELOG.md");
  for (std::size_t at = text.find("\n## [0"); at != std::string::npos;) {
    const std::size_t next = text.find("\n## [", at + 1);
    const std::string version = text.substr(at, next - at);
    EXPECT_LE(std::count(version.begin(), version.end(), '\n'), 150) << version.substr(0, 20);
    at = next;
  }
}

TEST(Examples, AskForTheMinorVersionOfTheProject) {
  // The package is compatible within a minor version (cmake/install.cmake).
  const std::string version = project_version();
  for (const char* file : {"examples/CMakeLists.txt", "tests/consumer/CMakeLists.txt", "docs/library.md"})
    EXPECT_EQ(captured(file, R"(find_package\(hmax ([0-9.]+))"), version.substr(0, version.rfind('.')))
        << file;
}

TEST(Recipes, HaveTheVersionOfTheProjectAndWhatItsBuildAsksFor) {
  const std::string folder = "cmake/recipes/";
  const struct {
    std::string file, version;
  } recipes[] = {{folder + "vcpkg/hmax/vcpkg.json", R"re("version": "([0-9.]+)")re"},
                 {folder + "spack/packages/hmax/package.py", R"re(\n    version\("([0-9.]+)"\))re"},
                 {folder + "conda/recipe.yaml", R"re(\n  version: "([0-9.]+)")re"}};
  const std::string build = read_text(source_dir() / "cmake/dependencies.cmake");
  // GoogleTest, which is asked for within an if, is not part of a package.
  const std::regex required(R"re(\nhmax_require\(([A-Za-z]+))re");
  EXPECT_EQ(std::distance(std::sregex_iterator(build.begin(), build.end(), required), {}), 7);
  for (const auto& [file, version] : recipes) {
    EXPECT_EQ(captured(file, version), project_version()) << file;
    const std::string recipe = read_text(source_dir() / file);
    for (std::sregex_iterator it(build.begin(), build.end(), required), end; it != end; ++it) {
      std::string name = (*it)[1];
      std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
      EXPECT_NE(recipe.find(name), std::string::npos) << file << " lacks " << name;
    }
  }
}

TEST(CitationFile, HasTheLicenseOfTheProject) {
  EXPECT_EQ(captured("CITATION.cff", R"(\nlicense: ([A-Za-z0-9.-]+)\n)"),
            captured("LICENSE", "^([A-Z]+) License"));
}

}  // namespace
}  // namespace hmax::architecture
