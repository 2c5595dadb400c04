#include "bench/timing/run_checkpoint.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

struct RunCheckpointFile : testing::Test {
  Scratch folder;
  std::filesystem::path file = folder / "run.checkpoint";
  Problem problem = make_problem("liver_forced");
  Method method = find_method("dormand_prince_54");
  RunSpec spec{.t_end = 5, .adaptive = true, .rtol = 1e-6, .atol = 1e-6};

  /// One process: stopped after so many steps, or at the end.
  CountedRun process(std::int64_t steps, std::vector<double>& times, std::string fact = "dormand_prince_54") {
    std::int64_t left = steps;
    RunCheckpoint checkpoint(
        {.file = file, .every = 0, .facts = {{"the method", std::move(fact)}}, .stop = [&] {
           return left-- == 1;
         }});
    const Sink sink = [&](double t, const auto&) { times.push_back(t); };
    return checkpoint.run("run", method.bind(problem), spec, kept_output(sink, times));
  }
  std::string refusal() {
    return error_of<InputError>([&] {
      std::vector<double> times;
      process(0, times);
    });
  }
};

TEST_F(RunCheckpointFile, GivesTheAnswerOfARunThatWasNeverStopped) {
  std::vector<double> times, unstopped;
  const RunRecord record =
      method.bind(problem).run(spec, [&](double t, const auto&) { unstopped.push_back(t); });
  for (int stops = 0; stops < 3; ++stops) {
    times.clear();
    EXPECT_THROW(process(4, times), InterruptedRun);
  }
  times.clear();
  const CountedRun resumed = process(0, times);
  EXPECT_EQ(resumed.record.y, record.y);
  EXPECT_EQ(resumed.record.stats, record.stats);
  EXPECT_EQ(times, unstopped);
  // What is finished is told again, with what was recorded.
  times.clear();
  const CountedRun told = process(1, times);
  EXPECT_EQ(told.record.y, record.y);
  EXPECT_EQ(told.record.outcome, Outcome::reached_end);
  EXPECT_EQ(times, unstopped);
  EXPECT_EQ(told.cpu_seconds, resumed.cpu_seconds);
}

TEST_F(RunCheckpointFile, KeepsTheReasonOfARunThatFailed) {
  method = find_method("implicit_euler");
  problem = make_problem("van_der_pol");
  spec = {.t_end = 2000, .h = 500, .max_steps = 1000};
  spec.newton.iterations = 1;
  std::vector<double> times;
  const RunRecord record = method.bind(problem).run(spec, {});
  ASSERT_EQ(record.outcome, Outcome::newton_failed);
  ASSERT_NE(record.note, "");
  process(0, times);
  RunCheckpoint again({.file = file, .facts = {{"the method", "dormand_prince_54"}}});
  EXPECT_EQ(again.run("run", method.bind(problem), spec).record.note, record.note);
}

TEST_F(RunCheckpointFile, RefusesDamageAtEveryByteAndLength) {
  std::vector<double> times;
  EXPECT_THROW(process(6, times), InterruptedRun);
  const std::string whole = read_text(file);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    write_text(file, damaged);
    EXPECT_NE(refusal(), "") << "byte " << at;
    write_text(file, whole.substr(0, at));
    EXPECT_NE(refusal(), "") << "cut at " << at;
  }
  write_text(file, whole);
  EXPECT_EQ(refusal(), "");
}

TEST_F(RunCheckpointFile, SaysWhatDiffersAndWhatToDo) {
  std::vector<double> times;
  EXPECT_THROW(process(6, times), InterruptedRun);
  const std::string error = error_of<InputError>([&] { process(0, times, "rk4"); });
  EXPECT_TRUE(says(error, "the method is dormand_prince_54 in the checkpoint and rk4 in this run"));
  EXPECT_TRUE(says(error, "name another file"));
  write_text(file, "x,y\n1,2\n");
  EXPECT_TRUE(says(refusal(), "is not a checkpoint of hmax"));
  std::filesystem::remove(file);
  std::filesystem::create_directory(file);
  EXPECT_TRUE(says(refusal(), "is no regular file"));
}

TEST_F(RunCheckpointFile, GoesOnWhereItCannotBeSaved) {
  std::vector<std::string> remarks;
  std::filesystem::create_directory(folder / "place");
  RunCheckpoint checkpoint({.file = folder / "place" / "run.checkpoint",
                            .every = 0,
                            .remark = [&](const std::string& text) { remarks.push_back(text); }});
  std::filesystem::remove_all(folder / "place");
  const CountedRun run = checkpoint.run("run", method.bind(problem), spec);
  EXPECT_EQ(run.record.outcome, Outcome::reached_end);
  ASSERT_EQ(remarks.size(), 2U);  // once on the way, and at the end
  EXPECT_TRUE(says(remarks[0], "cannot be written"));
}

TEST_F(RunCheckpointFile, IsLockedWhileARunHasIt) {
  const RunCheckpoint first({.file = file, .facts = {{"the method", "dormand_prince_54"}}});
  EXPECT_TRUE(says(refusal(), "is in use by another run; wait until that ends, or name another file"));
}

TEST_F(RunCheckpointFile, RemovesThePartsThatAKilledProcessHasLeft) {
  // Of this file: names of twelve letters and digits of base 32 (RFC 4648). All others are not of hmax, or of
  // another file.
  write_text(folder / "run.checkpoint.abcdefghij27.part", "left");
  const std::vector<std::string> others{
      "run.checkpoint.notes.part", "run.checkpoint.ABCDEFGHIJKL.part",  "run.checkpoint2.abcdefghijkl.part",
      "other.abcdefghijkl.part",   "run.checkpoint.abcdefghijkl.parts", "run.checkpoint.abcdefghijk1.part"};
  for (const std::string& name : others) write_text(folder / name, "mine");
  EXPECT_EQ(refusal(), "");
  EXPECT_FALSE(std::filesystem::exists(folder / "run.checkpoint.abcdefghij27.part"));
  for (const std::string& name : others) EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
}

}  // namespace
}  // namespace hmax
