#include "core/part_file.hpp"

#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

std::set<std::string> names_in(const Scratch& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.folder()))
    names.insert(entry.path().filename().string());
  return names;
}

TEST(PartFile, LeftPartsAreRemovedByTheirWholeNameAlone) {
  const Scratch folder;
  // A part is FILE.RANDOM.part of twelve letters or digits from 2 to 7; the others differ in one thing each.
  const std::string part = "run.csv.abcdefghijk7.part";
  const std::set<std::string> others{"run.csv",
                                     "run.csv_abcdefghijk7.part",
                                     "run.csv.abcdefghijk7.parts",
                                     "run.csv.abcdefghijk7-part",
                                     "run.csv.abcdefghijk7xpart",
                                     "run.csv.abcdefghijk8.part",
                                     "run.csv.abcdefghijK7.part",
                                     "run.csv.abcdefghij7.part",
                                     "fun.csv.abcdefghijk7.part",
                                     "run.csv.part"};
  for (const std::string& name : others) write_text(folder / name, "kept");
  write_text(folder / part, "left");
  remove_left_parts(folder / "run.csv");
  EXPECT_EQ(names_in(folder), others);
}

TEST(PartFile, ThatIsGivenUpLeavesNothingBehind) {
  const Scratch folder;
  const std::filesystem::path file = folder / "run.csv";
  {
    PartFile given_up(file);
    given_up.write("x");
    EXPECT_EQ(names_in(folder).size(), 1U);
  }
  EXPECT_TRUE(names_in(folder).empty());
  PartFile kept(file);
  kept.write("a");
  kept.write("b");
  kept.sync();
  kept.replace();
  EXPECT_EQ(names_in(folder), std::set<std::string>{"run.csv"});
  EXPECT_EQ(std::filesystem::file_size(file), 2U);
}

}  // namespace
}  // namespace hmax
