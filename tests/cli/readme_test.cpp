/// The README's commands are run, and what it shows of them is what they print.
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

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

/// Times are what differs from run to run: numbers before a unit of time of the CPU, and the column widths
/// they set.
std::string without_times(const std::string& text) {
  static const std::regex times("[0-9.e+-]+ (s CPU|ms|us|ns|µs)|(cpu|in) [0-9.e+-]+ s");
  static const std::regex blanks("[ \t]+");
  return std::regex_replace(std::regex_replace(text, times, "TIME"), blanks, " ");
}

TEST(Readme, EveryCommandPrintsWhatIsShown) {
  const auto shown = console_blocks(read_text(std::filesystem::path(HMAX_SOURCE_DIR) / "README.md"));
  ASSERT_GE(shown.size(), 3U);
  const Shell shell;
  for (const auto& [command, output] : shown) {
    SCOPED_TRACE(command);
    const Told told = shell.line(command);
    EXPECT_EQ(told.err, "");
    if (output.find("\n...") == std::string::npos)
      EXPECT_EQ(without_times(told.out), without_times(output));
    else  // a measurement: its head is shown, its times are another machine's
      EXPECT_EQ(without_times(told.out.substr(0, told.out.find('\n'))),
                without_times(output.substr(0, output.find('\n'))));
  }
}

TEST(Readme, AWrongOutputWouldBeNoticed) {
  const auto shown = console_blocks("```console\n$ hmax --version\nhmax 99\n```\n");
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_NE(without_times(Shell().line(shown[0].command).out), without_times(shown[0].output));
}

}  // namespace
}  // namespace hmax
