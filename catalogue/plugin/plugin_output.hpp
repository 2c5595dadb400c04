/// What a plugin writes to standard output and standard error: it appears on standard error, up to a bound.
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>

namespace hmax {

/// Characters of one plugin that are shown; the rest is read and dropped, and a line says so.
inline constexpr std::size_t most_plugin_output = 100'000;
/// Characters after which a plugin is ended: what it computes is lost in what it writes.
inline constexpr std::size_t flood_of_plugin_output = 64'000'000;

/// A pipe of its own: processes that the plugin leaves behind hold this pipe, and none that somebody waits
/// for at the other end of hmax's.
class PluginOutput {
 public:
  /// @throws InputError  where the system has no pipe
  PluginOutput();
  /// Shows what is there and ends, though somebody may still hold the pipe.
  ~PluginOutput();
  PluginOutput(const PluginOutput&) = delete;
  PluginOutput& operator=(const PluginOutput&) = delete;

  /// In the child: makes the pipe its standard output and error, and leaves it no other file of hmax's.
  void take_over() const;
  /// In hmax, after the child has been made.
  /// @throws InputError  where the system has no thread
  void show();
  [[nodiscard]] bool is_flooded() const {
    return read_so_far_.load(std::memory_order_relaxed) > flood_of_plugin_output;
  }

 private:
  void forward();

  int read_ = -1, write_ = -1, stop_ = -1;
  std::atomic<std::size_t> read_so_far_ = 0;
  std::thread reader_;
};

}  // namespace hmax
