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

TEST(PartFile, ReplacesTheFileBehindALinkAndNotTheLink) {
  const Scratch folder;
  namespace fs = std::filesystem;
  fs::create_directory(folder / "data");
  write_text(folder / "data/real.csv", "old");
  fs::create_symlink("data/near.csv", folder / "link.csv");
  fs::create_symlink("real.csv", folder / "data/near.csv");
  fs::create_symlink(folder / "data/later.csv", folder / "dangling.csv");
  for (const std::string link : {"link.csv", "dangling.csv"}) {
    PartFile part(folder / link);
    part.write("new");
    part.replace();
    EXPECT_TRUE(fs::is_symlink(folder / link));
    EXPECT_EQ(read_text(folder / link), "new");
  }
  EXPECT_EQ(read_text(folder / "data/real.csv"), "new");
  EXPECT_EQ(read_text(folder / "data/later.csv"), "new");
  write_text(folder / "data/real.csv.abcdefghijk7.part", "left");
  remove_left_parts(folder / "link.csv");
  EXPECT_FALSE(fs::exists(folder / "data/real.csv.abcdefghijk7.part"));
}

}  // namespace
}  // namespace hmax
