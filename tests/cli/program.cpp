#include "tests/cli/program.hpp"

#include <algorithm>
#include <cstdlib>
#include <sys/wait.h>

namespace hmax {

nlohmann::json Told::json() const { return nlohmann::json::parse(out); }

std::string Shell::text(const std::string& arguments) const {
  const Told told = hmax(arguments);
  EXPECT_EQ(told.exit_code, 0) << arguments << "\n" << told.out << told.err;
  return told.out;
}

nlohmann::json Shell::json(const std::string& arguments) const {
  return nlohmann::json::parse(text(arguments + " --json"));
}

namespace {

/// What a command says but for the warning of a debug build, which sanitizers look at too.
std::string without_debug_warning(std::string told) {
  const std::string warning =
      "hmax: warning: this is a debug build; its times are marked and say nothing about a release build\n";
  if (const std::size_t place = told.find(warning); place != std::string::npos)
    told.erase(place, warning.size());
  return told;
}

}  // namespace

Told Shell::line(const std::string& command, const char* program) const {
  // Eight minutes turn a hang into a failure, also on a slow machine.
  const std::string line = "cd '" + folder_.folder().string() + "' && hmax() { timeout 480 '" + program +
                           "' \"$@\"; } && { " + command + " ; } >'" + out().string() + "' 2>'" +
                           err().string() + "' </dev/null";
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out()),
          without_debug_warning(read_text(err()))};
}

void expect_refused(const Told& told, const std::string& named) {
  EXPECT_EQ(told.exit_code, 2) << told.err;
  EXPECT_EQ(told.out, "");
  EXPECT_EQ(told.err.rfind("hmax: ", 0), 0U) << told.err;
  EXPECT_EQ(std::count(told.err.begin(), told.err.end(), '\n'), 1) << told.err;
  EXPECT_TRUE(says(told.err, named));
}

void expect_refusal(const std::string& arguments, const std::string& named) {
  SCOPED_TRACE(arguments);
  expect_refused(Shell().hmax(arguments), named);
}

void expect_keys(const nlohmann::json& document, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) EXPECT_TRUE(document.contains(key)) << key << " in " << document.dump();
}

}  // namespace hmax
