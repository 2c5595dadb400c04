/// Runs the real program, as a user's shell does.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>
#include <sys/wait.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/results/scratch.hpp"

namespace hmax {

/// What one command line left behind.
struct Told {
  int exit_code = -1;  ///< -1 when a signal ended it
  std::string out, err;

  /// Standard output as the one JSON document it must be.
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/// A folder of its own in which `hmax` is run.
class Shell {
 public:
  /// @param arguments  as typed after `hmax`
  Told hmax(const std::string& arguments) const { return line("hmax " + arguments); }

  /// A whole line of sh in which `hmax` is the program.
  Told line(const std::string& command) const {
    // Three minutes turn a hang into a failure, also on a slow machine.
    const std::string line = "cd '" + folder_.folder().string() +
                             "' && hmax() { timeout 180 '" HMAX_PROGRAM "' \"$@\"; } && { " + command +
                             " ; } >'" + out().string() + "' 2>'" + err().string() + "' </dev/null";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out()), read_text(err())};
  }

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  [[nodiscard]] std::filesystem::path out() const { return outputs_ / "out"; }
  [[nodiscard]] std::filesystem::path err() const { return outputs_ / "err"; }
  Scratch folder_, outputs_;
};

/// Bad input: exit code 2, nothing on standard output, and exactly one sentence on standard error that names
/// what is wrong.
inline void expect_refused(const Told& told, const std::string& named) {
  EXPECT_EQ(told.exit_code, 2) << told.err;
  EXPECT_EQ(told.out, "");
  EXPECT_EQ(told.err.rfind("hmax: ", 0), 0U) << told.err;
  EXPECT_EQ(std::count(told.err.begin(), told.err.end(), '\n'), 1) << told.err;
  EXPECT_NE(told.err.find(named), std::string::npos) << "'" << named << "' is not in: " << told.err;
}

}  // namespace hmax
