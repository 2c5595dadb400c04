#include <cmath>
#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace hmax {
namespace {

const std::string tested = TESTED_PLUGIN;

Told probe(const std::string& arguments) { return Shell().hmax("probe --plugin " + arguments); }

TEST(ProbeCommand, PrintsTheContractedKeys) {
  const Told told = probe(tested + ":chain --h0 1e-3 --h1 0.1 --json");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.err, "");
  const nlohmann::json found = told.json();
  EXPECT_EQ(found["model"], "chain");
  EXPECT_EQ(found["dim"], 20);
  EXPECT_EQ(found["state"], "equilibrium");
  EXPECT_NEAR(found["h_max"].get<double>(), 0.01010, 1e-5);
  EXPECT_NEAR(found["observed"].get<double>(), 0.01010, 5e-5);
  EXPECT_LT(std::abs(found["gap"].get<double>()), 5e-3);
  EXPECT_TRUE(found["status"].is_null()) << found["status"];
  EXPECT_EQ(found["contradiction"], false);
  double before = 0;
  for (const auto& row : found["rows"]) {
    EXPECT_GT(row["h"].get<double>(), before);
    before = row["h"];
    EXPECT_EQ(row["growing"].is_null(), before < found["h_max"].get<double>()) << row;
  }
  EXPECT_LT(found["rows"].back()["growing"]["re"].get<double>(), -1);
}

TEST(ProbeCommand, TellsWhatStepsMakeOfRestAndOfTheSlowestMode) {
  const std::string line = tested + ":softened:k=100 --h0 1e-3 --h1 0.1 --no-runs --stiffness k";
  const nlohmann::json found = probe(line + " --json").json();
  const nlohmann::json& last = found["rows"].back();
  EXPECT_EQ(last["settles"], true);
  // Rest at 10 (2 / k + h^2).
  EXPECT_NEAR(last["settled_moves"].get<double>(), 0.3 / 0.20001 - 1, 1e-5);
  EXPECT_LT(last["modes"][0]["omega_shown"].get<double>(), last["modes"][0]["omega"].get<double>());
  EXPECT_EQ(found["stiffness"]["parameter"], "k");
  EXPECT_EQ(found["stiffness"]["h"], 0.1);
  EXPECT_NEAR(found["stiffness"]["shown"].get<double>(), 100 * 0.2 / 0.3, 0.05);
  EXPECT_NEAR(found["stiffness"]["ceiling"].get<double>(), 200, 0.5);
  const Told told = probe(line);
  EXPECT_TRUE(says(told.out, "h_max     beyond h1\n")) << told.out;
  EXPECT_TRUE(says(told.out, "no growth up to h1 = 0.1 s; there the slowest mode is")) << told.out;
  EXPECT_TRUE(says(told.out, "it settles 50 % away from where steps of h0 do")) << told.out;
  EXPECT_TRUE(says(told.out, "and at most 200 whatever is entered")) << told.out;
}

TEST(ProbeCommand, WhatHasNoLimitIsUnbounded) {
  const nlohmann::json found = probe(tested + ":implicit_euler --h0 0.1 --h1 10 --json").json();
  EXPECT_EQ(found["h_max"], "unbounded");
  EXPECT_EQ(found["observed"], "unbounded");
  EXPECT_TRUE(found["gap"].is_null());
}

TEST(ProbeCommand, RunsThatLeaveTheStateAreNoContradiction) {
  const Told told = probe(tested + ":stiffening --h0 1e-3 --h1 1 --json");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.json()["contradiction"], false);
  EXPECT_TRUE(says(told.json()["status"].get<std::string>(), "runs leave this state, and grow from 0.0"));
}

TEST(ProbeCommand, RefusesWhatDoesNotWork) {
  const std::string steps = " --h0 1e-3 --h1 1";
  expect_refused(probe("none.so" + steps), "there is no file 'none.so'");
  expect_refused(probe(tested), "give the step sizes");
  expect_refused(probe(tested + ":start:nan" + steps), "number 1 of the state at the start is not finite");
  expect_refused(probe(tested + ":crash:segv" + steps), "with signal 11");
  expect_refused(probe(tested + ":crash:hang --patience 0.2" + steps), "did not return within 0.2 s");
  expect_refused(probe(tested + " --timeout 0" + steps), "--timeout 0 is not positive");
  expect_refused(probe(TESTED_PLUGIN_VERSION + steps), "version 99");
  expect_refused(probe(tested + ":chain --time-limit 1e-6" + steps), "more than the limit of 1e-06 s");
  expect_refused(probe(tested + ":softened:k=100 --stiffness E" + steps), "has no E=NUMBER");
  expect_refused(probe(tested + ":softened:k=100 --stiffness k --motion 9" + steps), "remove --motion");
  for (const char* motion : {"-1", "0", "nan", "inf"})
    expect_refused(probe(tested + " --motion " + motion + steps), "is no length of time");
  expect_refused(Shell().hmax("probe a.xml --plugin b.so"), "a scene and --plugin are given");
  expect_refused(Shell().hmax("probe"), "--example FOLDER");
  expect_refused(Shell().hmax("probe --example a --plugin b"), "leave out the scene and --plugin");
}

TEST(ProbeCommand, WhatAPluginSaysIsNoPartOfTheDocument) {
  const Told told = probe(tested + ":crash:talk --h0 1e-3 --h1 0.1 --no-runs --json");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.json()["dim"], 2);
  EXPECT_EQ(told.err.substr(0, 7), "I talk\n");
  // Also what it said before it crashed, line by line, and what has no end of line.
  const Told crashed = probe(tested + ":crash:talk_segv --h0 1e-3 --h1 0.1 --no-runs");
  EXPECT_EQ(crashed.exit_code, 2);
  EXPECT_EQ(crashed.err.substr(0, 7), "I talk\n") << crashed.err;
  EXPECT_TRUE(says(crashed.err, "with signal 11"));
  const Told whispered = probe(tested + ":crash:whisper --h0 1e-3 --h1 0.1 --no-runs");
  EXPECT_TRUE(says(whispered.err, "I whisper"));
}

TEST(ProbeCommand, InterruptedItLeavesNoProcess) {
  const std::string of_this_test = "crash:hang --h0 1e-3 --h1 1.0" + std::to_string(getpid());
  const Told told =
      Shell().line("timeout -s INT 1 '" HMAX_PROGRAM "' probe --plugin " + tested + ":" + of_this_test +
                   "; echo $?; sleep 0.2; pgrep -f '^" HMAX_PROGRAM " probe .*" + of_this_test + "' | wc -l");
  EXPECT_EQ(told.out.substr(told.out.size() - 2), "0\n") << told.out << told.err;
}

/// A pipe at which somebody waits for the end of the command, and what is left of the plugin then.
Told told_by_pipe(const std::string& arguments) {
  const std::string seconds = "61." + std::to_string(getpid());
  return Shell().line("TESTED_SLEEP=" + seconds + " timeout 30 sh -c \"('" HMAX_PROGRAM "' " + arguments +
                      "; echo code \\$?) 2>&1 | cat\"; echo ended with $?; sleep 0.1; pgrep -fc '^sleep " +
                      seconds + "$'");
}

TEST(ProbeCommand, ProcessesOfAPluginEndWithIt) {
  for (const std::string way : {"child", "daemon", "copy"}) {
    const Told told =
        told_by_pipe("probe --plugin " + tested + ":unruly:" + way + " --h0 1e-2 --h1 1 --no-runs");
    EXPECT_TRUE(says(told.out, "h_max     0.2")) << way;
    EXPECT_TRUE(says(told.out, "code 0\nended with 0\n0\n")) << way;
  }
  const Told told = told_by_pipe("run --plugin " + tested + ":faulty:child:5 --method rk4 --h 0.01");
  EXPECT_TRUE(says(told.out, "reached the end"));
  EXPECT_TRUE(says(told.out, "code 0\nended with 0\n0\n"));
}

TEST(ProbeCommand, WhatAPluginPrintsIsBounded) {
  const Told told = probe(tested + ":unruly:prints --h0 1e-2 --h1 1 --no-runs --json");
  ASSERT_EQ(told.exit_code, 0) << told.err.substr(0, 1000);
  EXPECT_LT(told.err.size(), 101'000U);
  EXPECT_TRUE(says(told.err, "hmax: the plugin wrote more than 100000 characters; the rest is not shown"));
  const Told flood = probe(tested + ":unruly:floods --h0 1e-2 --h1 1");
  EXPECT_EQ(flood.exit_code, 2);
  EXPECT_TRUE(says(
      flood.err, "hmax: the plugin wrote more than 64 MB to standard output and standard error; print less"));
}

TEST(ProbeCommand, AStateOfTenMillionNumbersIsRefused) {
  expect_refused(probe(tested + ":unruly:numbers --h0 1e-2 --h1 1"),
                 "the state has 10000000 numbers, and a probe takes up to 100000");
}

TEST(ProbeCommand, WhatAPluginDoesToItsProcessChangesNothing) {
  for (const std::string way : {"closes", "deaf", "elsewhere", "exit", "abort", "stays"}) {
    const Told told = probe(tested + ":unruly:" + way + " --h0 1e-2 --h1 1 --no-runs --json");
    ASSERT_EQ(told.exit_code, 0) << way << told.err;
    EXPECT_NEAR(told.json()["h_max"].get<double>(), 0.2, 1e-4) << way;
  }
  expect_refused(probe(tested + ":unruly:sleeps --timeout 0.2 --h0 1e-2 --h1 1"),
                 "did not return within 0.2 s in create()");
}

TEST(ProbeCommand, ItsExamplesAreThoseThatTheTestsRun) {
  const Shell shell;
  const Told told = shell.hmax("probe --example a");
  EXPECT_EQ(told.out, "a/hmax/plugin.h\na/plugin_stepper.cpp\na/plugin_model.c\n");
  EXPECT_EQ(read_text(shell / "a/hmax/plugin.h"), read_text(HMAX_SOURCE_DIR "/catalogue/plugin/plugin.h"));
  EXPECT_EQ(read_text(shell / "a/plugin_stepper.cpp"),
            read_text(HMAX_SOURCE_DIR "/examples/plugin_stepper.cpp"));
  EXPECT_EQ(shell.hmax("probe --example a").exit_code, 0);
  shell.line("echo >> a/plugin_model.c");
  expect_refused(shell.hmax("probe --example a"), "is there already and differs");
}

/// Whatever a plugin does, a command ends with a sentence.
TEST(PluginOption, APluginThatGoesWrongIsAnError) {
  const auto run = [](const std::string& argument, const std::string& more = "") {
    return Shell().hmax("run --plugin " + tested + ":faulty" + argument + " --method rk4 --h 0.01" + more);
  };
  EXPECT_EQ(run("").exit_code, 0);
  expect_refused(run(":hang:100", " --patience 0.3"),
                 "did not return within 0.3 s in rhs(); --timeout gives it longer");
  expect_refused(run(":segv:100"), "crashed in rhs() with signal 11");
  expect_refused(run("", " --timeout 0"), "--timeout 0 is not positive; give seconds");
  EXPECT_EQ(run(":nan:100").exit_code, 1);
  expect_refused(Shell().hmax("run --problem kepler --timeout 3 --method rk4 --h 0.01"),
                 "--timeout applies to --plugin only");
}

/// A model behind the interface stands where any model stands.
TEST(PluginOption, IsAModelForEveryCommand) {
  const Shell shell;
  const std::string model = std::string(" --plugin ") + EXAMPLE_MODEL;
  const Told run = shell.hmax("run" + model + " --method rk4 --h 0.01 --t-end 1 --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.json().at("outcome"), "reached_end");
  const Told limit = shell.hmax("stability predict" + model + " --methods symplectic_euler --json");
  ASSERT_EQ(limit.exit_code, 0) << limit.err;
  EXPECT_GT(limit.json().at("rows").at(0).at("h_max").get<double>(), 0);
  expect_refused(shell.hmax("run" + model + " --set a=1 --method rk4 --h 0.1"),
                 "a plugin has no parameter 'a'");
  expect_refused(shell.hmax("run" + model + " --y0 1 --method rk4 --h 0.1"),
                 "the initial state has 1 numbers");
  expect_refused(shell.hmax("run" + model + " --mesh liver --method rk4 --h 0.1"),
                 "--mesh and --plugin are both given");
  expect_refused(shell.hmax("run --plugin " + tested + ":chain --method rk4 --h 0.1"),
                 "is a stepper and no model");
}

}  // namespace
}  // namespace hmax
