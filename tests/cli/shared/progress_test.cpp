/// The line of progress of a long task, seen from a terminal.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <pty.h>
#include <regex>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

/// A run of 5e8 steps, or another long command, whose standard error is a terminal, and whose standard output
/// is a file.
class LongRun {
 public:
  explicit LongRun(const std::vector<const char*>& words = {"run", "--problem", "liver_forced", "--method",
                                                            "rk4", "--h", "2e-7", "--t-end", "100",
                                                            "--max-steps", "1e9"}) {
    std::vector<char*> arguments{const_cast<char*>("hmax")};
    for (const char* word : words) arguments.push_back(const_cast<char*>(word));
    arguments.push_back(nullptr);
    const std::string out = (folder_ / "out").string();
    child_ = forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (child_ != 0) return;
    setenv("TERM", "xterm", 1);
    dup2(open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    execv(HMAX_PROGRAM, arguments.data());
    _exit(127);
  }
  ~LongRun() {
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
    close(terminal_);
  }
  LongRun(const LongRun&) = delete;
  LongRun& operator=(const LongRun&) = delete;

  /// What stands on the terminal once `pattern` does, after a minute at most.
  std::string screen_with(const std::regex& pattern) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!std::regex_search(screen_, pattern) && std::chrono::steady_clock::now() < give_up) {
      fd_set ready;
      FD_ZERO(&ready);
      FD_SET(terminal_, &ready);
      timeval patience{.tv_sec = 1, .tv_usec = 0};
      if (select(terminal_ + 1, &ready, nullptr, nullptr, &patience) <= 0) continue;
      char text[512];
      const ssize_t length = read(terminal_, text, sizeof text);
      if (length <= 0) break;
      screen_.append(text, static_cast<std::size_t>(length));
    }
    return screen_;
  }

  /// Ctrl-C as typed; the exit code.
  int interrupted() {
    EXPECT_EQ(write(terminal_, "\x03", 1), 1);
    screen_with(std::regex("interrupted"));
    int status = 0;
    waitpid(child_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  [[nodiscard]] std::string results() const { return read_text(folder_ / "out"); }

 private:
  Scratch folder_;
  int terminal_ = -1;
  pid_t child_ = -1;
  std::string screen_;
};

TEST(Progress, SaysHowFarALongRunIsAndHowLongItTakesAndWipesItselfOut) {
  LongRun run;
  // Each line is drawn over the one before, so the second shows that it was.
  const std::string line = "\r\x1b\\[Krun: [0-9]+ %, [0-9.]+ (s|min|h) to go";
  const std::string screen = run.screen_with(std::regex(line + line));
  EXPECT_TRUE(std::regex_search(screen, std::regex("^" + line + line))) << screen;
  EXPECT_EQ(run.interrupted(), 130);
  const std::string end = run.screen_with(std::regex("interrupted"));
  EXPECT_TRUE(says(end, "\r\x1b[Khmax: interrupted\r\n"));
  EXPECT_EQ(run.results(), "");
}

TEST(Progress, OfALongPredictionSaysWhatItLooksAlongAndHowToGoWithout) {
  LongRun run({"stability", "predict", "--mesh", "liver:refine=1", "--load", "tool", "--methods", "rk4"});
  const std::string screen = run.screen_with(std::regex("go(es)? without"));
  EXPECT_TRUE(says(screen, "finding the motion to t = 1 s; --along none goes without"));
}

TEST(Progress, SaysWhichMethodIsVerifiedAndForHowLong) {
  LongRun run(
      {"stability", "predict", "--mesh", "liver:refine=1", "--set", "g=0", "--methods", "rk4", "--verify"});
  const std::regex line("predict: [0-9]+ %.*verifying rk4, [0-9]+ s");
  const std::string screen = run.screen_with(line);
  EXPECT_TRUE(std::regex_search(screen, line)) << screen;
}

TEST(Progress, IsForTerminalsAlone) {
  const Shell shell;
  const Told told =
      shell.line("timeout --foreground -s INT 2 '" HMAX_PROGRAM
                 "' run --problem liver_forced --method rk4 --h 2e-7 --t-end 100 --max-steps 1e9");
  EXPECT_EQ(told.exit_code, 124) << "`timeout` had to interrupt";
  EXPECT_EQ(told.err, "hmax: interrupted\n");
}

TEST(Progress, EndsOnCtrlCInTheMiddleOfAStep) {
  // A step takes minutes; `timeout` would kill what does not end.
  const Told told =
      Shell().line("timeout --foreground -k 20 -s INT 2 '" HMAX_PROGRAM
                   "' fidelity --mesh phantom --load press --rate 60 --method vbd:iterations=1000000");
  EXPECT_EQ(told.exit_code, 124) << "`timeout` had to interrupt";
  EXPECT_EQ(told.err, "hmax: interrupted; no method was finished\n");
}

TEST(ExitCode, OfMemoryThatRunsOutIsThatOfAnInternalErrorWithARemedy) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer reserves more memory than the limit of this test";
#endif
  const Shell shell;
  // 9e6 points of three numbers in 120 MB of address space.
  const Told told = shell.line(
      "ulimit -v 120000; hmax run --problem liver_forced --method rk4 --h 1e-4 --t-end 900 "
      "--max-steps 1e9 --output points.csv");
  EXPECT_EQ(told.exit_code, 3);
  EXPECT_EQ(told.out, "");
  EXPECT_EQ(told.err, "hmax: out of memory; take fewer points or a smaller problem\n");
  EXPECT_FALSE(std::filesystem::exists(shell / "points.csv"));
}

TEST(ExitCode, OfMemoryThatRunsOutOnALargeMeshIsTheSame) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer reserves more memory than the limit of this test";
#endif
  for (const char* command : {"run --load press --method newmark --h 0.001 --t-end 0.002",
                              "stability predict --methods rk4,newmark --set E=30000"}) {
    const Told told = Shell().line(std::string("ulimit -v 130000; hmax ") + command + " --mesh ball:n=17");
    EXPECT_EQ(told.exit_code, 3) << command;
    EXPECT_EQ(told.out, "") << command;
    EXPECT_TRUE(says(told.err, "hmax: out of memory; take fewer points or a smaller problem\n"));
  }
}

}  // namespace
}  // namespace hmax
