/// Lines of progress from a thread of their own, for computations that call nobody while they go on.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "cli/shared/console.hpp"

namespace hmax {

/// Calls once a second from a thread of its own, until it is destroyed.
class Ticker {
 public:
  /// @param first  the second of the first call
  /// @param show   gets the seconds since the start
  Ticker(int first, std::function<void(int seconds)> show);

 private:
  std::jthread thread_;
};

/// Shows which row has been computed the longest, while several threads compute rows.
class RowProgress {
 public:
  /// @param progress  is left alone once this has ended
  /// @param task      before the name of a row
  /// @param share     of the whole work, when so many of these rows are done
  RowProgress(Progress& progress, std::string task, std::function<double(std::size_t done)> share);

  /// Both from any thread. @param row  its name, which no two rows share
  void begin(const std::string& row);
  void end(const std::string& row);

 private:
  void show(Progress& progress);

  using Clock = std::chrono::steady_clock;
  struct Running {
    std::string row;
    Clock::time_point start;
  };
  std::string task_;
  std::function<double(std::size_t)> share_;
  std::mutex mutex_;
  std::vector<Running> running_;  ///< in the order in which they began
  std::size_t done_ = 0;
  Ticker ticker_;  // last: the others must be there
};

}  // namespace hmax
