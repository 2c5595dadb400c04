/// What is told when standard error, memory, names or the place for temporary files are not as they should
/// be.
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

TEST(LastResort, AnErrorThatCannotBeShownKeepsItsExitCode) {
  const Shell shell;
  for (const char* lost : {"2>/dev/full", "2>&-"})
    EXPECT_EQ(shell.line(std::string("hmax run --problem nope ") + lost).exit_code, 2) << lost;
  EXPECT_EQ(shell.line("hmax list methods >&-").exit_code, 2);
}

TEST(LastResort, AStoreDoesNotGetTheNumberOfAClosedStream) {
  const Shell shell;
  ASSERT_EQ(
      shell.line("hmax sweep --problem liver_forced --methods rk4 --h 0.6 --fixed --out s.sqlite <&- 2>&-")
          .exit_code,
      0);
  EXPECT_EQ(shell.hmax("export s.sqlite").exit_code, 0);
}

TEST(LastResort, ControlSequencesOfArgumentsAreShown) {
  const Told told = Shell().line("hmax run --problem \"$(printf 'a\\033[31mb\\302\\233c')\"");
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_NE(told.err.find("'a\\x1b[31mb\\xc2\\x9bc'"), std::string::npos) << told.err;
}

TEST(LastResort, AnOptionIsNoValue) {
  const Shell shell;
  expect_refused(shell.hmax("sweep --out --json"), "--out is followed by the option --json");
  for (const char* empty : {"--out ''", "--out="})
    expect_refused(shell.hmax(std::string("sweep ") + empty),
                   "--out has an empty value; give it one, or leave it out");
  expect_refused(shell.hmax("stability predict --problem --methods=rk4"),
                 "--problem is followed by the option");
  EXPECT_FALSE(std::filesystem::exists(shell / "results"));
}

TEST(LastResort, NamesThatAreNoUtf8AreNames) {
  const Shell shell;
  const std::string name = "n\xff.msh";
  ASSERT_EQ(shell.hmax("mesh make cube:n=2 --output " + name).exit_code, 0);
  const Told told = shell.hmax("mesh info " + name + " --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.json()["mesh"], "n\uFFFD.msh");
}

TEST(LastResort, AMissingPlaceForTemporaryFilesIsAnInputError) {
  expect_refused(Shell().line("TMPDIR=/nonexistent '" HMAX_PROGRAM
                              "' precision --problem liver_cubic --methods rk4 --h 0.1"),
                 "set TMPDIR");
}

}  // namespace
}  // namespace hmax
