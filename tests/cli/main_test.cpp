#include <filesystem>
#include <set>
#include <sstream>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

TEST(Program, SaysWhatToDoNextWithoutArguments) {
  const Told told = Shell().hmax("");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_TRUE(says(told.out, "hmax --help"));
  EXPECT_EQ(told.err, "");
}

TEST(Program, PrintsItsVersion) {
  const std::string told = Shell().text("--version");
  EXPECT_EQ(told.rfind("hmax 0.", 0), 0U) << told;
}

TEST(Program, SuggestsTheNearestNameForAMistypedOne) {
  const Shell shell;
  expect_refused(shell.hmax("lits"), "did you mean 'list'?");
  expect_refused(shell.hmax("list --jsno methods"), "did you mean '--json'?");
  expect_refused(shell.hmax("list method"), "did you mean 'methods'?");
  expect_refused(shell.hmax("quux"), "unknown command 'quux'");
}

TEST(Program, RefusesMissingAndSurplusArguments) {
  const Shell shell;
  expect_refused(shell.hmax("list"), "for instance `hmax list methods`");
  expect_refused(shell.hmax("list methods problems"), "unexpected argument 'problems'");
  expect_refused(shell.hmax("sweep --jobs 1 --jobs 2"), "--jobs is given 2 times; give it once");
  expect_refused(shell.hmax("run --problem liver_forced --h 1 --method rk4 --h 2"), "--h is given 2 times");
  expect_refused(shell.hmax("run --problem liver_forced --method rk4 --h"), "--h has no value; give it one");
}

TEST(Program, ReportsAFullDiskAndIgnoresAReaderThatLeft) {
  const Shell shell;
  const Told full = shell.hmax("list methods >/dev/full");
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_TRUE(says(full.err, "cannot write to standard output"));
  const Told closed = shell.line("{ sleep 0.1; hmax list methods --json; echo $? >&2; } | true");
  EXPECT_EQ(closed.err, "0\n");
}

/// The command lines below "Example" in the help of a command.
std::vector<std::string> examples_of(const std::string& help) {
  std::vector<std::string> examples;
  for (std::size_t at = help.find("\n  hmax "); at != std::string::npos;
       at = help.find("\n  hmax ", at + 1)) {
    const std::size_t begin = at + std::string("\n  hmax ").size();
    examples.push_back(help.substr(begin, help.find('\n', begin) - begin));
  }
  return examples;
}

/// The names of the subcommands in the help of the program, those of groups with the group before them.
std::vector<std::string> commands(const Shell& shell, const std::string& group = "") {
  const std::string help = shell.hmax(group + "--help").out;
  const std::size_t begin = help.find("Subcommands:");
  if (begin == std::string::npos) return {};
  std::vector<std::string> names;
  std::istringstream lines(help.substr(begin));
  for (std::string line; std::getline(lines, line) && !line.starts_with("Example");)
    if (line.starts_with("  ") && line[2] != ' ') {
      const std::string name = group + line.substr(2, line.find(' ', 2) - 2);
      const std::vector<std::string> members = commands(shell, name + " ");
      if (members.empty())
        names.push_back(name);
      else
        names.insert(names.end(), members.begin(), members.end());
    }
  return names;
}

TEST(Help, HasAnExampleForEachCommand) {
  const Shell shell;
  const auto names = commands(shell);
  EXPECT_FALSE(names.empty());
  for (const std::string& name : names)
    EXPECT_FALSE(examples_of(shell.hmax(name + " --help").out).empty()) << name;
}

TEST(Help, EveryCommandHasItsOptionListInTheReference) {
  std::string pages;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(HMAX_SOURCE_DIR) /
                                                               "docs/reference/commands"))
    pages += read_text(entry.path());
  // These have no options of their own.
  const std::set<std::string> bare{"doctor", "info"};
  for (const std::string& name : commands(Shell()))
    EXPECT_TRUE(bare.contains(name) || pages.find("<!-- hmax " + name + " --help -->") != std::string::npos)
        << name;
}

TEST(Help, ExamplesRun) {
  // These take minutes, need a store or a plugin made before, or are not of this test.
  const std::set<std::string> elsewhere{"sweep", "reproduce", "export", "compare", "merge", "probe"};
  const auto group_of = [](const std::string& name) { return name.substr(0, name.find(' ')); };
  const Shell shell;
  // What the examples of report name.
  ASSERT_EQ(shell.hmax("sweep --problem liver_forced --methods rk4 --h 0.1 --t-end 1 --out study").exit_code,
            0);
  ASSERT_EQ(
      shell.hmax("stability predict --problem liver_forced --methods rk4 --out limits.sqlite").exit_code, 0);
  for (const std::string& name : commands(shell)) {
    if (elsewhere.contains(group_of(name))) continue;
    for (const std::string& example : examples_of(shell.hmax(name + " --help").out)) {
      shell.text(example);
    }
  }
}

}  // namespace
}  // namespace hmax
