#include "tests/architecture/include_arrows.hpp"

#include <gtest/gtest.h>

#include "tests/architecture/source_tree.hpp"

namespace hmax::architecture {
namespace {

std::vector<Include> includes_of_the_project() {
  std::vector<Include> all;
  for (const auto& [folder, targets] : allowed_arrows)
    for (const std::string& file : files_under(folder, {".hpp", ".cpp", ".in"})) {
      if (file.starts_with("tests/consumer/")) continue;  // a project of its own, outside the house
      const auto found = includes_of(file, read_text(source_dir() / file));
      all.insert(all.end(), found.begin(), found.end());
    }
  return all;
}

TEST(IncludeArrows, EveryIncludeOfTheProjectIsAllowed) {
  const auto all = includes_of_the_project();
  EXPECT_GT(all.size(), 20U);
  for (const Include& include : all)
    if (const auto why = violation(include)) ADD_FAILURE() << *why;
}

/// Arrows between the names that `name_of` gives to files, but for those from a name to itself.
template <class NameOf>
std::map<std::string, std::set<std::string>> arrows_between(const NameOf& name_of) {
  std::map<std::string, std::set<std::string>> arrows;
  for (const Include& include : includes_of_the_project()) {
    if (!include.quoted || include.file.starts_with("tests/")) continue;
    const std::string from = name_of(include.file), to = name_of(include.header);
    if (from != to) arrows[from].insert(to);
  }
  return arrows;
}

TEST(IncludeArrows, NoFilesIncludeEachOtherInACircle) {
  EXPECT_EQ(circle_in(arrows_between(unit_of)), std::vector<std::string>{});
}

TEST(IncludeArrows, NoFoldersIncludeEachOtherInACircle) {
  const auto folder = [](const std::string& file) { return file.substr(0, file.rfind('/')); };
  EXPECT_EQ(circle_in(arrows_between(folder)), std::vector<std::string>{});
}

TEST(IncludeArrows, ACircleIsFound) {
  using Arrows = std::map<std::string, std::set<std::string>>;
  EXPECT_EQ(circle_in(Arrows{{"a", {"b", "c"}}, {"b", {"c"}}}), std::vector<std::string>{});
  EXPECT_EQ(circle_in(Arrows{{"a", {"b"}}, {"b", {"c"}}, {"c", {"b"}}}),
            (std::vector<std::string>{"b", "c", "b"}));
}

TEST(IncludeArrows, OneFileAloneReadsToml) {
  std::set<std::string> readers;
  for (const Include& include : includes_of_the_project())
    if (include.header.starts_with("toml") && !include.file.starts_with("tests/"))
      readers.insert(include.file);
  EXPECT_LE(readers.size(), 1U) << *readers.begin() << " and " << *readers.rbegin()
                                << " both include toml++.";
}

TEST(IncludeArrows, ArrowsThatPointUpOrSidewaysAreRefused) {
  EXPECT_TRUE(violation({"integrators/rk.hpp", "problems/oscillator.hpp", true}));
  EXPECT_TRUE(violation({"problems/oscillator.hpp", "results/store.hpp", true}));
  EXPECT_TRUE(violation({"results/store.cpp", "integrators/system.hpp", true}));
  EXPECT_TRUE(violation({"analysis/order.hpp", "catalogue/methods.hpp", true}));
  EXPECT_TRUE(violation({"plots/figure.cpp", "analysis/region.hpp", true}));
  EXPECT_TRUE(violation({"bench/sweep.cpp", "plots/figure.hpp", true}));
  EXPECT_TRUE(violation({"bench/sweep.cpp", "tests/architecture/source_tree.hpp", true}));
  EXPECT_TRUE(violation({"bench/sweep.cpp", "python/bindings/calls.hpp", true}));
  EXPECT_TRUE(violation({"python/bindings/limits.cpp", "cli/shared/console.hpp", true}));
}

TEST(IncludeArrows, ArrowsThatPointDownAreAllowed) {
  EXPECT_FALSE(violation({"integrators/rk.hpp", "integrators/system.hpp", true}));
  EXPECT_FALSE(violation({"analysis/order.hpp", "results/row.hpp", true}));
  EXPECT_FALSE(violation({"cli/run/run.cpp", "plots/figure.hpp", true}));
  EXPECT_FALSE(violation({"integrators/rk.hpp", "array", false}));
}

TEST(IncludeArrows, IncludesThatAreNotWrittenFromTheRootAreRefused) {
  EXPECT_TRUE(violation({"integrators/rk.hpp", "system.hpp", true}));
  EXPECT_TRUE(violation({"integrators/rk.hpp", "../problems/oscillator.hpp", true}));
  EXPECT_TRUE(violation({"integrators/rk.hpp", "problems/oscillator.hpp", false}));
}

TEST(IncludeArrows, ForeignHeadersOutsideTheirPlaceAreRefused) {
  EXPECT_TRUE(violation({"bench/peers/cvode.cpp", "cvode/cvode.h", false}));
  EXPECT_FALSE(violation({"integrators/sundials/cvode.hpp", "cvode/cvode.h", false}));
  EXPECT_TRUE(violation({"bench/sweep.cpp", "boost/numeric/odeint.hpp", false}));
  EXPECT_FALSE(violation({"bench/timing/formula_reference.cpp", "boost/numeric/odeint.hpp", false}));
  EXPECT_TRUE(violation({"bench/sweep.cpp", "sqlite3.h", false}));
  EXPECT_TRUE(violation({"results/store.hpp", "sqlite3.h", false}));
  EXPECT_TRUE(violation({"results/store.hpp", "results/sqlite/sqlite.hpp", true}));
  EXPECT_TRUE(violation({"bench/sweep.cpp", "results/sqlite/sqlite.hpp", true}));
  EXPECT_FALSE(violation({"results/store.cpp", "results/sqlite/sqlite.hpp", true}));
  EXPECT_TRUE(violation({"bench/config.hpp", "toml++/toml.h", false}));
  EXPECT_TRUE(violation({"bench/sweep.cpp", "CLI/CLI.hpp", false}));
  EXPECT_TRUE(violation({"bench/sweep.cpp", "pybind11/pybind11.h", false}));
}

TEST(IncludeArrows, IncludeLinesAreFoundHoweverTheyAreSpaced) {
  const auto found =
      includes_of("cli/a.cpp", "#include <a>\n  #  include \"b/c.hpp\"\n// #include is a word here\nint x;");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].header, "a");
  EXPECT_FALSE(found[0].quoted);
  EXPECT_EQ(found[1].header, "b/c.hpp");
  EXPECT_TRUE(found[1].quoted);
}

}  // namespace
}  // namespace hmax::architecture
