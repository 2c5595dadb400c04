#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/architecture/functions.hpp"
#include "tests/architecture/include_arrows.hpp"
#include "tests/architecture/source_tree.hpp"
#include "tests/says.hpp"

namespace hmax::architecture {
namespace {

/// Headers directly in `folder` that its README does not name in code marks: `name`, `name.hpp`, `name.*` or
/// `name*`.
std::vector<std::string> unnamed_headers(const std::string& folder, const std::string& readme) {
  std::vector<std::string> unnamed;
  for (const std::string& file : files_under(folder, {".hpp"})) {
    const std::filesystem::path path = file;
    if (path.parent_path() != folder) continue;
    const std::string name = "`" + path.stem().string();
    bool named = false;
    for (const char end : {'`', '.', '*'}) named = named || readme.find(name + end) != std::string::npos;
    if (!named) unnamed.push_back(file);
  }
  return unnamed;
}

TEST(Folders, EachHasAReadmeOfAtMostOneScreen) {
  for (const auto& [folder, targets] : allowed_arrows) {
    const std::string text = read_text(source_dir() / folder / "README.md");
    EXPECT_FALSE(text.empty()) << folder << " has no README.md.";
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 60)
        << folder << "/README.md is longer than a screen.";
  }
}

/// Every folder with headers in it, outside the tests.
std::set<std::string> folders_of_headers() {
  std::set<std::string> folders;
  for (const auto& [folder, targets] : allowed_arrows)
    if (folder != "tests")
      for (const std::string& file : files_under(folder, {".hpp"}))
        folders.insert(file.substr(0, file.rfind('/')));
  return folders;
}

TEST(Folders, EachHeaderIsNamedInTheReadmeOfItsFolder) {
  EXPECT_GT(folders_of_headers().size(), 20U);
  for (const std::string& folder : folders_of_headers()) {
    const std::string readme = read_text(source_dir() / folder / "README.md");
    EXPECT_FALSE(readme.empty()) << folder << " has no README.md.";
    EXPECT_LE(std::count(readme.begin(), readme.end(), '\n'), 60)
        << folder << "/README.md is longer than a screen.";
    for (const std::string& file : unnamed_headers(folder, readme))
      ADD_FAILURE() << file << " is not named in " << folder << "/README.md.";
  }
}

/// Sources that the first column of a table of a README names, `name.hpp` or `name.*`, and that are not
/// there.
std::vector<std::string> lost_sources(const std::string& folder, const std::string& readme) {
  static const std::regex row("\\| ([^|]*) \\|"), name("`([a-z_0-9/]+)\\.(hpp|cpp|\\*)`");
  std::vector<std::string> lost;
  std::istringstream lines(readme);
  for (std::string line; std::getline(lines, line);) {
    std::smatch first;
    if (!std::regex_search(line, first, row, std::regex_constants::match_continuous)) continue;
    const std::string cell = first[1];
    for (std::sregex_iterator it(cell.begin(), cell.end(), name), end; it != end; ++it) {
      const std::string stem = folder + "/" + (*it)[1].str();
      const auto is_there = [&](const char* ending) {
        return std::filesystem::exists(source_dir() / (stem + ending));
      };
      if (!is_there(".hpp") && !is_there(".cpp")) lost.push_back(stem);
    }
  }
  return lost;
}

TEST(Folders, ReadmesNameWhatIsThere) {
  for (const std::string& folder : folders_of_headers()) {
    for (const std::string& source : lost_sources(folder, read_text(source_dir() / folder / "README.md")))
      ADD_FAILURE() << folder << "/README.md names " << source << ", which is not there.";
    const std::size_t slash = folder.rfind('/');
    if (slash == std::string::npos) continue;
    const std::string parent = folder.substr(0, slash);
    EXPECT_TRUE(says(read_text(source_dir() / parent / "README.md"), folder.substr(slash + 1) + "/"))
        << parent << "/README.md does not name its folder " << folder << ".";
  }
  EXPECT_EQ(lost_sources("plots", "| `draw.*`, `sketch.hpp` | `paper.hpp` |"),
            std::vector<std::string>{"plots/sketch"});
}

TEST(Folders, NoneHasMoreThanThirtyEntries) {
  for (const std::string& folder : folders_of_headers()) {
    const auto entries = std::distance(std::filesystem::directory_iterator(source_dir() / folder), {});
    EXPECT_LE(entries, 30) << folder << " asks for a room of its own for some of its files.";
  }
}

TEST(Folders, AHeaderThatItsReadmeDoesNotNameIsFound) {
  // A word in prose does not count.
  const std::string readme = "order: `basins_of_rows.hpp`, `phase_plane.*`";
  const auto unnamed = unnamed_headers("analysis/dynamics", readme);
  EXPECT_EQ(std::count(unnamed.begin(), unnamed.end(), "analysis/dynamics/basins.hpp"), 1);
  EXPECT_EQ(std::count(unnamed.begin(), unnamed.end(), "analysis/dynamics/phase_plane.hpp"), 0);
}

TEST(Folders, NoSourceFileIsLongerThanSevenHundredLines) {
  for (const auto& [folder, targets] : allowed_arrows)
    for (const std::string& file : files_under(folder, {".hpp", ".cpp"})) {
      const std::string text = read_text(source_dir() / file);
      EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 700) << file;
    }
}

/// The most lines of a function of a file.
int longest_function(const std::string& file) {
  // One loop drives all steppers, and the compiler has to see it in one piece.
  return file == "integrators/integrate.hpp" ? 70 : 60;
}

TEST(Functions, NoneIsLongerThanSixtyLines) {
  std::size_t seen = 0;
  for (const auto& [folder, targets] : allowed_arrows)
    for (const std::string& file : files_under(folder, {".hpp", ".cpp"}))
      for (const FunctionLines& function : functions_of(read_text(source_dir() / file))) {
        ++seen;
        EXPECT_LE(function.lines, longest_function(file))
            << file << ":" << function.line << ": " << function.head
            << "\nGive its steps functions of their own.";
      }
  EXPECT_GT(seen, 3000U);
}

TEST(Functions, ALongOneIsFound) {
  const auto body = [&](int lines) {
    std::string text;
    for (int i = 0; i < lines; ++i) text += "  ++n;\n";
    return text;
  };
  const std::string before = "#pragma once\nnamespace a {\nint n = 0;\nstruct B {\n" + body(99) +
                             "};\n\nconst int table[] = {1,\n" + body(99) +
                             "};\nvoid declared(int,\n  int);\n"
                             "int f() { return n; }\n";
  const auto found = functions_of(before + "void g() {\n" + body(58) +
                                  "}\n\ntemplate <class T>\nT B::h(T a,\n"
                                  "       T b) {\n  if (a) {\n" +
                                  body(55) + "  }\n}\n\n}  // namespace a\n");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].head, "void g() {");
  EXPECT_EQ(found[0].lines, 60);
  EXPECT_EQ(found[1].head, "template <class T>");
  EXPECT_EQ(found[1].lines, 61);
}

}  // namespace
}  // namespace hmax::architecture
