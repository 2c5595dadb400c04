/// --jobs changes no byte of what a command prints.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

/// x'' = x - 0.8 x^3 - 0.4 x' in formulas, which several threads evaluate.
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
  const std::string one = shell.text(command + " --json --jobs 1");
  ASSERT_GT(one.size(), 100U);
  for (const char* count : {"2", "5"}) EXPECT_EQ(shell.hmax(command + " --json --jobs " + count).out, one);
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
       {"advise", "check", "mesh convert liver --matrices out", "phase", "reproduce all",
        "reproduce oscillators", "reproduce stability", "reproduce tissue", "run", "stability gallery",
        "stability map", "stability matrices", "stability modes", "stability predict", "stability region",
        "static", "sweep --explore"})
    for (const char* wrong : {"0", "-1", "1.5", "many", "1025"}) {
      const Told told = shell.hmax(command + " --jobs " + wrong);
      EXPECT_EQ(told.exit_code, 2) << command;
      EXPECT_TRUE(says(told.err, "--jobs is ")) << command;
      EXPECT_TRUE(says(told.err,
                       std::string(wrong) == "1025" ? "up to 1024" : "must be a whole number of at least 1"))
          << command;
      EXPECT_EQ(told.err.find('\n'), told.err.size() - 1) << told.err;
    }
}

/// A run and an equilibrium on threads are the same, and tell elapsed times.
TEST(JobsOfRun, ChangeTimesAlone) {
  const Shell shell;
  const std::string body = " --mesh ball:n=8 --model fem_green --set E=50000 --json";
  for (const std::string& command :
       {"run" + body +
            " --method linearly_implicit_euler --h 0.01 --t-end 0.03 --linear direct --jacobian exact --full",
        "static" + body}) {
    const auto answer = [&](const std::string& jobs) {
      const std::string told = shell.text(command + jobs);
      return nlohmann::ordered_json::parse(told);
    };
    auto one = answer(""), two = answer(" --jobs 2");
    EXPECT_EQ(two["threads"], 2);
    if (command.starts_with("run")) {
      EXPECT_GT(two["elapsed_seconds"], 0.0);
      EXPECT_DOUBLE_EQ(two["realtime_factor"], 0.03 / two["elapsed_seconds"].get<double>());
    }
    for (auto* each : {&one, &two})
      for (const char* time :
           {"cpu_seconds", "elapsed_seconds", "realtime_factor", "threads", "seconds", "times"})
        each->erase(time);
    EXPECT_EQ(one.dump(), two.dump()) << command;
  }
}

TEST(JobsOfRun, AreForBodiesAndMatrices) {
  const Shell shell;
  const Told small = shell.hmax("run --problem liver_linear --method rk4 --h 0.01 --jobs 2");
  EXPECT_EQ(small.exit_code, 2);
  EXPECT_EQ(small.err,
            "hmax: --jobs is for bodies and matrices, and liver_linear is neither; leave it out\n");
  const Told converted = shell.hmax("mesh convert liver liver.vtu --jobs 2");
  EXPECT_EQ(converted.exit_code, 2);
  EXPECT_EQ(converted.err, "hmax: --jobs is for --matrices; leave it out\n");
  const Told compared = shell.hmax("static --mesh phantom --load press --compare out --jobs 2");
  EXPECT_EQ(compared.exit_code, 2);
  EXPECT_TRUE(says(compared.err, "compare times of one thread; leave --jobs out"));
}

TEST(SpeedUp, ComparesAnswersAndTimesOfThreads) {
  const Shell shell;
  if (shell.line("python3 --version").exit_code != 0) GTEST_SKIP() << "there is no python3";
  const std::string script = "'" HMAX_SOURCE_DIR "/scripts/speed-up' ";
  const Told told = shell.line(script + "'" HMAX_PROGRAM "' --only bifurcation --repeat 1");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_TRUE(says(told.out, "| | 1 thread | 2 threads | gain on 2 |"));
  EXPECT_TRUE(says(told.out, "| bifurcation | "));
  // A program whose answer is its number of threads.
  write_text(shell / "fake", "#!/bin/sh\nfor last; do :; done\necho \"[$last]\"\n");
  const Told differs = shell.line("chmod +x fake; " + script + "fake --only bifurcation --repeat 1");
  EXPECT_EQ(differs.exit_code, 1);
  EXPECT_EQ(differs.err, "bifurcation: answers differ between numbers of threads\n");
  EXPECT_EQ(shell.line(script + "--only maps").exit_code, 2);
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
