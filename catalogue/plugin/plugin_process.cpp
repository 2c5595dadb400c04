#include "catalogue/plugin/plugin_process.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "catalogue/plugin/plugin_child.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using SteadyClock = std::chrono::steady_clock;

/// Characters of what a plugin says of an error that are shown.
constexpr std::size_t most_shown = 500;
/// Processes of a plugin beside its own, those that have ended and were not waited for as well: more would
/// leave none to the machine.
constexpr std::size_t most_processes = 500;
/// [s] after which they are counted again.
constexpr double between_counts = 0.1;

std::vector<pid_t> children_of(pid_t process) {
  namespace fs = std::filesystem;
  std::vector<pid_t> found;
  std::error_code failed;
  // Each thread has its own.
  for (fs::directory_iterator thread(fmt::format("/proc/{}/task", process), failed), end;
       !failed && thread != end; thread.increment(failed)) {
    std::ifstream list(thread->path() / "children");
    for (pid_t child = 0; list >> child;) found.push_back(child);
  }
  return found;
}

/// Whether a process has more than so many descendants. Counting ends there.
bool has_more_descendants(pid_t process, std::size_t most) {
  std::vector<pid_t> found{process};
  for (std::size_t i = 0; i < found.size() && found.size() <= most + 1; ++i)
    for (const pid_t each : children_of(found[i])) found.push_back(each);
  return found.size() > most + 1;
}

/// Ends all that the child has started, also what has left its group: such processes are children of the
/// child, which takes care of orphans. A child that has ended has its group left.
void end_with_descendants(pid_t child) {
  kill(child, SIGSTOP);
  std::set<pid_t> ended;
  constexpr int rounds = 100;  // of processes that go on to make others
  bool more = true;
  for (int round = 0; more && round < rounds; ++round) {
    more = false;
    std::vector<pid_t> open{child};
    while (!open.empty()) {
      const pid_t next = open.back();
      open.pop_back();
      for (const pid_t each : children_of(next)) {
        open.push_back(each);
        if (!ended.insert(each).second) continue;
        kill(each, SIGKILL);
        more = true;
      }
    }
  }
  kill(-child, SIGKILL);
  kill(child, SIGKILL);
}

}  // namespace

PluginProcess::PluginProcess(PluginName plugin, PluginSettings settings)
    : plugin_(std::move(plugin)), settings_(std::move(settings)) {
  if (!(settings_.patience > 0))
    throw input_error("--timeout {} is not positive; give seconds", to_text(settings_.patience));
  try {
    start();
    greet();
  } catch (...) {
    end();
    throw;
  }
}

PluginProcess::~PluginProcess() {
  // Time for destroy(), if it is not in the middle of something.
  if (memory_ && page().answered.load() == asked_) {
    page().request = {.ask = PluginAsk::quit};
    page().asked.store(++asked_);
    for (int waited = 0; waited < 50 && page().answered.load() != asked_ && !has_ended(); ++waited)
      page().answered.sleep_unless(asked_, 10);
  }
  end();
}

/// Whether the child has: it is looked at without reaping, and still there to be ended.
bool PluginProcess::has_ended() const {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(child_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == child_;
}

void PluginProcess::start() {
  memory_.emplace();
  output_.emplace();
  if (!plugin_.engine_file.empty()) folder_.emplace();
  // What is buffered here would be written twice.
  std::fflush(nullptr);
  const pid_t parent = getpid();
  child_ = fork();
  if (child_ == 0) {
    memory_->close_to_further_children();
    output_->take_over();
    if (folder_) setenv("TMPDIR", folder_->path().c_str(), 1);
    serve_plugin(page(), plugin_, parent);
  }
  if (child_ < 0)
    throw input_error("the system has no process for {}: {}", plugin_.subject, std::strerror(errno));
  // Both do it: whoever comes first.
  setpgid(child_, child_);
  memory_->close_to_further_children();
  output_->show();
}

int PluginProcess::end() {
  int status = 0;
  if (child_ > 0) {
    end_with_descendants(child_);
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
  }
  child_ = -1;
  output_.reset();
  memory_.reset();
  folder_.reset();
  return status;
}

std::string PluginProcess::where() const {
  const PluginCall call = page().stage.call;
  const auto number = static_cast<std::size_t>(call);
  if (number >= plugin_call_names.size() || call == PluginCall::none) return "between calls";
  if (call == PluginCall::load) return "while it was loaded";
  return call == PluginCall::step ? fmt::format("in step({})", to_text(page().stage.h.load()))
                                  : fmt::format("in {}()", plugin_call_names[number]);
}

void PluginProcess::explain_end() {
  const std::string place = where();
  const int status = end();
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    throw input_error("{} crashed {} with signal {} ({}); run it in a debugger, or try other step sizes",
                      plugin_.subject, place, signal, strsignal(signal));
  }
  throw input_error("{} ended the process {} with exit code {}; a plugin returns a code instead",
                    plugin_.subject, place, WEXITSTATUS(status));
}

void PluginProcess::explain_hang() {
  const std::string place = where();
  end();
  throw input_error("{} did not return within {} s {}; --timeout gives it longer", plugin_.subject,
                    to_text(settings_.patience), place);
}

void PluginProcess::explain_flood() {
  end();
  throw input_error("{} wrote more than {} MB to standard output and standard error; print less",
                    plugin_.subject, flood_of_plugin_output / 1'000'000);
}

void PluginProcess::bound_processes() {
  const auto now = SteadyClock::now();
  if (std::chrono::duration<double>(now - counted_).count() < between_counts) return;
  counted_ = now;
  if (!has_more_descendants(child_, most_processes)) return;
  end();
  throw input_error("{} has more than {} processes; start fewer, and wait for those that have ended",
                    plugin_.subject, most_processes);
}

void PluginProcess::explain_destruction() {
  end();
  throw InputError(plugin_.subject + std::string(plugin_destroyed));
}

void PluginProcess::await() {
  const SharedCount& answered = page().answered;
  if (spin_.until(answered, asked_)) return;
  auto begin = SteadyClock::now();
  for (std::uint64_t calls = page().stage.calls; answered.load() != asked_;) {
    page().answered.sleep_unless(asked_, 50);
    const std::uint32_t count = answered.load();
    if (count == asked_) return;
    if (count != asked_ - 1) explain_destruction();
    if (settings_.watch) settings_.watch();
    if (output_->is_flooded()) explain_flood();
    bound_processes();
    if (has_ended() && answered.load() != asked_) explain_end();
    if (const std::uint64_t now = page().stage.calls; now != calls) {
      calls = now;
      begin = SteadyClock::now();
    }
    if (std::chrono::duration<double>(SteadyClock::now() - begin).count() > settings_.patience)
      explain_hang();
  }
}

/// The answer to the last request.
PluginReply PluginProcess::reply() {
  await();
  if (output_->is_flooded()) explain_flood();
  // The clock takes a tenth of a short call.
  constexpr std::uint32_t calls_between_looks = 16;
  if (asked_ % calls_between_looks == 0) bound_processes();
  const PluginReply reply = page().reply;
  if (reply.numbers > most_plugin_numbers || reply.characters > most_plugin_characters ||
      reply.numbers * sizeof(double) + reply.characters > sizeof page().numbers)
    explain_destruction();
  switch (reply.kind) {
    case PluginReply::Kind::done:
    case PluginReply::Kind::diverged:
      return reply;
    case PluginReply::Kind::failed: {
      const std::string text = text_of(reply);
      throw InputError(text.size() > most_shown ? text.substr(0, most_shown) + " ..." : text);
    }
  }
  explain_destruction();
}

std::string PluginProcess::text_of(const PluginReply& reply) {
  std::string text(reinterpret_cast<const char*>(page().numbers.data() + reply.numbers), reply.characters);
  // A thread of the plugin may have written over it since.
  if (std::hash<std::string>{}(text) != reply.digest) explain_destruction();
  return text;
}

bool PluginProcess::ask(const PluginRequest& request, std::span<const double> in, std::span<double> out) {
  if (!memory_) throw input_error("{} has ended; start the command again", plugin_.subject);
  // Whatever goes wrong ends the child.
  try {
    page().request = request;
    std::ranges::copy(in, page().numbers.begin());
    page().asked.store(++asked_);
    const PluginReply answer = reply();
    if (answer.kind == PluginReply::Kind::diverged) return false;
    if (answer.numbers != out.size())
      throw input_error("{} returned a wrong count of numbers", plugin_.subject);
    std::copy_n(page().numbers.begin(), out.size(), out.begin());
    return true;
  } catch (...) {
    end();
    throw;
  }
}

/// Name and note, and the parts, whose names are the last lines.
void PluginProcess::read_parts(std::string text, const double* numbers) {
  if (facts_.greeting.own_step > 0) facts_.own_step = facts_.greeting.own_step;
  facts_.parts.resize(static_cast<std::size_t>(facts_.greeting.parts));
  for (std::size_t i = facts_.parts.size(); i-- > 0;) {
    if (text.ends_with('\n')) text.pop_back();
    const std::size_t line = text.rfind('\n') + 1, tab = text.find('\t', line);
    if (line == 0 || tab == text.npos) explain_destruction();
    facts_.parts[i] = {.kind = text.substr(line, tab - line),
                       .name = text.substr(tab + 1),
                       .stiffness = numbers[2 * i],
                       .damping = numbers[2 * i + 1]};
    text.resize(line);
  }
  if (text.ends_with('\n')) text.pop_back();
  facts_.name = text.substr(0, text.find('\n'));
  facts_.note = text.substr(text.find('\n') + 1);
}

void PluginProcess::greet() {
  const PluginReply answer = reply();
  const std::string text = text_of(answer);
  if (answer.numbers < greeting_size) throw input_error("{} did not say what it is", plugin_.subject);
  std::memcpy(static_cast<void*>(&facts_.greeting), page().numbers.data(), sizeof facts_.greeting);
  const PluginGreeting& said = facts_.greeting;
  // What a plugin that writes beyond its arrays has destroyed is not read as something else.
  const double most = most_plugin_states;
  const auto is_count = [](double number, double least, double greatest) {
    return number >= least && number <= greatest && number == std::floor(number);
  };
  const bool whole = is_count(said.dimension, 1, most) && is_count(said.quaternions, 0, said.dimension / 4) &&
                     is_count(said.pairs, 0, most) && said.reach >= 1 &&
                     is_count(said.parts, 0, most_plugin_parts) && said.own_step >= 0;
  const double told = said.quaternions + (said.has_scales != 0 ? said.dimension : 0) +
                      (said.has_couplings != 0 ? said.dimension + 2 * said.pairs : 0) + 2 * said.parts +
                      (said.is_stepper == 0 ? said.dimension : 0) +
                      (said.has_force != 0 ? std::floor(said.dimension / 2) : 0);
  if (!whole || static_cast<double>(answer.numbers - greeting_size) != told) explain_destruction();
  facts_.dim = static_cast<Eigen::Index>(said.dimension);
  const double* at = page().numbers.data() + greeting_size;
  for (int i = 0; i < static_cast<int>(said.quaternions); ++i, ++at) {
    const double first = *at;
    if (!is_count(first, 0, said.dimension - 4))
      throw input_error("a quaternion of {} lies outside of its state", plugin_.subject);
    facts_.quaternions.push_back(static_cast<Eigen::Index>(first));
  }
  const auto vector = [&at](Eigen::Index n) {
    Eigen::VectorXd numbers = Eigen::Map<const Eigen::VectorXd>(at, n);
    at += n;
    return numbers;
  };
  if (said.has_scales != 0) {
    facts_.scales = vector(facts_.dim);
    if (!facts_.scales.allFinite() || facts_.scales.minCoeff() <= 0)
      throw input_error("scales() of {} has numbers that are not positive", plugin_.subject);
  }
  const auto index = [&] {
    const double group = *at++;
    if (!is_count(group, 0, said.dimension - 1)) explain_destruction();
    return static_cast<Eigen::Index>(group);
  };
  if (said.has_couplings != 0) {
    for (Eigen::Index i = 0; i < facts_.dim; ++i) facts_.groups.push_back(index());
    for (double i = 0; i < said.pairs; ++i) {
      const Eigen::Index one = index();
      facts_.couplings.emplace_back(one, index());
    }
    facts_.reach = said.reach;
  }
  read_parts(text, at);
  at += 2 * facts_.parts.size();
  if (said.is_stepper == 0) facts_.y0 = vector(facts_.dim);
  if (said.has_force != 0) facts_.mass = vector(facts_.dim / 2);
}

}  // namespace hmax
