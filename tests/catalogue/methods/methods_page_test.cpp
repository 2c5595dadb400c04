/// docs/reference/methods.md against the catalogue: the same methods and problems.
#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/families.hpp"
#include "catalogue/models/problems.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

/// What stands between backquotes in the rows of the first table behind a heading.
std::set<std::string> quoted_in_table(const std::string& heading) {
  const std::string page = read_text(std::filesystem::path(HMAX_SOURCE_DIR) / "docs/reference/methods.md");
  const std::size_t from = page.find("| ---", page.find("\n## " + heading + "\n"));
  const std::string table = page.substr(from, page.find("\n\n", from) - from);
  const std::regex quoted("`([^`]+)`");
  std::set<std::string> words;
  for (std::sregex_iterator it(table.begin(), table.end(), quoted), end; it != end; ++it)
    words.insert((*it)[1]);
  EXPECT_GT(words.size(), 10U) << heading;
  return words;
}

/// "adams_bashforth_K" for adams_bashforth_3, "cvode_*" for methods of a library.
std::string pattern_of(const Method& method) {
  if (method.is_foreign()) return std::string(family_of(method)->library.prefix) + "*";
  return std::regex_replace(method.id, std::regex("_[0-9]+$"), "_K");
}

TEST(MethodsPage, NamesEveryMethodAndNoOther) {
  const std::set<std::string> named = quoted_in_table("Methods");
  std::set<std::string> known;
  for (const Family& family : all_families)  // of libraries that this build may lack
    if (!family.library.name.empty()) known.insert(std::string(family.library.prefix) + "*");
  for (const Method& method : methods()) {
    EXPECT_TRUE(named.contains(method.id) || named.contains(pattern_of(method))) << method.id;
    known.insert({method.id, pattern_of(method)});
    for (const std::string& alias : method.aliases) {
      EXPECT_TRUE(named.contains(alias)) << alias;
      known.insert(alias);
    }
  }
  for (const std::string& name : named) EXPECT_TRUE(known.contains(name)) << name << " is no method";
}

TEST(MethodsPage, NamesEveryProblemAndNoOther) {
  const std::set<std::string> named = quoted_in_table("Problems");
  const std::vector<std::string> known = problem_ids();
  for (const std::string& id : known) EXPECT_TRUE(named.contains(id)) << id;
  for (const std::string& name : named)
    EXPECT_TRUE(name == "MODEL@MESH" || std::ranges::find(known, name) != known.end()) << name;
}

}  // namespace
}  // namespace hmax
