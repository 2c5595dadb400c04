#include <gtest/gtest.h>

#include "tests/architecture/include_arrows.hpp"
#include "tests/architecture/source_tree.hpp"

namespace hmax::architecture {
namespace {

TEST(Folders, EachHasAReadmeOfAtMostOneScreen) {
  for (const auto& [folder, targets] : allowed_arrows) {
    const std::string text = read_text(source_dir() / folder / "README.md");
    EXPECT_FALSE(text.empty()) << folder << " has no README.md.";
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 60)
        << folder << "/README.md is longer than a screen.";
  }
}

TEST(Folders, NoSourceFileIsLongerThanSixHundredLines) {
  for (const auto& [folder, targets] : allowed_arrows)
    for (const std::string& file : files_under(folder, {".hpp", ".cpp"})) {
      const std::string text = read_text(source_dir() / file);
      EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 600) << file;
    }
}

}  // namespace
}  // namespace hmax::architecture
