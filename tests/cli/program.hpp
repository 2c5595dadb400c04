/// Runs the real program, as a user's shell does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {

/// What one command line left behind.
struct Told {
  int exit_code = -1;  ///< -1 when a signal ended it
  std::string out, err;

  /// Standard output as the one JSON document it must be.
  [[nodiscard]] nlohmann::json json() const;
};

/// A folder of its own in which `hmax` is run.
class Shell {
 public:
  /// @param arguments  as typed after `hmax`
  Told hmax(const std::string& arguments) const { return line("hmax " + arguments); }
  /// What `hmax ARGUMENTS`, which is to succeed, prints.
  std::string text(const std::string& arguments) const;
  /// The document of `hmax ARGUMENTS --json`, which is to succeed.
  nlohmann::json json(const std::string& arguments) const;

  /// A whole line of sh in which `hmax` is the program.
  Told line(const std::string& command) const { return line(command, HMAX_PROGRAM); }

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  [[nodiscard]] Told line(const std::string& command, const char* program) const;
  [[nodiscard]] std::filesystem::path out() const { return outputs_ / "out"; }
  [[nodiscard]] std::filesystem::path err() const { return outputs_ / "err"; }
  Scratch folder_, outputs_;
};

/// Bad input: exit code 2, nothing on standard output, and exactly one sentence on standard error that names
/// what is wrong.
void expect_refused(const Told& told, const std::string& named);

/// The same of `hmax ARGUMENTS` in an empty folder.
void expect_refusal(const std::string& arguments, const std::string& named);

/// The keys of a contract with programs.
void expect_keys(const nlohmann::json& document, const std::vector<std::string>& keys);

}  // namespace hmax
