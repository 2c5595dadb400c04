#include "core/checkpoint_file.hpp"

#include <bit>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <limits>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

struct CheckpointFile : testing::Test {
  const Scratch folder;
  std::filesystem::path file = folder / "run.checkpoint";

  [[nodiscard]] std::string bytes() const { return read_text(file); }
  void put(const std::string& text) const { write_text(file, text); }
  [[nodiscard]] std::string refusal() const {
    return error_of<std::runtime_error>([&] { read_checkpoint(file); });
  }
};

Checkpoint sample() {
  StateBytes state;
  state.put(std::int64_t{123456789012345});
  for (const double value : {-0.0, 0.1, std::numeric_limits<double>::denorm_min()}) state.put(value);
  return {{{"method", "rk4"}, {"h", "0.001"}}, state.bytes()};
}

/// Never returns: an error ends the child by abort, and not in the tests of its parent.
[[noreturn]] void write_without_end(const std::filesystem::path& file) noexcept {
  for (int i = 0;; ++i) write_checkpoint(file, {{{"n", std::to_string(i)}}, std::string(1 << 16, 'b')});
}

TEST_F(CheckpointFile, KeepsEveryBit) {
  write_checkpoint(file, sample());
  const Checkpoint read = read_checkpoint(file);
  EXPECT_EQ(read.facts, sample().facts);
  StateBytes state(read.state);
  EXPECT_EQ(state.take<std::int64_t>(), 123456789012345);
  for (const double value : {-0.0, 0.1, std::numeric_limits<double>::denorm_min()})
    EXPECT_EQ(std::bit_cast<std::uint64_t>(state.take<double>()), std::bit_cast<std::uint64_t>(value));
  EXPECT_TRUE(state.at_end());
  EXPECT_THROW(state.take<double>(), std::runtime_error);
}

TEST_F(CheckpointFile, IsRefusedWhereAnyByteIsDamagedOrMissing) {
  write_checkpoint(file, sample());
  const std::string whole = bytes();
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x20);
    put(damaged);
    EXPECT_NE(refusal(), "") << "byte " << at;
    put(whole.substr(0, at));
    EXPECT_NE(refusal(), "") << "cut at " << at;
  }
  put(whole + "x");
  EXPECT_TRUE(says(refusal(), "damaged"));
  std::filesystem::remove(file);
  EXPECT_TRUE(says(refusal(), "cannot be read"));
}

TEST_F(CheckpointFile, NamesWhatDiffersFirst) {
  const std::vector<RunFact> run{{"method", "rk4"}, {"h", "0.001"}};
  EXPECT_EQ(first_difference(run, run), std::nullopt);
  EXPECT_EQ(first_difference(run, {{"method", "newmark"}, {"h", "0.002"}}),
            "method is rk4 in the checkpoint and newmark in this run");
  EXPECT_EQ(first_difference(run, {{"method", "rk4"}}),
            "h is 0.001 in the checkpoint and not given in this run");
  EXPECT_EQ(first_difference({{"h", "0.001"}}, run),
            "method is rk4 in this run and not given in the checkpoint");
}

TEST_F(CheckpointFile, IsTheOldOrTheNewOneAfterAKill) {
  write_checkpoint(file, {{{"n", "0"}}, std::string(1 << 16, 'a')});
  for (int kill_after = 0; kill_after < 20; ++kill_after) {
    const pid_t child = fork();
    if (child == 0) write_without_end(file);
    usleep(static_cast<useconds_t>(500 + 700 * kill_after));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    EXPECT_EQ(read_checkpoint(file).state.size(), std::size_t{1} << 16);
  }
}

TEST_F(CheckpointFile, OneProcessAtATimeHasTheLock) {
  const std::filesystem::path lock = file.string() + ".lock";
  const auto refusal_of_lock = [&]() -> std::string {
    return error_of<std::runtime_error>([&] { const CheckpointLock mine(file); });
  };
  {
    const CheckpointLock first(file);
    EXPECT_TRUE(first.is_held());
    EXPECT_EQ(refusal_of_lock(), "checkpoint " + file.string() +
                                     " is in use by another run; wait until that ends, or name another file");
    EXPECT_TRUE(std::filesystem::exists(lock)) << "who was refused has removed the lock of the first";
    std::filesystem::create_symlink(file, folder / "link.checkpoint");
    EXPECT_THROW(const CheckpointLock linked(folder / "link.checkpoint"), std::runtime_error);
    const CheckpointLock other(folder / "other.checkpoint");
    EXPECT_TRUE(other.is_held());
  }
  EXPECT_FALSE(std::filesystem::exists(lock));
  EXPECT_EQ(refusal_of_lock(), "");
  // The system frees the lock of a process that is killed; its file stays.
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const CheckpointLock held(file);
    if (write(ready[1], "x", 1) != 1) _exit(1);
    for (;;) pause();
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_NE(refusal_of_lock(), "");
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  close(ready[0]);
  close(ready[1]);
  EXPECT_TRUE(std::filesystem::exists(lock));
  EXPECT_EQ(refusal_of_lock(), "");
  EXPECT_FALSE(std::filesystem::exists(lock));
}

TEST_F(CheckpointFile, ALockIsTakenOnAFileOfSomebodyElseAndLeavesIt) {
  const std::filesystem::path lock = file.string() + ".lock";
  std::ofstream(lock) << "notes";
  { const CheckpointLock held(file); }
  EXPECT_TRUE(std::filesystem::exists(lock));
}

}  // namespace
}  // namespace hmax
