/// A plugin in a child process: a crash or a hang of it is an error here.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "analysis/foreign_steps/foreign_stepper.hpp"
#include "catalogue/plugin/plugin_memory.hpp"
#include "catalogue/plugin/plugin_messages.hpp"
#include "catalogue/plugin/plugin_name.hpp"
#include "catalogue/plugin/plugin_output.hpp"
#include "core/process/temporary_folder.hpp"

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
  /// Of its couplings: the group of each number, shape (dim) or empty, pairs of groups, and how many in a row
  /// a step crosses.
  std::vector<Eigen::Index> groups;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> couplings;
  double reach = 1;
  std::optional<double> own_step;  ///< [s]
  std::vector<ScenePart> parts;
  Eigen::VectorXd y0, mass;  ///< of a model; mass of shape (dim / 2), or empty
};

/// Fork and shared memory. One thread at a time. A call of a plugin takes about 0.3 us beside its own time
/// where each process has a core, and some 8 us where they share one. The child dies with the thread that
/// made it, and at the end of this object all processes that the plugin has started.
/// @throws InputError  from every function: what the plugin did, in a sentence
class PluginProcess {
 public:
  explicit PluginProcess(PluginName plugin, PluginSettings settings = {});
  ~PluginProcess();
  PluginProcess(const PluginProcess&) = delete;
  PluginProcess& operator=(const PluginProcess&) = delete;

  [[nodiscard]] const PluginFacts& facts() const { return facts_; }
  [[nodiscard]] const PluginName& plugin() const { return plugin_; }

  /// Makes a request with its numbers and waits for the answer.
  /// @returns false where the step says that it cannot be done; `out` is then not written
  bool ask(const PluginRequest& request, std::span<const double> in, std::span<double> out);

 private:
  void start();
  void greet();
  void read_parts(std::string text, const double* numbers);
  void await();
  PluginReply reply();
  [[nodiscard]] std::string text_of(const PluginReply& reply);
  [[nodiscard]] PluginPage& page() const { return memory_->page(); }
  [[nodiscard]] bool has_ended() const;
  [[noreturn]] void explain_end();
  [[noreturn]] void explain_hang();
  [[noreturn]] void explain_flood();
  [[noreturn]] void explain_destruction();
  void bound_processes();  ///< ends a plugin that takes the processes of the machine
  int end();               ///< @returns the status of the child
  [[nodiscard]] std::string where() const;

  PluginName plugin_;
  PluginSettings settings_;
  PluginFacts facts_;
  std::optional<PluginMemory> memory_;
  std::optional<PluginOutput> output_;
  std::optional<TemporaryFolder> folder_;  ///< for what the module of a scene unpacks
  std::uint32_t asked_ = 1;                ///< how often; the first answer comes unasked
  Spin spin_;
  pid_t child_ = -1;
  std::chrono::steady_clock::time_point counted_;  ///< when its processes were counted last
};

}  // namespace hmax
