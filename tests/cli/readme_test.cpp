/// The README's commands are run, and what it shows of them is what they print.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
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

std::vector<Shown> console_blocks(const std::string& text) {
  std::vector<Shown> shown;
  std::istringstream lines(text);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("```", 0) == 0)
      inside = line == "```console";
    else if (inside && line.rfind("$ ", 0) == 0)
      shown.push_back({line.substr(2), ""});
    else if (inside && !shown.empty())
      shown.back().output += line + "\n";
  }
  return shown;
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

TEST(Readme, EveryCommandPrintsWhatIsShown) {
  const auto shown = console_blocks(read_text(std::filesystem::path(HMAX_SOURCE_DIR) / "README.md"));
  ASSERT_GE(shown.size(), 3U);
  const Shell shell;
  for (const auto& [command, output] : shown) {
    SCOPED_TRACE(command);
    const Told told = shell.line(command);
    EXPECT_EQ(told.err, "");
    // A sweep is a measurement: which method is fastest depends on the machine.
    const bool measures = command.rfind("hmax sweep", 0) == 0;
    EXPECT_TRUE(measures ? alike(first_line(told.out), first_line(output)) : alike(told.out, output))
        << told.out;
  }
}

TEST(Readme, AWrongOutputWouldBeNoticed) {
  const auto shown = console_blocks("```console\n$ hmax --version\nhmax 99\n```\n");
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_FALSE(alike(Shell().line(shown[0].command).out, shown[0].output));
  EXPECT_FALSE(alike("x 1.00001", "x 1"));
  EXPECT_TRUE(alike("cpu 1 s", "cpu 2 s"));
}

}  // namespace
}  // namespace hmax
