/// --jobs changes no byte of what a command prints.
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

/// x'' = x - 0.8 x^3 - 0.4 x' in formulas, which have one workspace for each thread.
constexpr const char* formulas = R"(
[problem]
t_end = 30
[equations]
x = "v"
v = "-c*v - k*x - 0.8*x^3"
[parameters]
c = 0.4
k = -1
[initial]
x = 0.5
v = 1
)";

class Jobs : public testing::TestWithParam<const char*> {};

TEST_P(Jobs, ChangeNoByte) {
  const Shell shell;
  write_text(shell / "mine.toml", formulas);
  const std::string command = GetParam();
  const Told one = shell.hmax(command + " --json --jobs 1");
  ASSERT_EQ(one.exit_code, 0) << one.err;
  ASSERT_GT(one.out.size(), 100U);
  for (const char* count : {"2", "5"})
    EXPECT_EQ(shell.hmax(command + " --json --jobs " + count).out, one.out);
}

INSTANTIATE_TEST_SUITE_P(
    Commands, Jobs,
    testing::Values(
        "check --methods rk4,sdirk_4", "phase --problem liver_cubic --set k1=-1 --basins --cells 30",
        "phase --problem mine.toml --basins --cells 20",
        "phase --problem liver_forced --bifurcation P --from 5 --to 8 --points 5 --set c=0.05 --set k1=0 --set k3=1 "
        "--set m=1 --set w=1 --periods 20 --skip 20",
        "stability map --problem liver_linear --method rk4,newmark,abm_pece_3,odeint_rosenbrock4 --x c=0:10:4 --y "
        "k1=0.1:10:3",
        "stability map --problem mine.toml --method rk4 --x c=0.1:4:5 --y k=-1:2:4",
        "stability map --mesh cube --method rk4,newmark --x nu=0.1:0.4:2 --y g=0:3:2",
        "stability modes --mesh liver --model mass_spring --set damper=1 --fastest",
        "stability region --method rk4,abm_pece_2,bdf_3 --cells 60"));

/// Every command that starts threads says on how many, and takes no other number than one that it can start.
TEST(JobsOption, IsOnEveryCommandThatStartsThreads) {
  const Shell shell;
  for (const std::string command :
       {"advise", "check", "phase", "reproduce all", "reproduce oscillators", "reproduce stability", "reproduce tissue",
        "stability gallery", "stability map", "stability matrices", "stability modes", "stability predict",
        "stability region", "sweep --explore"})
    for (const char* wrong : {"0", "-1", "1.5", "many", "1025"}) {
      const Told told = shell.hmax(command + " --jobs " + wrong);
      EXPECT_EQ(told.exit_code, 2) << command;
      EXPECT_NE(told.err.find("--jobs is "), std::string::npos) << command << "\n" << told.err;
      EXPECT_EQ(told.err.find('\n'), told.err.size() - 1) << told.err;
    }
}

TEST(JobsOfGallery, ChangeNoPicture) {
  const Shell shell;
  for (const std::string jobs : {"1", "3"})
    ASSERT_EQ(shell
                  .hmax("stability gallery --methods rk4,rk2_heun,imex_ark_324 --output " + jobs +
                        " --jobs " + jobs)
                  .exit_code,
              0);
  EXPECT_EQ(shell.line("diff -r 1 3").out, "");
}

}  // namespace
}  // namespace hmax
