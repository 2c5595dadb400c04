/// The commands of the README, the tutorial and the how-to pages are run, and print what the pages show.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "results/numbers.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

/// A command of a ```console block and the output shown under it.
struct Shown {
  std::string command, output;
};

/// What a page asks its reader to type: files, as blocks that begin with ```toml NAME, and commands.
struct Page {
  std::vector<std::pair<std::string, std::string>> files;  // name, text
  std::vector<Shown> shown;
};

Page read_page(const std::string& text) {
  Page page;
  std::istringstream lines(text);
  enum { outside, console, file, other } inside = outside;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("```", 0) == 0) {
      const bool begins_file = line.rfind("```toml ", 0) == 0;
      if (inside != outside)
        inside = outside;
      else
        inside = line == "```console" ? console : begins_file ? file : other;
      if (inside == file) page.files.emplace_back(line.substr(8), "");
    } else if (inside == console && line.rfind("$ ", 0) == 0) {
      page.shown.push_back({line.substr(2), ""});
    } else if (inside == console && !page.shown.empty()) {
      page.shown.back().output += line + "\n";
    } else if (inside == file) {
      page.files.back().second += line + "\n";
    }
  }
  return page;
}

/// Words of a text; the time after "cpu" and the real-time "factor" are left out, they differ from run to
/// run.
std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; stream >> word;)
    words.push_back(!words.empty() && (words.back() == "cpu" || words.back() == "factor") ? "TIME" : word);
  return words;
}

/// Equal words; numbers may differ in the digits that another machine's cosine changes.
bool alike(const std::string& told, const std::string& shown) {
  const std::vector<std::string> a = words_of(told), b = words_of(shown);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const std::string& x, const std::string& y) {
    if (x == y) return true;
    const auto left = to_number(x), right = to_number(y);
    return left && right && std::abs(*left - *right) <= 1e-6 * std::abs(*right);
  });
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// Runs the commands of a page in a folder of its own.
/// @return how many there are
std::size_t run_page(const std::filesystem::path& path) {
  SCOPED_TRACE(path.string());
  const Page page = read_page(read_text(path));
  const Shell shell;
  for (const auto& [name, text] : page.files) std::ofstream(shell / name) << text;
  for (const auto& [command, output] : page.shown) {
    SCOPED_TRACE(command);
    const Told told = shell.line(command);
    EXPECT_EQ(told.err, "");
    // A sweep is a measurement: which method is fastest depends on the machine.
    const bool measures = command.rfind("hmax sweep", 0) == 0;
    EXPECT_TRUE(measures ? alike(first_line(told.out), first_line(output)) : alike(told.out, output))
        << told.out;
  }
  return page.shown.size();
}

/// Runs every page of a folder of docs/.
std::size_t run_pages(const std::string& folder) {
  std::size_t commands = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(HMAX_SOURCE_DIR) / "docs" / folder))
    if (entry.path().extension() == ".md") commands += run_page(entry.path());
  return commands;
}

TEST(Readme, EveryCommandPrintsWhatIsShown) {
  EXPECT_GE(run_page(std::filesystem::path(HMAX_SOURCE_DIR) / "README.md"), 1U);
}

TEST(Readme, EveryCommandOfTheTutorialPrintsWhatIsShown) { EXPECT_GE(run_pages("tutorial"), 15U); }

TEST(Readme, EveryCommandOfTheHowToPagesPrintsWhatIsShown) { EXPECT_GE(run_pages("howto"), 10U); }

TEST(Readme, AWrongOutputWouldBeNoticed) {
  const Page page = read_page("```console\n$ hmax --version\nhmax 99\n```\n");
  ASSERT_EQ(page.shown.size(), 1U);
  EXPECT_FALSE(alike(Shell().line(page.shown[0].command).out, page.shown[0].output));
  EXPECT_FALSE(alike("x 1.00001", "x 1"));
  EXPECT_TRUE(alike("cpu 1 s", "cpu 2 s"));
}

TEST(Readme, BlocksThatAreFilesAreReadAsFiles) {
  const Page page =
      read_page("```toml a.toml\n$ b = 1\n```\n```\n$ hmax\n```\n```console\n$ cat a.toml\n$ b = 1\n```\n");
  ASSERT_EQ(page.files.size(), 1U);
  EXPECT_EQ(page.files[0].first, "a.toml");
  EXPECT_EQ(page.files[0].second, "$ b = 1\n");
  ASSERT_EQ(page.shown.size(), 2U);
  EXPECT_EQ(page.shown[0].command, "cat a.toml");
}

}  // namespace
}  // namespace hmax
