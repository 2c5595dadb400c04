/// A plugin in a child process: a crash or a hang of it is an error here.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "bench/plugin/plugin_messages.hpp"
#include "bench/plugin/plugin_name.hpp"

namespace hmax {

struct PluginSettings {
  double patience = 10;  ///< [s] after which a function that has not returned is a hang
  /// Called every 50 ms while the plugin works; may throw, which ends the child.
  std::function<void()> watch = {};
};

/// What the plugin says of itself.
struct PluginFacts {
  std::string name, note;
  PluginGreeting greeting;
  Eigen::Index dim = 0;
  std::vector<Eigen::Index> quaternions;  ///< first index of each
  Eigen::VectorXd scales;                 ///< shape (dim), or empty
  /// Of its couplings: the group of each number, shape (dim) or empty, pairs of groups, and how many in a row a step crosses.
  std::vector<Eigen::Index> groups;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> couplings;
  double reach = 1;
  Eigen::VectorXd y0, mass;               ///< of a model; mass of shape (dim / 2), or empty
};

/// Fork and a pair of sockets. One thread at a time. The child dies with the thread that made it.
/// @throws InputError  from every function: what the plugin did, in a sentence
class PluginProcess {
 public:
  explicit PluginProcess(PluginName plugin, PluginSettings settings = {});
  ~PluginProcess();
  PluginProcess(const PluginProcess&) = delete;
  PluginProcess& operator=(const PluginProcess&) = delete;

  [[nodiscard]] const PluginFacts& facts() const { return facts_; }
  [[nodiscard]] const PluginName& plugin() const { return plugin_; }

  /// Sends a request with its numbers and waits for the answer.
  /// @returns false where the step says that it cannot be done; `out` is then not written
  bool ask(const PluginRequest& request, std::span<const double> in, std::span<double> out);

 private:
  struct Answer {
    PluginReply head;
    std::vector<double> numbers;
    std::string text;
  };
  void start();
  void greet();
  Answer receive();
  void write(const void* from, std::size_t bytes);
  void read(void* to, std::size_t bytes);
  void wait_for(short events);
  [[noreturn]] void explain_end();
  [[noreturn]] void explain_hang();
  void end();
  [[nodiscard]] std::string where() const;

  PluginName plugin_;
  PluginSettings settings_;
  PluginFacts facts_;
  PluginStage* stage_ = nullptr;
  int socket_ = -1;
  pid_t child_ = -1;
};

}  // namespace hmax
