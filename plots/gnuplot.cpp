#include "plots/gnuplot.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/text/utf8.hpp"

namespace hmax {
namespace {

/// Exit codes of the child that gnuplot itself never uses.
constexpr int cannot_start = 127;
constexpr int cannot_enter = 126;

struct Finished {
  int code;              ///< exit code, or -1 when ended by a signal or never started
  bool late = false;     ///< ended because it took too long
  std::string errors{};  ///< what it wrote to standard error, at most 4 KiB
};

Finished run(const std::filesystem::path& directory, std::array<const char*, 4> arguments, double seconds) {
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) return {.code = -1, .errors = "no pipe"};
  const std::string folder = directory.empty() ? "." : directory.string();
  const pid_t child = fork();
  if (child < 0) {
    close(pipe_ends[0]);
    close(pipe_ends[1]);
    return {.code = -1, .errors = "no process"};
  }
  if (child == 0) {
    // Only async-signal-safe calls between fork and exec.
    // Ctrl-C of a terminal is for hmax, which waits for the figure: gnuplot may hang in it (cairo).
    setpgid(0, 0);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    const int null = open("/dev/null", O_RDWR);
    dup2(null, STDIN_FILENO);
    dup2(null, STDOUT_FILENO);
    dup2(pipe_ends[1], STDERR_FILENO);
    if (chdir(folder.c_str()) != 0) _exit(cannot_enter);
    execvp(arguments[0], const_cast<char* const*>(arguments.data()));
    _exit(cannot_start);
  }
  setpgid(child, child);  // as the child does: whoever is first
  close(pipe_ends[1]);
  Finished finished{.code = -1};
  std::array<char, 1024> buffer;
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    const std::chrono::duration<double, std::milli> left = end - Clock::now();
    pollfd waits{.fd = pipe_ends[0], .events = POLLIN, .revents = 0};
    const int ready = poll(&waits, 1, static_cast<int>(std::clamp(left.count(), 0.0, 1e6)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0 && Clock::now() < end) continue;
    if (ready <= 0) {
      finished.late = true;
      kill(-child, SIGKILL);  // and what it has started
      break;
    }
    const ssize_t got = read(pipe_ends[0], buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    if (finished.errors.size() < 4096) finished.errors.append(buffer.data(), static_cast<std::size_t>(got));
  }
  close(pipe_ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status)) finished.code = WEXITSTATUS(status);
  return finished;
}

}  // namespace

bool gnuplot_available() { return run(".", {"gnuplot", "--version", nullptr, nullptr}, 10).code == 0; }

std::string run_gnuplot(const std::filesystem::path& directory, const std::string& script, double seconds) {
  const Finished finished =
      run(directory, {"gnuplot", "--default-settings", script.c_str(), nullptr}, seconds);
  if (finished.code == 0) return {};
  const std::string file = (directory / script).string();
  if (finished.code == cannot_start)
    return "gnuplot is not installed, so " + file +
           " was written but not drawn; apt-get install gnuplot-nox, then run gnuplot on it in its folder";
  if (finished.late)
    return "gnuplot took longer than " + std::to_string(std::lround(seconds)) + " s for " + file +
           " and was ended; try `gnuplot --version`, then run gnuplot on it in its folder";
  return "gnuplot could not draw " + file + ": " + shortened(one_line(finished.errors), 300);
}

std::string one_line(std::string_view text) {
  std::string clean;
  while (!text.empty()) {
    const std::size_t size = utf8_character(text);
    const auto first = static_cast<std::uint8_t>(text[0]);
    // C1 controls (U+0080 to U+009F) are C2 80 to C2 9F.
    const bool control = first < 0x20 || first == 0x7F ||
                         (size == 2 && first == 0xC2 && static_cast<std::uint8_t>(text[1]) < 0xA0);
    if (size == 0)
      clean += '?';
    else if (control)
      clean += ' ';
    else
      clean += text.substr(0, size);
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return clean;
}

std::string gnuplot_string(std::string_view text) {
  std::string out = "'";
  for (const char c : one_line(text)) {
    if (c == '\'')
      out += "’";
    else
      out += c;
  }
  out += '\'';
  return out;
}

std::size_t length_of(std::string_view text) {
  std::size_t count = 0;
  for (const char c : text) count += (static_cast<std::uint8_t>(c) & 0xC0) != 0x80;
  return count;
}

std::vector<std::string> lines_of(const std::string& text, std::size_t most) {
  std::vector<std::string> lines;
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!line.empty() && length_of(line) + 1 + length_of(word) > most) {
      lines.push_back(line);
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
    at = end + 1;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

std::string shortened(std::string_view text, std::size_t most) {
  if (length_of(text) <= most) return std::string(text);
  std::string cut;
  for (std::size_t kept = 0; kept + 1 < most; ++kept) {
    const std::size_t size = utf8_character(text);
    cut += text.substr(0, size == 0 ? 1 : size);
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return cut + "…";
}

}  // namespace hmax
