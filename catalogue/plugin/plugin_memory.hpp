/// The memory that hmax and the child process with the plugin both see: a request, then its reply in its
/// place.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "catalogue/plugin/plugin_messages.hpp"

namespace hmax {

/// A number that one process writes and the other waits for, in memory of both.
class alignas(64) SharedCount {
 public:
  /// Who reads a number sees all that the other process wrote before it stored that number.
  [[nodiscard]] std::uint32_t load() const { return value_.load(std::memory_order_acquire); }
  /// Wakes the process that sleeps here.
  void store(std::uint32_t value);
  /// Sleeps until the number changes, a signal comes or the time is over [ms]; not at all when it is
  /// `wanted`.
  void sleep_unless(std::uint32_t wanted, std::optional<int> milliseconds);

 private:
  std::atomic<std::uint32_t> value_ = 0, sleepers_ = 0;
  static_assert(decltype(value_)::is_always_lock_free && sizeof value_ == 4);
};

/// Waiting without sleep, about as long as falling asleep and waking takes. Where this is in vain, as with
/// slow plugins or busy cores, it is left out the next 1, 2, 4 .. 1024 times.
class Spin {
 public:
  /// @returns whether the number is `wanted`
  bool until(const SharedCount& count, std::uint32_t wanted);

 private:
  std::uint32_t left_out_ = 0, next_ = 1;
};

/// What the child is doing: outlives a crash.
struct alignas(64) PluginStage {
  std::atomic<PluginCall> call = PluginCall::none;
  std::atomic<double> h = 0;             ///< of step
  std::atomic<std::uint64_t> calls = 0;  ///< begun so far: a request of many of them is no hang
};

/// Numbers of the largest message, and characters of the longest text behind them.
inline constexpr std::size_t most_plugin_numbers = 8 * most_plugin_states, most_plugin_characters = 1'000'000;

/// The child has answered as often as it was asked, or once less; it begins with an answer. Of what it writes
/// hmax takes nothing for granted: a plugin may write anywhere.
struct PluginPage {
  SharedCount asked, answered;
  PluginStage stage;
  alignas(64) PluginRequest request;
  alignas(64) PluginReply reply;
  alignas(64) std::array<double, most_plugin_numbers> numbers;  ///< of the request, or of the reply with its
                                                                ///< text behind
};

/// The page stands between two that nobody may touch, so that writing beyond the end of other arrays ends in
/// a crash before it comes here. Memory is taken where it is first written to.
/// @throws InputError  where the system has none
class PluginMemory {
 public:
  PluginMemory();
  ~PluginMemory();
  PluginMemory(const PluginMemory&) = delete;
  PluginMemory& operator=(const PluginMemory&) = delete;

  [[nodiscard]] PluginPage& page() const { return *page_; }
  /// Children that are started from now on do not have it.
  void close_to_further_children() const;

 private:
  PluginPage* page_ = nullptr;
};

}  // namespace hmax
