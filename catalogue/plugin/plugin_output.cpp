#include "catalogue/plugin/plugin_output.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/eventfd.h>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

#include "core/input_error.hpp"

namespace hmax {
namespace {

void write_all(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void close_if_open(int& file) {
  if (file >= 0) close(file);
  file = -1;
}

}  // namespace

PluginOutput::PluginOutput() {
  std::array<int, 2> ends{-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC) == 0) stop_ = eventfd(0, EFD_CLOEXEC);
  read_ = ends[0];
  write_ = ends[1];
  if (stop_ >= 0) return;
  const InputError error(fmt::format("the system has no pipe for the plugin: {}", std::strerror(errno)));
  close_if_open(read_);
  close_if_open(write_);
  throw error;
}

PluginOutput::~PluginOutput() {
  if (reader_.joinable()) {
    eventfd_write(stop_, 1);
    reader_.join();
  }
  for (int* each : {&read_, &write_, &stop_}) close_if_open(*each);
}

void PluginOutput::take_over() const {
  dup2(write_, STDOUT_FILENO);
  dup2(write_, STDERR_FILENO);
  if (const int nothing = open("/dev/null", O_RDONLY); nothing >= 0) dup2(nothing, STDIN_FILENO);
  close_range(STDERR_FILENO + 1, ~0U, 0);
  // Lines appear when they are printed, also those before a crash.
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
}

void PluginOutput::show() {
  close_if_open(write_);
  // Signals are for the threads of hmax.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::string failure;
  try {
    reader_ = std::thread([this] { forward(); });
  } catch (const std::system_error& error) {
    failure = error.what();
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (!failure.empty())
    throw input_error("the system has no thread for the output of the plugin: {}", failure);
}

void PluginOutput::forward() {
  std::array<char, 65536> buffer;
  std::size_t room = most_plugin_output, after_the_end = 0;
  bool cut = false;
  std::array<pollfd, 2> waited{pollfd{read_, POLLIN, 0}, pollfd{stop_, POLLIN, 0}};
  // A process that was left behind may write for ever: of what it writes after the end as much as a pipe
  // holds is read.
  while (after_the_end <= buffer.size()) {
    if (poll(waited.data(), waited.size(), -1) < 0) {
      if (errno == EINTR) continue;
      return;
    }
    const bool ending = waited[1].revents != 0;
    if ((waited[0].revents & (POLLIN | POLLHUP)) == 0) {
      if (ending) return;
      continue;
    }
    const ssize_t got = read(read_, buffer.data(), buffer.size());
    if (got == 0 || (got < 0 && errno != EINTR)) return;
    if (got < 0) continue;
    const auto count = static_cast<std::size_t>(got), shown = std::min(count, room);
    read_so_far_.fetch_add(count, std::memory_order_relaxed);
    if (ending) after_the_end += count;
    write_all({buffer.data(), shown});
    room -= shown;
    if (shown == count || cut) continue;
    cut = true;
    write_all(fmt::format("\nhmax: the plugin wrote more than {} characters; the rest is not shown\n",
                          most_plugin_output));
  }
}

}  // namespace hmax
