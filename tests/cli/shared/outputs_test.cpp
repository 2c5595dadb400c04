/// Which files outputs may replace.
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

constexpr const char* foreign = "my notes of a year";

TEST(Outputs, AStoreIsNeverReplaced) {
  const Shell shell;
  ASSERT_EQ(shell.hmax("sweep --problem liver_forced --methods rk4 --h 0.6 --fixed --out s.sqlite").exit_code,
            0);
  const std::string before = read_text(shell / "s.sqlite");
  write_text(shell / "other.csv", before);
  for (const char* force : {"", " --force"}) {
    expect_refused(shell.hmax(std::string("export s.sqlite --output s.sqlite") + force),
                   "'s.sqlite' is a store of measurements");
    expect_refused(shell.hmax(std::string("export s.sqlite --output other.csv") + force), "is a store");
  }
  EXPECT_EQ(read_text(shell / "s.sqlite"), before);
}

TEST(Outputs, AnInputIsNeverReplaced) {
  const Shell shell;
  ASSERT_EQ(shell.hmax("mesh make cube:n=2 --output c.msh").exit_code, 0);
  const std::string before = read_text(shell / "c.msh");
  for (const char* force : {"", " --force"})
    expect_refused(shell.hmax(std::string("mesh refine c.msh --output ./c.msh") + force),
                   "is read by this command");
  EXPECT_EQ(read_text(shell / "c.msh"), before);
}

TEST(Outputs, AStyleWithoutAFigureIsRefused) {
  const Shell shell;
  for (const char* command : {"phase --problem liver_cubic", "stability region --method rk4",
                              "static --mesh cube:n=2", "precision --problem liver_forced --methods rk4",
                              "stability map --problem liver_linear --method rk4 --x c=1:2:2 --y k1=1:2:2"})
    expect_refused(shell.hmax(std::string(command) + " --style slide"), "--style is of figures");
  EXPECT_EQ(shell.hmax("phase --problem liver_cubic --style page").exit_code, 0);
}

/// Each command line and the file that it writes; {} stands for a name.
class OutputsTest : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(OutputsTest, OnlyFilesOfHmaxAreReplacedWithoutForce) {
  const auto& [arguments, file] = GetParam();
  const Shell shell;
  ASSERT_EQ(shell.hmax("sweep --problem liver_forced --methods rk4 --h 0.6 --fixed --out s.sqlite").exit_code,
            0);
  std::filesystem::create_directories((shell / file).parent_path());
  write_text(shell / file, foreign);
  expect_refused(shell.hmax(arguments),
                 "is there and was not written by hmax; give another name, or --force");
  EXPECT_EQ(read_text(shell / file), foreign);
  for (const char* force : {" --force", "", ""}) {
    shell.text(std::string(arguments) + force);
    EXPECT_NE(read_text(shell / file), foreign);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Commands, OutputsTest,
    testing::Values(
        std::pair("run --problem liver_forced --method rk4 --h 1 --output a.csv", "a.csv"),
        std::pair("run --mesh cube:n=2 --method rk4 --h 1e-4 --t-end 2e-4 --output f/a.pvd", "f/a.pvd"),
        std::pair("run --mesh cube:n=2 --method rk4 --h 1e-4 --t-end 2e-4 --output f/a.pvd", "f/a_00001.vtu"),
        std::pair("export s.sqlite --output s.csv", "s.csv"),
        std::pair("export s.sqlite --format jsonl --output s.txt", "s.txt"),
        std::pair("export s.sqlite --format gbench --output s.json", "s.json"),
        std::pair("mesh make cube:n=2 --output c.msh", "c.msh"),
        std::pair("mesh make cube:n=2 --output c.vtu", "c.vtu"),
        std::pair("mesh make cube:n=2 --output c.scn", "c.scn"),
        std::pair("mesh info cube:n=2 --picture c.svg", "c.svg"),
        std::pair("stability region --method rk4 --output r.csv", "r.csv"),
        std::pair("stability modes --mesh cube:n=2 --count 2 --output m.vtu", "m.vtu")));

TEST(Outputs, FilesOfAFigureAreKnownByItsScript) {
  const Shell shell;
  const std::string draws = "phase --problem liver_cubic --output p";
  std::filesystem::create_directories(shell / "p");
  for (const char* name : {"p/phase.svg", "p/phase.dat", "p/phase.gp", "p/phase.pdf"}) {
    write_text(shell / name, foreign);
    expect_refused(shell.hmax(draws), std::string(name) + "' is there and was not written by hmax");
    EXPECT_EQ(read_text(shell / name), foreign);
    std::filesystem::remove(shell / name);
  }
  write_text(shell / "p/phase.svg", foreign);
  EXPECT_EQ(shell.hmax(draws + " --force").exit_code, 0);
  EXPECT_EQ(shell.hmax(draws).exit_code, 0);
}

}  // namespace
}  // namespace hmax
