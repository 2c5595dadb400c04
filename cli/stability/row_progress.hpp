/// Lines of progress from a thread of their own, for computations that call nobody while they go on.
#pragma once

#include <functional>
#include <string>
#include <thread>

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

/// A row that is being computed.
struct RunningRow {
  std::string row;
  double start;  ///< by elapsed_seconds()
};

/// Whole seconds since a time by elapsed_seconds().
long seconds_since(double start);

/// "static equilibrium (residual 1.2e-03), fastest modes, 7 s"
/// @param residual  0 before the first iterate
std::string words_of_search(double residual, long seconds);

}  // namespace hmax
