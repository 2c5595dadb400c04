#include <chrono>
#include <string>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

/// Refused before anything is computed, with the estimate.
void expect_endless(const Shell& shell, const std::string& line, const std::string& estimate) {
  const auto start = std::chrono::steady_clock::now();
  const Told told = shell.hmax(line);
  expect_refused(told, estimate);
  EXPECT_TRUE(says(told.err, "more than the limit of"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30)) << line;
}

TEST(WorkLimit, NamesTheEstimateOfWhatCannotEnd) {
  const Shell shell;
  // 2^31 s in periods of 4 pi s.
  expect_endless(shell,
                 "run --problem liver_forced --method ode45 --rtol 1e-6 --atol 1e-9 --t-end 2147483648",
                 "1.71e+08 periods of the load");
  // 2^31 steps of one second.
  expect_endless(shell, "run --problem liver_forced --method rk4 --h 1 --t-end 2147483648", "2.15e+09 steps");
  expect_endless(shell, "phase --problem liver_forced --bifurcation P --from 5 --to 8 --points 2147483648",
                 "values of the parameter");
  expect_endless(shell, "phase --problem liver_forced --bifurcation P --from 0 --to 1e15",
                 "periods of the force, about");
  expect_endless(shell, "phase --problem liver_forced --poincare --periods 2147483648", "2.15e+09 periods");
  expect_endless(shell, "phase --problem liver_forced --poincare --method rk4 --h 1e-9",
                 "periods of the force, about");
  // No library is opened for it.
  expect_endless(shell, "probe --plugin ./none.so --h0 1e-4 --h1 0.1 --motion 2147483648",
                 "2.15e+13 steps, about 6.8 years");
  write_text(shell / "far.csv", "t,fx,fy,fz\n0,0,0,0\n2147483648,1,0,0\n");
  expect_endless(shell, "advise --mesh cube:n=1 --rate 100 --motion far.csv", "2.15e+11 frames");
}

/// What a command need not do is not counted.
TEST(WorkLimit, IsOfWorkThatIsCertain) {
  const Shell shell;
  // 1.6e10 periods of a load that the tolerances do not see.
  const std::string fast =
      "run --problem liver_forced --set w=1e9 --set P=1e-9 --rtol 1e-3 --atol 1e-3 --method ";
  EXPECT_EQ(shell.hmax(fast + "radau_iia_5").exit_code, 0);
  expect_refused(shell.hmax(fast + "ode45"), "a run of 100 s asks for 1.59e+10 periods of the load");
  // 30 periods of about 1257 steps of four stages; 3000 more follow where the motion does not repeat.
  EXPECT_EQ(
      shell
          .hmax(
              "phase --problem liver_forced --poincare --skip 10 --periods 20 --method rk4 --h 0.01 --time-limit "
              "0.02")
          .exit_code,
      0);
}

TEST(WorkLimit, IsRaisedByAnOption) {
  const Shell shell;
  const std::string line = "phase --problem liver_forced --poincare --skip 10 --periods 20 --time-limit ";
  expect_refused(shell.hmax(line + "1e-9"), "raise --time-limit");
  expect_refused(shell.hmax(line + "0"), "--time-limit");
  EXPECT_EQ(shell.hmax(line + "1000").exit_code, 0);
}

}  // namespace
}  // namespace hmax
