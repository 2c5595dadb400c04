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
  EXPECT_TRUE(says(told.err, "'a\\x1b[31mb\\xc2\\x9bc'"));
}

TEST(LastResort, ControlSequencesOfNamesInFilesAreShownOnStandardOutput) {
  const Shell shell;
  write_text(
      shell / "esc.toml",
      "[problem]\nname = \"\\u001b]0;pwn\\u0007\\u001b[31mred\\u009b\\u202e\"\nt_end = 1\n[equations]\n"
      "x = \"-x\"\n[initial]\nx = 1\n");
  ASSERT_EQ(shell.hmax("mesh make cube:n=1 --output c.msh").exit_code, 0);
  const std::string named = "\"$(printf 'a\\033[31mb.msh')\"";
  ASSERT_EQ(shell.line("mv c.msh " + named).exit_code, 0);
  for (const std::string& command : std::vector<std::string>{
           "run --problem esc.toml --method rk4 --h 0.1",
           "stability predict --problem esc.toml --methods rk4", "order --problem esc.toml --method rk4",
           "mesh info " + named, "mesh check " + named,
           "sweep --problem esc.toml --methods rk4 --h 0.1 --fixed --explore --out s.sqlite",
           "export s.sqlite", "precision --problem esc.toml --methods rk4 --h 0.1,0.05 --budget 0.01"}) {
    const Told told = shell.hmax(command);
    EXPECT_LE(told.exit_code, 1) << command << told.err;
    for (const std::string control : {"\033", "\007", "\302\233", "\342\200\256"})
      EXPECT_FALSE(says((told.out + told.err), control)) << command;
  }
  EXPECT_TRUE(
      says(shell.hmax("run --problem esc.toml --method rk4 --h 0.1").out, "\\x1b]0;pwn\\x07\\x1b[31mred"));
  // JSON has its own escapes.
  const Told told = shell.hmax("run --problem esc.toml --method rk4 --h 0.1 --json");
  EXPECT_FALSE(says(told.json().dump(), "\\\\x1b")) << told.out;
}

TEST(LastResort, AFileThatNeedsMoreMemoryThanThereIsIsNamed) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer reserves more memory than the limit of this test";
#endif
  const Shell shell;
  for (const std::string name :
       {"b.msh", "b.vtk", "b.vtu", "b.node", "b.ele", "b.mesh", "b.veg", "b.mtx", "b.sti", "b.csv"})
    ASSERT_EQ(shell.line("truncate -s 20G " + name).exit_code, 0);
  const auto refused = [&](const std::string& command, const std::string& file) {
    SCOPED_TRACE(command);
    expect_refused(shell.line("ulimit -v 1000000; hmax " + command),
                   "'" + file + "' of 21.5 GB needs more memory");
  };
  for (const std::string extension : {"msh", "vtk", "vtu", "node", "mesh", "veg"})
    refused("mesh info b." + extension, "b." + extension);
  for (const std::string extension : {"mtx", "sti"})
    refused("stability predict --methods rk4 --matrices stiffness=b." + extension + ",mass=b." + extension,
            "b." + extension);
  refused("advise --mesh cube:n=2 --rate 100 --motion b.csv --methods rk4", "b.csv");
  // Of these no more is read than tells what they are.
  for (const std::string command : {"run --method rk4 --h 1 --problem b.toml", "sweep b.toml",
                                    "export b.sqlite", "report b.sqlite --output r.html",
                                    "run --problem liver_cubic --method rk4 --h 0.1 --checkpoint b.ckpt"}) {
    ASSERT_EQ(shell.line("truncate -s 20G b.toml b.sqlite b.ckpt").exit_code, 0);
    expect_refused(shell.line("ulimit -v 1000000; hmax " + command), "b.");
  }
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
  EXPECT_EQ(shell.json("mesh info " + name)["mesh"], "n\uFFFD.msh");
}

TEST(LastResort, AMissingPlaceForTemporaryFilesIsAnInputError) {
  expect_refused(Shell().line("TMPDIR=/nonexistent '" HMAX_PROGRAM
                              "' precision --problem liver_cubic --methods rk4 --h 0.1"),
                 "set TMPDIR");
}

}  // namespace
}  // namespace hmax
