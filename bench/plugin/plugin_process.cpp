#include "bench/plugin/plugin_process.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "bench/plugin/plugin_child.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {
namespace {

using Clock = std::chrono::steady_clock;

InputError system_error(const char* what) {
  return InputError(fmt::format("the system has no {} for the plugin: {}", what, std::strerror(errno)));
}

/// Waits up to `milliseconds` for the child to end.
bool has_ended(pid_t child, int milliseconds, int* status) {
  for (int waited = 0;; ++waited) {
    const pid_t ended = waitpid(child, status, WNOHANG);
    if (ended == child || (ended < 0 && errno == ECHILD)) return true;
    if (waited >= milliseconds) return false;
    usleep(1000);
  }
}

}  // namespace

PluginProcess::PluginProcess(PluginName plugin, PluginSettings settings)
    : plugin_(std::move(plugin)), settings_(std::move(settings)) {
  if (!(settings_.patience > 0))
    throw InputError(fmt::format("--patience {} is not positive; give seconds", to_text(settings_.patience)));
  start();
  try {
    greet();
  } catch (...) {
    end();
    throw;
  }
}

PluginProcess::~PluginProcess() {
  const PluginRequest quit{.ask = PluginAsk::quit};
  if (socket_ >= 0) {
    const bool told = send(socket_, &quit, sizeof quit, MSG_NOSIGNAL | MSG_DONTWAIT) == sizeof quit;
    // Time for destroy(), if it is not in the middle of something.
    if (int status = 0; told && stage_->call == PluginCall::none && has_ended(child_, 500, &status)) child_ = -1;
  }
  end();
}

void PluginProcess::start() {
  void* shared = mmap(nullptr, sizeof(PluginStage), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw system_error("memory");
  stage_ = new (shared) PluginStage;
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    munmap(shared, sizeof(PluginStage));
    throw system_error("socket");
  }
  // What is buffered here would be written twice.
  std::fflush(nullptr);
  child_ = fork();
  if (child_ == 0) {
    ::close(ends[0]);
    serve_plugin(ends[1], *stage_, plugin_);
  }
  ::close(ends[1]);
  socket_ = ends[0];
  if (child_ < 0) {
    const InputError error = system_error("process");
    end();
    throw error;
  }
  fcntl(socket_, F_SETFL, O_NONBLOCK);
}

void PluginProcess::end() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  if (child_ > 0) {
    kill(child_, SIGKILL);
    while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  child_ = -1;
  if (stage_) munmap(stage_, sizeof(PluginStage));
  stage_ = nullptr;
}

std::string PluginProcess::where() const {
  const PluginStage stage = *stage_;
  const auto call = static_cast<std::size_t>(stage.call);
  if (call >= plugin_call_names.size() || stage.call == PluginCall::none) return "between calls";
  const std::string_view name = plugin_call_names[call];
  if (stage.call == PluginCall::load) return "while it was loaded";
  return stage.call == PluginCall::step ? fmt::format("in step({})", to_text(stage.h)) : fmt::format("in {}()", name);
}

void PluginProcess::explain_end() {
  // Ctrl-C may have come at the same time.
  if (settings_.watch) settings_.watch();
  int status = 0;
  const bool ended = has_ended(child_, 2000, &status);
  const std::string place = where();
  if (ended) child_ = -1;
  end();
  if (ended && WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    throw InputError(fmt::format("the plugin crashed {} with signal {} ({}); run it in a debugger, or try other step sizes",
                                 place, signal, strsignal(signal)));
  }
  throw InputError(fmt::format("the plugin ended the process {}{}; a plugin returns a code instead", place,
                               ended ? fmt::format(" with exit code {}", WEXITSTATUS(status)) : ""));
}

void PluginProcess::explain_hang() {
  const std::string place = where();
  end();
  throw InputError(fmt::format("the plugin did not return within {} s {}; --patience gives it longer",
                               to_text(settings_.patience), place));
}

void PluginProcess::wait_for(short events) {
  const auto begin = Clock::now();
  while (true) {
    pollfd fd{.fd = socket_, .events = events, .revents = 0};
    const int ready = poll(&fd, 1, 50);
    if (ready > 0) return;
    if (settings_.watch) settings_.watch();
    if (std::chrono::duration<double>(Clock::now() - begin).count() > settings_.patience) explain_hang();
  }
}

void PluginProcess::write(const void* from, std::size_t bytes) {
  for (const auto* at = static_cast<const char*>(from); bytes > 0;) {
    const ssize_t put = send(socket_, at, bytes, MSG_NOSIGNAL);
    if (put < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
      wait_for(POLLOUT);
      continue;
    }
    if (put <= 0) explain_end();
    at += put;
    bytes -= static_cast<std::size_t>(put);
  }
}

void PluginProcess::read(void* to, std::size_t bytes) {
  for (auto* at = static_cast<char*>(to); bytes > 0;) {
    wait_for(POLLIN);
    const ssize_t got = recv(socket_, at, bytes, 0);
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) continue;
    if (got <= 0) explain_end();
    at += got;
    bytes -= static_cast<std::size_t>(got);
  }
}

PluginProcess::Answer PluginProcess::receive() {
  Answer answer;
  do {
    read(&answer.head, sizeof answer.head);
  } while (answer.head.kind == PluginReply::Kind::alive);
  if (answer.head.numbers > most_plugin_states * 8 || answer.head.characters > 1'000'000) {
    end();
    throw InputError("the plugin destroyed the memory of its process; check the bounds of its arrays");
  }
  answer.numbers.resize(answer.head.numbers);
  read(answer.numbers.data(), answer.numbers.size() * sizeof(double));
  answer.text.resize(answer.head.characters);
  read(answer.text.data(), answer.text.size());
  if (answer.head.kind == PluginReply::Kind::failed) throw InputError(answer.text);
  return answer;
}

bool PluginProcess::ask(const PluginRequest& request, std::span<const double> in, std::span<double> out) {
  if (socket_ < 0) throw InputError("the plugin has ended; start the command again");
  PluginRequest head = request;
  head.numbers = in.size();
  // A request that is not read to its end would leave the two out of step: whatever goes wrong ends the child.
  try {
    write(&head, sizeof head);
    write(in.data(), in.size_bytes());
    const Answer answer = receive();
    if (answer.head.kind == PluginReply::Kind::diverged) return false;
    if (answer.numbers.size() != out.size()) throw InputError("the plugin returned a wrong count of numbers");
    std::ranges::copy(answer.numbers, out.begin());
    return true;
  } catch (...) {
    end();
    throw;
  }
}

void PluginProcess::greet() {
  const Answer answer = receive();
  const std::vector<double>& words = answer.numbers;
  if (words.size() < greeting_size) throw InputError("the plugin did not say what it is");
  std::memcpy(static_cast<void*>(&facts_.greeting), words.data(), sizeof facts_.greeting);
  const PluginGreeting& said = facts_.greeting;
  // What a plugin that writes beyond its arrays has destroyed is not read as something else.
  const double most = most_plugin_states;
  const bool whole = said.dimension >= 1 && said.dimension <= most && said.quaternions >= 0 &&
                     4 * said.quaternions <= said.dimension && said.pairs >= 0 && said.pairs <= most && said.reach >= 1;
  const double told = said.quaternions + (said.has_scales != 0 ? said.dimension : 0) +
                      (said.has_couplings != 0 ? said.dimension + 2 * said.pairs : 0) +
                      (said.is_stepper == 0 ? said.dimension : 0) +
                      (said.has_force != 0 ? std::floor(said.dimension / 2) : 0);
  if (!whole || static_cast<double>(words.size() - greeting_size) != told)
    throw InputError("the plugin destroyed the memory of its process; check the bounds of its arrays");
  facts_.dim = static_cast<Eigen::Index>(said.dimension);
  facts_.name = answer.text.substr(0, answer.text.find('\n'));
  facts_.note = answer.text.substr(answer.text.find('\n') + 1);
  const double* at = words.data() + greeting_size;
  for (int i = 0; i < static_cast<int>(said.quaternions); ++i, ++at) {
    if (!(*at + 4 <= said.dimension)) throw InputError("a quaternion of the plugin lies outside of its state");
    facts_.quaternions.push_back(static_cast<Eigen::Index>(*at));
  }
  const auto vector = [&at](Eigen::Index n) {
    const Eigen::VectorXd numbers = Eigen::Map<const Eigen::VectorXd>(at, n);
    at += n;
    return numbers;
  };
  if (said.has_scales != 0) {
    facts_.scales = vector(facts_.dim);
    if (!facts_.scales.allFinite() || facts_.scales.minCoeff() <= 0)
      throw InputError("scales() of the plugin has numbers that are not positive");
  }
  const auto index = [&at] { return static_cast<Eigen::Index>(*at++); };
  if (said.has_couplings != 0) {
    for (Eigen::Index i = 0; i < facts_.dim; ++i) facts_.groups.push_back(index());
    for (double i = 0; i < said.pairs; ++i) {
      const Eigen::Index one = index();
      facts_.couplings.emplace_back(one, index());
    }
    facts_.reach = said.reach;
  }
  if (said.is_stepper == 0) facts_.y0 = vector(facts_.dim);
  if (said.has_force != 0) facts_.mass = vector(facts_.dim / 2);
}

}  // namespace hmax
