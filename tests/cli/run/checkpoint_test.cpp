#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

using AnyJson = nlohmann::json;

/// A document without what may differ between two runs of the same bits: times, and the name of the
/// checkpoint.
AnyJson comparable(const Told& told) {
  AnyJson document = told.json();
  for (const char* key : {"cpu_seconds", "realtime_factor", "checkpoint"}) document.erase(key);
  return document;
}

constexpr const char* long_run =
    "run --problem liver_forced --method rk4 --h 1e-6 --t-end 40 --json --checkpoint run.checkpoint ";

TEST(Checkpoint, ARunThatIsKilledGoesOnWithTheSameAnswer) {
  const Told whole = Shell().hmax("run --problem liver_forced --method rk4 --h 1e-6 --t-end 40 --json");
  for (const char* signal : {"KILL", "TERM", "INT"}) {
    const Shell shell;
    const std::string command = std::string(long_run) + "--checkpoint-every 0.05";
    // On a machine where it is done before that, what is finished is told again.
    const Told stopped = shell.line(
        fmt::format("'" HMAX_PROGRAM "' {} >first & run=$!; until [ -s run.checkpoint ]; do sleep 0.01; "
                    "kill -0 $run || break; done; kill -s {} $run; wait $run; echo $?; ls",
                    command, signal));
    ASSERT_TRUE(says(stopped.out, "run.checkpoint")) << stopped.err;
    // SIGKILL in the middle of a saving leaves its part, which nobody reads.
    const bool killed = std::string(signal) == "KILL";
    EXPECT_TRUE(killed || stopped.out.find(".part") == std::string::npos) << stopped.out;
    if (!killed && read_text(shell / "first").empty()) {
      EXPECT_TRUE(says(stopped.err, "the same command goes on from run.checkpoint"));
    }
    const Told resumed = shell.hmax(command);
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_TRUE(says(resumed.err, "run.checkpoint"));  // goes on, or was finished
    EXPECT_EQ(comparable(resumed), comparable(whole)) << signal;
  }
}

/// timeout(1) signals the process and its group; the second SIGTERM comes while a step is under way.
TEST(Checkpoint, TwoSignalsAtOnceAreOneWish) {
  for (const std::string signal : {"TERM", "INT"}) {
    const Shell shell;
    const Told stopped = shell.line(
        "'" HMAX_PROGRAM
        "' run --mesh ball:n=9 --set E=50000 --method linearly_implicit_euler --jacobian exact --linear direct "
        "--h 0.01 --t-end 10 --checkpoint saved --checkpoint-every 0 & p=$!; until [ -e saved ]; do sleep 0.01; done; "
        "kill -" +
        signal + " $p; sleep 0.01; kill -" + signal + " $p; wait $p; echo $?");
    EXPECT_EQ(stopped.out, "130\n") << stopped.err;
    EXPECT_TRUE(says(stopped.err, "the same command goes on from saved"));
  }
}

TEST(Checkpoint, ASecondRunOfTheSameFileIsRefused) {
  const Shell shell;
  const std::string command =
      "run --problem liver_forced --method rk4 --h 1e-6 --t-end 900 --checkpoint run.checkpoint --checkpoint-every 0.05";
  const Told told = shell.line(
      "'" HMAX_PROGRAM "' " + command +
      " >first & p=$!; until [ -s run.checkpoint ]; do sleep 0.01; kill -0 $p || exit 1; done; '" HMAX_PROGRAM
      "' " +
      command + "; echo $?; kill -KILL $p; wait $p; ls");
  EXPECT_TRUE(says(told.out, "2\n"));
  EXPECT_TRUE(says(told.err,
                   "hmax: checkpoint run.checkpoint is in use by another run; wait until that ends, or name "
                   "another file\n"));
  // What the killed one has left is no obstacle, and gone afterwards.
  write_text(shell / "run.checkpoint.abcdefghijkl.part", "left");
  const Told resumed =
      shell.line("timeout --foreground -s INT 0.5 '" HMAX_PROGRAM "' " + command + "; echo $?; ls");
  EXPECT_EQ(resumed.out, "124\nfirst\nrun.checkpoint\n") << resumed.err;
}

TEST(Checkpoint, AFinishedRunIsToldAtOnce) {
  const Shell shell;
  const std::string command =
      "run --problem liver_forced --method ode45 --rtol 1e-6 --atol 1e-6 --t-end 20 --output motion.csv --every 0.1 "
      "--checkpoint run.checkpoint --json";
  const Told first = shell.hmax(command);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.json().at("checkpoint"), "run.checkpoint");
  const std::string motion = read_text(shell / "motion.csv");
  std::filesystem::remove(shell / "motion.csv");
  const Told again = shell.hmax(command);
  EXPECT_TRUE(says(again.err, "the run is finished in run.checkpoint"));
  EXPECT_EQ(again.json(), first.json());
  EXPECT_EQ(read_text(shell / "motion.csv"), motion);
  const Told bare = shell.hmax(
      "run --problem liver_forced --method ode45 --rtol 1e-6 --atol 1e-6 --t-end 20 --output bare.csv --every 0.1 --json");
  EXPECT_EQ(bare.json().at("y"), first.json().at("y"));
  EXPECT_EQ(bare.json().at("stats"), first.json().at("stats"));
  EXPECT_EQ(read_text(shell / "bare.csv"), motion);
}

TEST(Checkpoint, OfAnotherRunIsRefused) {
  const Shell shell;
  const std::string run =
      "run --problem liver_forced --method rk4 --h 0.01 --t-end 5 --checkpoint run.checkpoint ";
  ASSERT_EQ(shell.hmax(run).exit_code, 0);
  const auto other = [&](const std::string& arguments, const std::string& named) {
    expect_refused(shell.hmax("run --checkpoint run.checkpoint " + arguments), named);
  };
  other("--problem liver_forced --method rk4 --h 0.02 --t-end 5",
        "--h is 0.01 in the checkpoint and 0.02 in this run");
  other("--problem liver_forced --method rk4 --h 0.01 --t-end 6",
        "--t-end is 5 in the checkpoint and 6 in this run");
  other("--problem liver_cubic --method rk4 --h 0.01 --t-end 5",
        "the problem is liver_forced in the checkpoint");
  other("--problem liver_forced --set c=3 --method rk4 --h 0.01 --t-end 5", "the set of parameters is");
  other("--problem liver_forced --y0 1,1 --method rk4 --h 0.01 --t-end 5",
        "the digest of the model and its start");
  other("--problem liver_forced --method rk2_heun --h 0.01 --t-end 5", "the method is rk4 in the checkpoint");
  other("--problem liver_forced --method rk4 --h 0.01 --t-end 5 --output points.csv", "--output");
}

TEST(Checkpoint, TellsTheTimeOfTheUser) {
  const Shell shell;
  write_text(shell / "own.toml",
             "[problem]\nt0 = 100\nt_end = 140\n[equations]\nx = \"-x\"\n[initial]\nx = 1\n");
  const std::string run = "run --problem own.toml --method rk4 --checkpoint saved --checkpoint-every 0 ";
  const Told stopped =
      shell.line("'" HMAX_PROGRAM "' " + run +
                 "--h 1e-6 & p=$!; until [ -e saved ]; do sleep 0.01; done; kill -TERM $p; wait $p; echo $?");
  EXPECT_EQ(stopped.out, "130\n") << stopped.err;
  EXPECT_TRUE(says(stopped.err, "stopped at t = 1"));
  const Told resumed =
      shell.line("'" HMAX_PROGRAM "' " + run + "--h 1e-6 & p=$!; sleep 0.5; kill -TERM $p; wait $p");
  EXPECT_TRUE(says(resumed.err, "the run goes on at t = 1"));
  std::filesystem::remove(shell / "saved");
  ASSERT_EQ(shell.hmax(run + "--h 0.1").exit_code, 0);
  expect_refused(shell.hmax(run + "--h 0.1 --t-start 101"),
                 "--t-start is 100 in the checkpoint and 101 in this run");
  expect_refused(shell.hmax(run + "--h 0.1 --t-end 150"),
                 "--t-end is 140 in the checkpoint and 150 in this run");
}

TEST(Checkpoint, RefusesWhatItCannotDo) {
  const Shell shell;
  const std::string run = "run --problem liver_forced --method rk4 --h 0.1 ";
  expect_refused(shell.hmax(run + "--checkpoint-every 5"), "add --checkpoint FILE");
  expect_refused(shell.hmax(run + "--checkpoint a --checkpoint-every -1"), "--checkpoint-every is -1");
  expect_refused(shell.hmax(run + "--checkpoint a.csv --output ./a.csv"), "are one file");
  expect_refused(shell.hmax(run + "--checkpoint ."), "is no regular file");
  write_text(shell / "notes.txt", "something of mine\n");
  expect_refused(shell.hmax(run + "--force --checkpoint notes.txt"), "is not a checkpoint of hmax");
  EXPECT_EQ(read_text(shell / "notes.txt"), "something of mine\n");
  const Told foreign =
      shell.hmax("run --problem liver_forced --method cvode_bdf --rtol 1e-6 --atol 1e-6 --checkpoint a");
  if (foreign.err.find("libsundials") == std::string::npos) expect_refused(foreign, "keeps its state inside");
  EXPECT_FALSE(std::filesystem::exists(shell / "a"));
}

TEST(Checkpoint, ABodyGoesOnWithTheMeshesThatItHasWritten) {
  const Shell shell;
  const std::string run =
      "run --mesh phantom --method linearly_implicit_euler --h 0.002 --t-end 0.2 --output body.pvd --every 0.01 ";
  const Told stopped = shell.line("timeout -s TERM 0.7 '" HMAX_PROGRAM "' " + run +
                                  "--checkpoint run.checkpoint --checkpoint-every 0; true");
  const Told resumed = shell.hmax(run + "--checkpoint run.checkpoint --json");
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(resumed.json().at("linear"), "direct");
  const std::string list = read_text(shell / "body.pvd"), last = read_text(shell / "body_00020.vtu");
  const Told whole = shell.hmax(run + "--linear direct --json");
  EXPECT_EQ(comparable(resumed), comparable(whole));
  EXPECT_EQ(read_text(shell / "body.pvd"), list);
  EXPECT_EQ(read_text(shell / "body_00020.vtu"), last);
  std::filesystem::remove(shell / "body_00003.vtu");
  const Told missing = shell.hmax(run + "--checkpoint run.checkpoint --json");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_TRUE(says(missing.err, "body_00003.vtu is missing"));
}

}  // namespace
}  // namespace hmax
